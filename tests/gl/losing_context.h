// Contexts that are lost. No driver here loses any, so function tables play them.
#pragma once

#include <memory>
#include <utility>

#include "gl/counting_context.h"
#include "gl/functions.h"

namespace occlod::gl {

// Lost after so many calls. From then on as KHR_robustness says: calls do nothing and leave what they should fill as it
// was, GetError says GL_CONTEXT_LOST, queries are over at once, and the reset is told a single time. One at a time.
class LosingContext final : public ContextWithFunctions {
 public:
  LosingContext(const std::shared_ptr<Context>& inner, long calls_before) : ContextWithFunctions(inner) {
    real = inner->functions();
    calls = 0;
    lost_after = calls_before;
    told = false;
#define LOSE(TYPE, name) \
  if (real.name != nullptr) functions_.name = Losing<&Functions::name, PFNGL##TYPE##PROC>::call;
    OCCLOD_GL_FUNCTIONS(LOSE)
    OCCLOD_GL_NEWER_FUNCTIONS(LOSE)
#undef LOSE
    functions_.GetError = []() -> GLenum { return is_lost() ? GLenum{GL_CONTEXT_LOST} : real.GetError(); };
    functions_.GetGraphicsResetStatus = []() -> GLenum {
      return is_lost() && !std::exchange(told, true) ? GL_INNOCENT_CONTEXT_RESET : GL_NO_ERROR;
    };
    functions_.GetQueryObjectuiv = [](GLuint query, GLenum name, GLuint* value) {
      if (!is_lost()) return real.GetQueryObjectuiv(query, name, value);
      if (name == GL_QUERY_RESULT_AVAILABLE) *value = GL_TRUE;
    };
  }

  static inline long calls = 0;

 private:
  template <auto member, class Function>
  struct Losing;
  template <auto member, class Result, class... Arguments>
  struct Losing<member, Result (*)(Arguments...)> {
    static Result call(Arguments... arguments) {
      if (is_lost()) return Result();
      return (real.*member)(arguments...);
    }
  };
  static bool is_lost() { return ++calls > lost_after; }

  static inline Functions real;
  static inline long lost_after = 0;
  static inline bool told = false;
};

// A driver that tells the reset and never comes to an end, against KHR_robustness.
class HangingContext final : public ContextWithFunctions {
 public:
  explicit HangingContext(const std::shared_ptr<Context>& inner) : ContextWithFunctions(inner) {
    waited = false;
    functions_.GetQueryObjectuiv = [](GLuint, GLenum, GLuint* value) {
      waited = true;
      *value = GL_FALSE;
    };
    functions_.ClientWaitSync = [](GLsync, GLbitfield, GLuint64) -> GLenum {
      waited = true;
      return GL_TIMEOUT_EXPIRED;
    };
    functions_.GetGraphicsResetStatus = []() -> GLenum { return waited ? GL_UNKNOWN_CONTEXT_RESET : GL_NO_ERROR; };
  }

 private:
  static inline bool waited = false;
};

}  // namespace occlod::gl
