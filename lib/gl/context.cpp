#define EGL_NO_X11

#include "gl/context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <array>
#include <cstdlib>
#include <mutex>
#include <sstream>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "occlod/gl.h"

namespace occlod::gl {

SharedLibrary::SharedLibrary(std::initializer_list<const char*> names, const char* remedy) {
  for (const char* name : names) {
    handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    name_ = name;
    if (handle_ != nullptr) return;
  }
  // Reports only the last reason, that of the name without a version.
  const char* reason = dlerror();
  throw Error({name_, "", reason != nullptr ? reason : "cannot be opened", remedy});
}

void* SharedLibrary::address(const char* name) const {
  void* found = dlsym(handle_, name);
  if (found == nullptr)
    throw Error({name_, "", std::string("has no function ") + name, "install a newer version of it"});
  return found;
}

namespace {

// The context that this thread made current last. Mesa's EGL and OSMesa share one slot for it, and each platform still
// reports its own context as current after the other has taken the slot. So the platform's answer alone is not enough.
thread_local ContextBase* bound_here = nullptr;

// Sets LP_NUM_THREADS to 0, which llvmpipe reads when it first starts in a process: it then draws on the calling
// thread. Waking a worker for each query costs more than drawing: a query that is waited for takes 14 instead of 85 us.
// Other drivers ignore the variable. A value set by the user is kept.
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

// When both fail for the same reason (no library), the reason is reported once.
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

// Makes EGL contexts without a window: EGL_MESA_platform_surfaceless, or a device of EGL_EXT_platform_device, and no
// surface at all.

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

// Initialises a display, which is never terminated: EGL returns the same one to everybody in the process who asks for
// it, and terminating it would end theirs.
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

// Returns null when the driver has no such context. With `tells_resets` the context is lost, and reports it, when the
// GPU is reset.
EGLContext try_core_context(EGLDisplay display, EGLConfig config, bool tells_resets) {
  std::vector<EGLint> attributes{EGL_CONTEXT_MAJOR_VERSION,       3,
                                 EGL_CONTEXT_MINOR_VERSION,       3,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
#ifndef NDEBUG
  // Lets the driver explain its errors: see Functions::driver_message.
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

// Makes OSMesa contexts; the library is opened at run time. Its header is not needed to build (Mesa dropped the library
// in 2025): the few declarations are repeated here from Mesa 22's GL/osmesa.h.

namespace {

using OsMesaHandle = struct osmesa_context*;

constexpr int osmesa_format = 0x22;
constexpr int osmesa_profile = 0x33;
constexpr int osmesa_core_profile = 0x34;
constexpr int osmesa_context_major_version = 0x36;
constexpr int osmesa_context_minor_version = 0x37;

struct OsMesa {
  SharedLibrary library{{"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"},
                        "install OSMesa (Debian 12, Ubuntu 24.04: libosmesa6; newer ones have dropped it), or use EGL"};
  OsMesaHandle (*create)(const int*, OsMesaHandle) =
      library.symbol<OsMesaHandle (*)(const int*, OsMesaHandle)>("OSMesaCreateContextAttribs");
  void (*destroy)(OsMesaHandle) = library.symbol<void (*)(OsMesaHandle)>("OSMesaDestroyContext");
  GLboolean (*make_current)(OsMesaHandle, void*, GLenum, GLsizei, GLsizei) =
      library.symbol<GLboolean (*)(OsMesaHandle, void*, GLenum, GLsizei, GLsizei)>("OSMesaMakeCurrent");
  OsMesaHandle (*get_current)() = library.symbol<OsMesaHandle (*)()>("OSMesaGetCurrentContext");
  GetProc get_proc = library.symbol<GetProc>("OSMesaGetProcAddress");
};

const OsMesa& osmesa() {
  static const OsMesa instance;
  return instance;
}

OsMesaHandle create_core_context() {
  constexpr std::array<int, 9> attributes{osmesa_format,
                                          GL_RGBA,
                                          osmesa_profile,
                                          osmesa_core_profile,
                                          osmesa_context_major_version,
                                          3,
                                          osmesa_context_minor_version,
                                          3,
                                          0};
  const OsMesaHandle context = osmesa().create(attributes.data(), nullptr);
  if (context == nullptr)
    throw Error(
        {"OSMesa", "", "no OpenGL 3.3 core context can be made", "install Mesa 17 or newer with llvmpipe, or use EGL"});
  return context;
}

class OsMesaContext final : public ContextBase {
 public:
  OsMesaContext() : ContextBase("osmesa"), context_(create_core_context()) {
    try {
      start(osmesa().get_proc);
    } catch (...) {
      end();
      throw;
    }
  }
  OsMesaContext(const OsMesaContext&) = delete;
  OsMesaContext(OsMesaContext&&) = delete;
  OsMesaContext& operator=(const OsMesaContext&) = delete;
  OsMesaContext& operator=(OsMesaContext&&) = delete;
  ~OsMesaContext() override { end(); }

 protected:
  [[nodiscard]] bool is_current() const noexcept override { return osmesa().get_current() == context_; }
  void bind() override {
    if (osmesa().make_current(context_, window_.data(), GL_UNSIGNED_BYTE, side, side) != GL_TRUE)
      throw Error({"OSMesa", "", "the context cannot be made current", "use it on the thread that made it"});
  }
  void unbind() noexcept override { osmesa().make_current(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }

 private:
  void end() noexcept {
    retire();
    osmesa().destroy(context_);
  }

  // OSMesa requires a default framebuffer; it is not used.
  static constexpr GLsizei side = 4;
  std::array<unsigned char, std::size_t{side} * side * 4> window_{};
  OsMesaHandle context_;
};

}  // namespace

std::unique_ptr<Context> create_osmesa_context() { return std::make_unique<OsMesaContext>(); }

}  // namespace occlod::gl
