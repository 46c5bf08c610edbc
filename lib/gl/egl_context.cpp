// EGL without a window: EGL_MESA_platform_surfaceless, or a device of EGL_EXT_platform_device, and no surface at all.
#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <sstream>
#include <string>
#include <vector>

#include "gl/context_base.h"
#include "gl/shared_library.h"
#include "occlod/core/error.h"

namespace occlod::gl {
namespace {

constexpr const char* driver_mend =
    "install a driver with OpenGL 3.3 for EGL (Debian, Ubuntu: libegl-mesa0), or use OSMesa";

struct Egl {
  SharedLibrary library{{"libEGL.so.1", "libEGL.so"},
                        "install libEGL (Debian, Ubuntu: libegl1 and libegl-mesa0), or use OSMesa"};
  PFNEGLBINDAPIPROC bind_api = library.symbol<PFNEGLBINDAPIPROC>("eglBindAPI");
  PFNEGLCHOOSECONFIGPROC choose_config = library.symbol<PFNEGLCHOOSECONFIGPROC>("eglChooseConfig");
  PFNEGLCREATECONTEXTPROC create_context = library.symbol<PFNEGLCREATECONTEXTPROC>("eglCreateContext");
  PFNEGLDESTROYCONTEXTPROC destroy_context = library.symbol<PFNEGLDESTROYCONTEXTPROC>("eglDestroyContext");
  PFNEGLGETCURRENTCONTEXTPROC get_current_context = library.symbol<PFNEGLGETCURRENTCONTEXTPROC>("eglGetCurrentContext");
  PFNEGLGETERRORPROC get_error = library.symbol<PFNEGLGETERRORPROC>("eglGetError");
  PFNEGLGETPROCADDRESSPROC get_proc_address = library.symbol<PFNEGLGETPROCADDRESSPROC>("eglGetProcAddress");
  PFNEGLINITIALIZEPROC initialize = library.symbol<PFNEGLINITIALIZEPROC>("eglInitialize");
  PFNEGLMAKECURRENTPROC make_current = library.symbol<PFNEGLMAKECURRENTPROC>("eglMakeCurrent");
  PFNEGLQUERYSTRINGPROC query_string = library.symbol<PFNEGLQUERYSTRINGPROC>("eglQueryString");

  [[nodiscard]] Error failure(const char* place, const std::string& problem) const {
    std::ostringstream code;
    code << std::hex << get_error();
    return Error({"EGL", place, problem + " (EGL error 0x" + code.str() + ")", driver_mend});
  }

  [[nodiscard]] bool has_extension(EGLDisplay display, const std::string& name) const {
    const char* all = query_string(display, EGL_EXTENSIONS);
    if (all == nullptr) return false;
    std::istringstream names(all);
    for (std::string one; names >> one;)
      if (one == name) return true;
    return false;
  }

  template <class Function>
  [[nodiscard]] Function extension_function(const char* name) const {
    const auto found = reinterpret_cast<Function>(get_proc_address(name));
    if (found == nullptr) throw Error({"EGL", "", std::string("has no function ") + name, driver_mend});
    return found;
  }
};

const Egl& egl() {
  static const Egl instance;
  return instance;
}

// A display, once initialised, stays so: EGL hands the same one to everybody in the process who asks for it, and ending
// it would end theirs.
bool starts(EGLDisplay display) {
  return display != EGL_NO_DISPLAY && egl().initialize(display, nullptr, nullptr) == EGL_TRUE &&
         egl().has_extension(display, "EGL_KHR_surfaceless_context");
}

EGLDisplay surfaceless_display() {
  if (!egl().has_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
    throw Error({"EGL", "surfaceless", "EGL_MESA_platform_surfaceless is missing", driver_mend});
  const auto get_display = egl().extension_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  const EGLDisplay display = get_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  if (!starts(display)) throw egl().failure("surfaceless", "no display without a surface starts");
  return display;
}

EGLDisplay device_display() {
  if (!egl().has_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device"))
    throw Error({"EGL", "device", "EGL_EXT_platform_device is missing", driver_mend});
  const auto query_devices = egl().extension_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto get_display = egl().extension_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  std::array<EGLDeviceEXT, 16> devices{};
  EGLint count = 0;
  if (query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count) != EGL_TRUE)
    throw egl().failure("device", "devices cannot be listed");
  for (EGLint i = 0; i < count; ++i) {
    const EGLDisplay display = get_display(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr);
    if (starts(display)) return display;
  }
  throw egl().failure("device", "none of " + std::to_string(count) + " devices starts");
}

EGLConfig any_config(EGLDisplay display) {
  if (egl().has_extension(display, "EGL_KHR_no_config_context")) return EGL_NO_CONFIG_KHR;
  constexpr std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                         EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (egl().choose_config(display, wanted.data(), &config, 1, &count) != EGL_TRUE || count == 0)
    throw egl().failure("", "no configuration offers OpenGL");
  return config;
}

// Null when the driver has no such context. With `tells_resets` it is lost, and says so, when the GPU is reset.
EGLContext try_core_context(EGLDisplay display, EGLConfig config, bool tells_resets) {
  std::vector<EGLint> attributes{EGL_CONTEXT_MAJOR_VERSION,       3,
                                 EGL_CONTEXT_MINOR_VERSION,       3,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
#ifndef NDEBUG
  // The driver explains its errors: see Functions::driver_message.
  if (egl().has_extension(display, "EGL_KHR_create_context"))
    attributes.insert(attributes.end(), {EGL_CONTEXT_FLAGS_KHR, EGL_CONTEXT_OPENGL_DEBUG_BIT_KHR});
#endif
  if (tells_resets)
    attributes.insert(attributes.end(), {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET});
  attributes.push_back(EGL_NONE);
  return egl().create_context(display, config, EGL_NO_CONTEXT, attributes.data());
}

EGLContext create_core_context(EGLDisplay display) {
  if (egl().bind_api(EGL_OPENGL_API) != EGL_TRUE) throw egl().failure("", "OpenGL is not offered");
  const EGLConfig config = any_config(display);
  EGLContext context = try_core_context(display, config, true);
  if (context == EGL_NO_CONTEXT) context = try_core_context(display, config, false);
  if (context == EGL_NO_CONTEXT) throw egl().failure("", "no OpenGL 3.3 core context can be made");
  return context;
}

class EglContext final : public ContextBase {
 public:
  EglContext(std::string_view name, EGLDisplay display)
      : ContextBase(name), display_(display), context_(create_core_context(display)) {
    try {
      start(egl().get_proc_address);
    } catch (...) {
      end();
      throw;
    }
  }
  EglContext(const EglContext&) = delete;
  EglContext(EglContext&&) = delete;
  EglContext& operator=(const EglContext&) = delete;
  EglContext& operator=(EglContext&&) = delete;
  ~EglContext() override { end(); }

 protected:
  [[nodiscard]] bool is_current() const noexcept override { return egl().get_current_context() == context_; }
  void bind() override {
    egl().bind_api(EGL_OPENGL_API);
    if (egl().make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE)
      throw egl().failure("", "the context cannot be made current; it may be in use by another thread");
  }
  void unbind() noexcept override {
    egl().bind_api(EGL_OPENGL_API);
    egl().make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }

 private:
  void end() noexcept {
    retire();
    egl().destroy_context(display_, context_);
  }

  EGLDisplay display_;
  EGLContext context_;
};

}  // namespace

std::unique_ptr<Context> create_egl_context(EglDisplayKind kind) {
  if (kind == EglDisplayKind::surfaceless)
    return std::make_unique<EglContext>("egl-surfaceless", surfaceless_display());
  return std::make_unique<EglContext>("egl-device", device_display());
}

}  // namespace occlod::gl
