// Opens a shared library at run time, so that its absence causes an error message instead of a failure to link or to
// start.
#pragma once

#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>

#include "gl/functions.h"
#include "occlod/gl.h"

namespace occlod::gl {

class SharedLibrary {
 public:
  // Opens the first of `names` that is found. Throws Error with `remedy` when none is. Never closes the library:
  // drivers leave thread-local destructors behind that point into it.
  SharedLibrary(std::initializer_list<const char*> names, const char* remedy);

  // Returns the symbol. Throws Error when the library does not have it.
  template <class Function>
  [[nodiscard]] Function symbol(const char* name) const {
    return reinterpret_cast<Function>(address(name));
  }

 private:
  [[nodiscard]] void* address(const char* name) const;

  void* handle_ = nullptr;
  std::string name_;
};

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
