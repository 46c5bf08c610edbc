// The state of OpenGL in which surfaces are drawn, and proxies tested against them.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "gl/functions.h"
#include "gl/objects.h"
#include "occlod/view.h"

namespace occlod::gl {

// Depths that should be equal differ by rounding and by the 1/256 pixel of the rasteriser: surfaces are pushed away and
// proxies are pulled near, so that a bound which touches a surface is visible.

// Both sides of surfaces, with depth test and depth writes.
void set_surface_state(const Functions& gl);
// Front faces of proxies, after set_surface_state(): depth test without depth writes.
void set_proxy_state(const Functions& gl);

// Objects relative to the eye, so that single precision is enough for the vertex shader. No OpenGL here.

// From view space (x to the right, y up, z towards the viewer, the eye at the origin; world units) to clip space.
[[nodiscard]] glm::dmat4 view_to_clip(const View& view);

// One object's place before the eye: view = to_view * (position - eye) + offset. The difference is exact near the eye
// and off by 2^-24 of itself elsewhere, so a vertex moves by as little on the screen, wherever the object and its
// origin are; and it moves alike in every node that has it.
struct EyeSpace {
  EyeSpace(const View& view, const glm::dmat4& object_to_world);

  glm::vec3 eye{0.0F};        // object space, rounded
  glm::mat3 to_view{1.0F};    // from object to view space
  glm::vec3 offset{0.0F};     // view space: where the rounded eye is
  glm::dmat4 object_to_clip;  // in double precision
  bool mirrored = false;      // whether the placement turns triangles over
};

// Positions through one matrix, without colour: occluders and proxies.

class PlainProgram {
 public:
  // Positions are at location 0.
  explicit PlainProgram(const Functions& gl);
  void use() const { gl_->UseProgram(program_.id()); }
  // Of the program in use.
  void set_to_clip(const glm::mat4& to_clip) const;

 private:
  const Functions* gl_;
  Program program_;
  GLint to_clip_;
};

// The shaders that draw nodes.

// Vertices as ArenaVertex has them, and at morph_location how far they have slid, of a whole draw or of each instance;
// flat two-sided shading with the lights of shade() in src/picture/shade.cpp.
class NodeProgram {
 public:
  static constexpr GLuint morph_location = 3;

  // `dear`: the sky is made of eight lights with highlights, and colours are encoded exactly.
  NodeProgram(const Functions& gl, bool dear);
  void use() const { gl_->UseProgram(program_.id()); }
  // Of the program in use.
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
