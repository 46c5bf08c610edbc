// An OpenGL context without a window, on whatever the machine offers.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace occlod::gl {

struct Functions;

// Where a context comes from.
enum class Platform {
  egl,     // surfaceless, else a device; a GPU or llvmpipe
  osmesa,  // Mesa's off-screen library, opened at run time; always on the CPU
};

// An OpenGL core context of version 3.3 or newer: drivers give the newest that is compatible. Several may live in one
// process. Create, use and destroy it on one thread; what uses it calls make_current() first and destroys its own
// objects before the context.
//
// Where the driver supports it, the context is lost when the GPU is reset. What uses it then throws Error that says so
// at its next view, occluder or batch of answers. Destroy it and everything that uses it; new ones work, and so does
// software occlusion.
class Context {
 public:
  Context(const Context&) = delete;
  Context(Context&&) = delete;
  Context& operator=(const Context&) = delete;
  Context& operator=(Context&&) = delete;
  virtual ~Context() = default;

  // The OpenGL entry points that the backends use; theirs alone.
  [[nodiscard]] virtual const Functions& functions() const noexcept = 0;
  // "egl-surfaceless", "egl-device" or "osmesa".
  [[nodiscard]] virtual std::string_view platform_name() const noexcept = 0;
  // GL_RENDERER, e.g. "llvmpipe (LLVM 15.0.6, 256 bits)".
  [[nodiscard]] virtual std::string renderer() const = 0;
  // GL_VERSION.
  [[nodiscard]] virtual std::string version() const = 0;
  // Cheap when it is current already. Throws Error when another thread holds it.
  virtual void make_current() = 0;

 protected:
  Context() = default;
};

// Current on return. Throws Error that says which library or extension is missing and what to install. The first call
// sets the environment variable LP_NUM_THREADS to 0 for this process, unless it is set: Mesa's llvmpipe then draws on
// the calling thread, where a query that is waited for takes 14 instead of 85 us. Other drivers do not read it. Like
// every setenv, not to be raced with getenv on other threads.
[[nodiscard]] std::unique_ptr<Context> create_context(Platform platform);
// EGL, else OSMesa; throws the reasons of both.
[[nodiscard]] std::unique_ptr<Context> create_any_context();

}  // namespace occlod::gl
