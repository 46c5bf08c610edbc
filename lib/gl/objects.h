// Owns OpenGL objects. The context must be current when they are made, used and destroyed.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <utility>

#include "gl/functions.h"

namespace occlod::gl {

// Owns one object that `generate` makes and `destroy` deletes, both members of Functions.
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

 private:
  const Functions* gl_;
  GLuint id_ = 0;
};

using Buffer = Object<&Functions::GenBuffers, &Functions::DeleteBuffers>;
using VertexArray = Object<&Functions::GenVertexArrays, &Functions::DeleteVertexArrays>;
using Framebuffer = Object<&Functions::GenFramebuffers, &Functions::DeleteFramebuffers>;
using Renderbuffer = Object<&Functions::GenRenderbuffers, &Functions::DeleteRenderbuffers>;
using Texture = Object<&Functions::GenTextures, &Functions::DeleteTextures>;
using Query = Object<&Functions::GenQueries, &Functions::DeleteQueries>;

struct ShaderSource {
  GLenum kind;
  const char* text;
};

class Program {
 public:
  // Builds the program. Throws Error with the compiler's or linker's log.
  Program(const Functions& gl, std::initializer_list<ShaderSource> sources);
  Program(const Program&) = delete;
  Program(Program&&) = delete;
  Program& operator=(const Program&) = delete;
  Program& operator=(Program&&) = delete;
  ~Program() { gl_->DeleteProgram(id_); }
  [[nodiscard]] GLuint id() const noexcept { return id_; }
  [[nodiscard]] GLint uniform(const char* name) const { return gl_->GetUniformLocation(id_, name); }

 private:
  const Functions* gl_;
  GLuint id_ = 0;
};

// A framebuffer with one image of 32-bit floats that shaders can read: a depth buffer or one colour channel.
class FloatTarget {
 public:
  enum class Kind { depth, red };
  FloatTarget(const Functions& gl, Kind kind);
  // Binds the framebuffer, with storage of this size in pixels. Throws Error for sizes that the driver does not
  // support.
  void bind(int width, int height);
  [[nodiscard]] GLuint texture() const noexcept { return texture_.id(); }

 private:
  void allocate() const;

  const Functions* gl_;
  Kind kind_;
  Framebuffer framebuffer_;
  Texture texture_;
  int width_ = 0;
  int height_ = 0;
};

// Marks the point in the command stream at which it is made.
class Fence {
 public:
  explicit Fence(const Functions& gl) : gl_(&gl), sync_(gl.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0)) {}
  Fence(const Fence&) = delete;
  Fence& operator=(const Fence&) = delete;
  Fence(Fence&& other) noexcept : gl_(other.gl_), sync_(std::exchange(other.sync_, nullptr)) {}
  Fence& operator=(Fence&& other) noexcept {
    std::swap(gl_, other.gl_);
    std::swap(sync_, other.sync_);
    return *this;
  }
  ~Fence() {
    if (sync_ != nullptr) gl_->DeleteSync(sync_);
  }
  // Returns whether wait() would return at once. Never waits itself, if the driver follows the specification.
  [[nodiscard]] bool is_over() const;
  // Waits until all commands before it are done. Throws Error that names `work` when they fail or are not done after 10
  // s.
  void wait(const char* work) const;

 private:
  const Functions* gl_;
  GLsync sync_;
};

// Replaces the contents of the buffer bound to `target`.
template <class T>
void fill(const Functions& gl, GLenum target, std::span<const T> data, GLenum usage) {
  gl.BufferData(target, static_cast<GLsizeiptr>(data.size_bytes()), data.data(), usage);
}

// Waits until all commands so far are done. Throws Error that names `work` when they fail or are not done after 10 s.
void finish(const Functions& gl, const char* work);

// Reads what shaders have written to the start of the buffer bound to GL_SHADER_STORAGE_BUFFER. Waits until `work` is
// done; throws Error that names it when it fails or is not done after 10 s.
void read_back(const Functions& gl, std::span<std::uint32_t> words, const char* work);
// Reads back like the overload above, but waits only for `written`: a fence after the work and after a barrier for
// buffer updates.
void read_back(const Functions& gl, std::span<std::uint32_t> words, const Fence& written, const char* work);

}  // namespace occlod::gl
