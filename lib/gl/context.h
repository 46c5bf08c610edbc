// Makes OpenGL contexts by EGL and OSMesa, which are opened at run time.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "base/shared_library.h"
#include "gl/functions.h"
#include "occlod/gl.h"

namespace occlod::gl {

// Implements what EGL and OSMesa contexts share: the function table, and tracking which context is current.
class ContextBase : public Context {
 public:
  [[nodiscard]] const Functions& functions() const noexcept final { return functions_; }
  [[nodiscard]] std::string_view platform_name() const noexcept final { return platform_name_; }
  [[nodiscard]] std::string renderer() const final;
  [[nodiscard]] std::string version() const final;
  void make_current() final;

 protected:
  explicit ContextBase(std::string_view platform_name) : platform_name_(platform_name) {}
  // Makes the context current for the first time and loads its functions.
  void start(GetProc get_proc);
  // Must be called first in the destructor of the derived class, which destroys the context.
  void retire() noexcept;

  [[nodiscard]] virtual bool is_current() const noexcept = 0;  // according to the platform
  virtual void bind() = 0;                                     // throws Error
  virtual void unbind() noexcept = 0;

 private:
  std::string_view platform_name_;
  Functions functions_;
};

// Whether this renderer (GL_RENDERER) is a program on the processor. Such gather commands and work through them tile by
// tile.
[[nodiscard]] bool draws_on_cpu(std::string_view renderer);

enum class EglDisplayKind {
  surfaceless,
  device,  // GPUs first, then what draws on the processor
  gpu,     // a device that does not draw on the processor
};
[[nodiscard]] std::unique_ptr<Context> create_egl_context(EglDisplayKind kind);
[[nodiscard]] std::unique_ptr<Context> create_osmesa_context();

}  // namespace occlod::gl
