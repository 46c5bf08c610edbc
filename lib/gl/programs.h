// Sets the OpenGL state in which surfaces are drawn and proxies are tested against them.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "gl/functions.h"
#include "gl/objects.h"
#include "occlod/view.h"

namespace occlod::gl {

// Depths that should be equal differ by rounding and by the rasteriser's 1/256 pixel: surfaces are pushed away and
// proxies are pulled nearer, so that a bound that touches a surface is visible.

// Sets the state for both sides of surfaces, with depth test and depth writes.
void set_surface_state(const Functions& gl);
// Sets the state for front faces of proxies, after set_surface_state(): depth test without depth writes.
void set_proxy_state(const Functions& gl);

// Expresses objects relative to the eye, so that single precision is enough for the vertex shader. Does not call
// OpenGL.

// Returns the transform from view space (x to the right, y up, z towards the viewer, the eye at the origin; world
// units) to clip space.
[[nodiscard]] glm::dmat4 view_to_clip(const View& view);

// Describes one object relative to the eye: view = to_view * (position - eye) + offset. The difference is exact near
// the eye and has a relative error of 2^-24 elsewhere, so a vertex moves by as little on the screen, wherever the
// object and its origin are; and it moves identically in every node that contains it.
struct EyeSpace {
  EyeSpace(const View& view, const glm::dmat4& object_to_world);

  glm::vec3 eye{0.0F};        // object space, rounded
  glm::mat3 to_view{1.0F};    // from object to view space
  glm::vec3 offset{0.0F};     // view space: position of the rounded eye
  glm::dmat4 object_to_clip;  // in double precision
  bool mirrored = false;      // whether the placement flips the winding of triangles
};

// Transforms positions by one matrix, without colour; used for occluders and proxies.

class PlainProgram {
 public:
  // Reads positions from location 0.
  explicit PlainProgram(const Functions& gl);
  void use() const { gl_->UseProgram(program_.id()); }
  // Sets the matrix of the program, which must be in use.
  void set_to_clip(const glm::mat4& to_clip) const;

 private:
  const Functions* gl_;
  Program program_;
  GLint to_clip_;
};

// Holds the shaders that draw nodes.

// Reads vertices in the layout of ArenaVertex, and at morph_location the morph factor of a whole draw or of each
// instance; shades flat, two-sided surfaces with the lights of shade() in scene/shade.cpp.
class NodeProgram {
 public:
  static constexpr GLuint morph_location = 3;

  // With `dear`, the sky is made of eight lights with highlights, and colours are encoded exactly.
  NodeProgram(const Functions& gl, bool dear);
  void use() const { gl_->UseProgram(program_.id()); }
  // Sets the view of the program, which must be in use.
  void set_view(const View& view) const;
  void set_object(const EyeSpace& object) const;

 private:
  const Functions* gl_;
  Program program_;
  GLint view_to_clip_;
  GLint orthographic_;
  GLint eye_;
  GLint to_view_;
  GLint offset_;
};

}  // namespace occlod::gl
