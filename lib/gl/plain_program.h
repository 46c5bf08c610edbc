// Positions through one matrix, without colour: occluders and proxies.
#pragma once

#include <glm/mat4x4.hpp>

#include "gl/objects.h"

namespace occlod::gl {

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

}  // namespace occlod::gl
