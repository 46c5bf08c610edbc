// A context that counts the OpenGL objects alive: made less deleted. Works on a copy of the real function table.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "gl/functions.h"
#include "occlod/gl.h"

namespace occlod::gl {

// A context with functions of its own.
class ContextWithFunctions : public Context {
 public:
  explicit ContextWithFunctions(std::shared_ptr<Context> inner)
      : functions_(inner->functions()), inner_(std::move(inner)) {}
  [[nodiscard]] const Functions& functions() const noexcept final { return functions_; }
  [[nodiscard]] std::string_view platform_name() const noexcept final { return inner_->platform_name(); }
  [[nodiscard]] std::string renderer() const override { return inner_->renderer(); }
  [[nodiscard]] std::string version() const final { return inner_->version(); }
  void make_current() override { inner_->make_current(); }

 protected:
  Functions functions_;

 private:
  std::shared_ptr<Context> inner_;
};

// One at a time.
class CountingContext final : public ContextWithFunctions {
 public:
  explicit CountingContext(const std::shared_ptr<Context>& inner) : ContextWithFunctions(inner) {
    real = &inner->functions();
    alive = 0;
    queries_made = 0;
#define COUNT(Gen, Delete)                               \
  functions_.Gen = [](GLsizei n, GLuint* ids) {          \
    alive += n;                                          \
    real->Gen(n, ids);                                   \
  };                                                     \
  functions_.Delete = [](GLsizei n, const GLuint* ids) { \
    alive -= n;                                          \
    real->Delete(n, ids);                                \
  };
    COUNT(GenBuffers, DeleteBuffers)
    COUNT(GenVertexArrays, DeleteVertexArrays)
    COUNT(GenFramebuffers, DeleteFramebuffers)
    COUNT(GenTextures, DeleteTextures)
    COUNT(GenRenderbuffers, DeleteRenderbuffers)
    COUNT(GenQueries, DeleteQueries)
#undef COUNT
    functions_.GenQueries = [](GLsizei n, GLuint* ids) {
      alive += n;
      queries_made += n;
      real->GenQueries(n, ids);
    };
#define COUNT(Create, Delete, Id)             \
  functions_.Create = [](auto... arguments) { \
    ++alive;                                  \
    return real->Create(arguments...);        \
  };                                          \
  functions_.Delete = [](Id id) {             \
    --alive;                                  \
    real->Delete(id);                         \
  };
    COUNT(CreateShader, DeleteShader, GLuint)
    COUNT(CreateProgram, DeleteProgram, GLuint)
    COUNT(FenceSync, DeleteSync, GLsync)
#undef COUNT
  }

  static inline long alive = 0;
  static inline long queries_made = 0;

 private:
  static inline const Functions* real = nullptr;
};

}  // namespace occlod::gl
