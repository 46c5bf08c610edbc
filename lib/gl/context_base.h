// What EGL and OSMesa contexts share: the function table and the rule which of them is current.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "gl/functions.h"
#include "occlod/gl/context.h"

namespace occlod::gl {

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
  // To be called first in the destructor of the derived class, which ends the context.
  void retire() noexcept;

  [[nodiscard]] virtual bool is_current() const noexcept = 0;  // as the platform sees it
  virtual void bind() = 0;                                     // throws Error
  virtual void unbind() noexcept = 0;

 private:
  std::string_view platform_name_;
  Functions functions_;
};

enum class EglDisplayKind { surfaceless, device };
[[nodiscard]] std::unique_ptr<Context> create_egl_context(EglDisplayKind kind);
[[nodiscard]] std::unique_ptr<Context> create_osmesa_context();

}  // namespace occlod::gl
