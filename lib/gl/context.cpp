#include "occlod/gl/context.h"

#include <cstdlib>
#include <mutex>

#include "gl/context_base.h"
#include "occlod/core/error.h"

namespace occlod::gl {
namespace {

// The context that this thread made current last. Mesa's EGL and OSMesa share one slot for it, and each platform
// believes its own context to be current still after the other has taken the slot: so the platform's word alone is not
// enough.
thread_local ContextBase* bound_here = nullptr;

// llvmpipe reads LP_NUM_THREADS when it first starts in a process. 0 = it draws on the calling thread, where waking a
// worker for each query costs more than drawing it: 14 instead of 85 us for a query that is waited for. Other drivers
// ignore it. A value set by the user is kept.
void calm_llvmpipe() {
  static std::once_flag once;
  std::call_once(once, [] { setenv("LP_NUM_THREADS", "0", 0); });
}

std::string text(const Functions& gl, GLenum name) {
  const GLubyte* value = gl.GetString(name);
  return value != nullptr ? reinterpret_cast<const char*>(value) : "";
}

std::string reason(const Error& error) {
  const Diagnosis& d = error.diagnosis();
  return d.subject + (d.place.empty() ? "" : " " + d.place) + ": " + d.problem;
}

// When both fail for the same reason (no library), it is reported once.
[[noreturn]] void refuse_both(const char* subject, const Error& first, const Error& second, const std::string& remedy) {
  std::string reasons = reason(first);
  if (reason(second) != reasons) reasons += ", " + reason(second);
  throw Error({subject, "", "no OpenGL context (" + reasons + ")", remedy});
}

}  // namespace

std::string ContextBase::renderer() const { return text(functions_, GL_RENDERER); }
std::string ContextBase::version() const { return text(functions_, GL_VERSION); }

void ContextBase::make_current() {
  if (bound_here == this && is_current()) return;
  if (bound_here != nullptr && bound_here != this) bound_here->unbind();
  bound_here = nullptr;
  bind();
  bound_here = this;
}

void ContextBase::start(GetProc get_proc) {
  make_current();
  functions_ = load_functions(get_proc, std::string(platform_name_));
}

void ContextBase::retire() noexcept {
  if (bound_here != this) return;
  unbind();
  bound_here = nullptr;
}

std::unique_ptr<Context> create_context(Platform platform) {
  calm_llvmpipe();
  if (platform == Platform::osmesa) return create_osmesa_context();
  try {
    return create_egl_context(EglDisplayKind::surfaceless);
  } catch (const Error& surfaceless) {
    try {
      return create_egl_context(EglDisplayKind::device);
    } catch (const Error& device) {
      refuse_both("EGL", surfaceless, device, surfaceless.diagnosis().remedy);
    }
  }
}

std::unique_ptr<Context> create_any_context() {
  try {
    return create_context(Platform::egl);
  } catch (const Error& egl) {
    try {
      return create_context(Platform::osmesa);
    } catch (const Error& osmesa) {
      refuse_both("OpenGL", egl, osmesa,
                  "install EGL or OSMesa (Debian, Ubuntu: libegl-mesa0 or libosmesa6), or use the software backend");
    }
  }
}

}  // namespace occlod::gl
