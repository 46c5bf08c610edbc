// The shaders that draw nodes.
#pragma once

#include <glm/mat4x4.hpp>

#include "gl/eye_space.h"
#include "gl/objects.h"

namespace occlod::gl {

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
