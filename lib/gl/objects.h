// Owns OpenGL objects. The context must be current when they are made, used and destroyed.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "gl/functions.h"
#include "occlod/base.h"
#include "occlod/gl.h"

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

// Holds idle query objects of one target, because an object keeps the target of its first use. The context must be
// current in every call.
class QueryPool {
 public:
  explicit QueryPool(GLenum target) : target_(target) {}

  // Begins a query that counts what is drawn between begin() and end().
  [[nodiscard]] Query begin(const Functions& gl);
  void end(const Functions& gl) const { gl.EndQuery(target_); }
  // Returns whether the answer is available. Never waits, if the driver follows the specification.
  [[nodiscard]] static bool is_available(const Functions& gl, const Query& query);
  // Waits for the answer and recycles the object. Throws Error when there is none after 10 s, and ContextLost when the
  // context is lost meanwhile.
  [[nodiscard]] std::uint32_t take(const Functions& gl, Query query);
  // Recycles a query whose answer is no longer wanted.
  void drop(Query query) { idle_.push_back(std::move(query)); }

 private:
  GLenum target_;
  std::vector<Query> idle_;
};

// Makes a T from (functions, arguments...) while the context is current, and destroys it while the context is current.
template <class T>
class InContext {
 public:
  template <class... Arguments>
  explicit InContext(std::shared_ptr<Context> context, Arguments&&... arguments) : context_(std::move(context)) {
    context_->make_current();
    value_ = std::make_unique<T>(context_->functions(), std::forward<Arguments>(arguments)...);
  }
  InContext(const InContext&) = delete;
  InContext(InContext&&) = delete;
  InContext& operator=(const InContext&) = delete;
  InContext& operator=(InContext&&) = delete;
  ~InContext() {
    try {
      context_->make_current();
    } catch (const Error&) {
      // Deleting now would affect the objects of another context. Ours are freed with their context.
      static_cast<void>(value_.release());
    }
  }

  // Makes the context current and returns the value.
  [[nodiscard]] T& use() const {
    context_->make_current();
    return *value_;
  }
  // Returns the value without making the context current, for members that do not need it.
  [[nodiscard]] const T& look() const noexcept { return *value_; }

 private:
  std::shared_ptr<Context> context_;
  std::unique_ptr<T> value_;
};

}  // namespace occlod::gl
