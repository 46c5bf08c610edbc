// Owners of OpenGL objects. All need their context to be current when they are made, used and destroyed.
#pragma once

#include <utility>

#include "gl/functions.h"

namespace occlod::gl {

// One object made by `generate` and ended by `destroy`, both members of Functions.
template <auto generate, auto destroy>
class Object {
 public:
  explicit Object(const Functions& gl) : gl_(&gl) { (gl.*generate)(1, &id_); }
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;
  Object(Object&& other) noexcept : gl_(other.gl_), id_(std::exchange(other.id_, 0)) {}
  Object& operator=(Object&& other) noexcept {
    std::swap(gl_, other.gl_);
    std::swap(id_, other.id_);
    return *this;
  }
  ~Object() {
    if (id_ != 0) (gl_->*destroy)(1, &id_);
  }
  [[nodiscard]] GLuint id() const noexcept { return id_; }
  // Leaves the object to the end of its context.
  void abandon() noexcept { id_ = 0; }

 private:
  const Functions* gl_;
  GLuint id_ = 0;
};

using Buffer = Object<&Functions::GenBuffers, &Functions::DeleteBuffers>;
using VertexArray = Object<&Functions::GenVertexArrays, &Functions::DeleteVertexArrays>;
using Framebuffer = Object<&Functions::GenFramebuffers, &Functions::DeleteFramebuffers>;
using Renderbuffer = Object<&Functions::GenRenderbuffers, &Functions::DeleteRenderbuffers>;
using Query = Object<&Functions::GenQueries, &Functions::DeleteQueries>;

class Program {
 public:
  // Throws Error with the compiler's or linker's log.
  Program(const Functions& gl, const char* vertex_source, const char* fragment_source);
  Program(const Program&) = delete;
  Program(Program&&) = delete;
  Program& operator=(const Program&) = delete;
  Program& operator=(Program&&) = delete;
  ~Program() { gl_->DeleteProgram(id_); }
  [[nodiscard]] GLuint id() const noexcept { return id_; }

 private:
  const Functions* gl_;
  GLuint id_ = 0;
};

// A framebuffer with a 32-bit float depth buffer and no colour.
class DepthTarget {
 public:
  explicit DepthTarget(const Functions& gl);
  // Binds the framebuffer for drawing, with storage of this size in pixels. Throws Error for more than the driver can
  // hold.
  void bind(int width, int height);

 private:
  const Functions* gl_;
  Framebuffer framebuffer_;
  Renderbuffer depth_;
  int width_ = 0;
  int height_ = 0;
};

}  // namespace occlod::gl
