// The shaders that draw nodes.
#pragma once

#include <glm/mat4x4.hpp>

#include "gl/eye_space.h"
#include "gl/objects.h"

namespace occlod::gl {

// Vertices as ArenaVertex has them; flat two-sided shading with the lights of shade() in src/picture/shade.cpp.
class NodeProgram {
 public:
  // `dear`: the sky is made of eight lights with highlights, and colours are encoded exactly.
  NodeProgram(const Functions& gl, bool dear);
  void use() const { gl_->UseProgram(program_.id()); }
  // Of the program in use.
  void set_view(const View& view) const;
  void set_object(const EyeSpace& object) const;
  void set_morph(float morph) const { gl_->Uniform1f(morph_, morph); }

 private:
  const Functions* gl_;
  Program program_;
  GLint view_to_clip_;
  GLint orthographic_;
  GLint eye_;
  GLint to_view_;
  GLint offset_;
  GLint morph_;
};

}  // namespace occlod::gl
