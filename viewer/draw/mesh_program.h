// Compiles the shaders that draw meshes and the background.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include "gl/objects.h"

namespace occlod::viewer {

// Reads the attributes 0 position, 1 normal, 2 colour (sRGB), 3 crease (see find_creases()), 4 texture coordinate, 5
// layer and 6 place in the image of a node. Lights from the eye, like occlod::shade.
class MeshProgram {
 public:
  // `wire` adds lines along edges, for which it uses a geometry shader.
  MeshProgram(const gl::Functions& gl, bool wire);

  enum class Color { plain, vertices, triangles, texture };
  struct Uniforms {
    glm::mat4 object_to_clip{1.0F};
    glm::mat4 object_to_eye{1.0F};
    glm::mat3 normal_to_eye{1.0F};
    Color color = Color::plain;
    float crease_limit = 1.0F;  // vertices on sharper creases have no normal; 1: 180 degrees
    bool flat = false;
    bool dim_back_faces = false;
    bool orthographic = false;
    bool texture_from_below = true;  // texture coordinates grow upwards
    bool node_image = false;         // vertices whose place there is not negative show the image of unit 2 too
    glm::vec4 clip_plane{0.0F};      // in eye space; works while GL_CLIP_DISTANCE0 is enabled
  };
  // Colours of triangles are texels of texture unit 0: triangle i at (i % texels_a_row, i / texels_a_row). Layers are
  // those of the array texture of unit 1.
  void use(const Uniforms& uniforms) const;

  static constexpr int texels_a_row = 4096;

 private:
  const gl::Functions* gl_;
  gl::Program program_;
  GLint object_to_clip_, object_to_eye_, normal_to_eye_, color_, crease_limit_, flat_, dim_, orthographic_, from_below_,
      node_image_, clip_plane_;
};

// Draws a vertical gradient over the whole target.
class BackgroundProgram {
 public:
  explicit BackgroundProgram(const gl::Functions& gl);
  void draw() const;

 private:
  const gl::Functions* gl_;
  gl::Program program_;
  gl::VertexArray array_;
};

}  // namespace occlod::viewer
