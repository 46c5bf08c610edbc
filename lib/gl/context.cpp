#define EGL_NO_X11

#include "gl/context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <mutex>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "occlod/base.h"
#include "occlod/gl.h"

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

// Mesa's switch to draw on the processor although there is a GPU.
bool asks_for_software() {
  const char* value = std::getenv("LIBGL_ALWAYS_SOFTWARE");
  const std::string_view asked = value != nullptr ? value : "";
  return !asked.empty() && asked != "0" && asked != "false";
}

// Whose library answers for the platform without surfaces is a matter of order: where it is Mesa, and has no driver for
// the GPU, it draws on the processor, though another vendor's library knows the GPU as a device.
std::unique_ptr<Context> on_gpu_if_any(std::unique_ptr<Context> found) {
  if (!draws_on_cpu(found->renderer()) || asks_for_software()) return found;
  try {
    auto on_gpu = create_egl_context(EglDisplayKind::gpu);
    if (!draws_on_cpu(on_gpu->renderer())) return on_gpu;
  } catch (const Error&) {
    // There is none, or none that starts.
  }
  found->make_current();
  return found;
}

}  // namespace

bool draws_on_cpu(std::string_view renderer) {
  constexpr std::array<std::string_view, 4> names{"llvmpipe", "softpipe", "swrast", "SwiftShader"};
  return std::any_of(names.begin(), names.end(),
                     [&](std::string_view name) { return renderer.find(name) != std::string_view::npos; });
}

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
    return on_gpu_if_any(create_egl_context(EglDisplayKind::surfaceless));
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

// EGL without a window: EGL_MESA_platform_surfaceless, or a device of EGL_EXT_platform_device, and no surface at all.

namespace {

constexpr const char* driver_mend =
    "install a driver with OpenGL 3.3 for EGL (Debian, Ubuntu: libegl-mesa0), or use OSMesa";

// all: names with blanks between them, or null.
bool lists(const char* all, const std::string& name) {
  std::istringstream names(all != nullptr ? all : "");
  for (std::string one; names >> one;)
    if (one == name) return true;
  return false;
}

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
    return lists(query_string(display, EGL_EXTENSIONS), name);
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

std::vector<EGLDeviceEXT> all_devices() {
  if (!egl().has_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device"))
    throw Error({"EGL", "device", "EGL_EXT_platform_device is missing", driver_mend});
  const auto query_devices = egl().extension_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  std::vector<EGLDeviceEXT> devices(64);
  EGLint count = 0;
  if (query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count) != EGL_TRUE)
    throw egl().failure("device", "devices cannot be listed");
  devices.resize(static_cast<std::size_t>(count));
  return devices;
}

// Mesa's devices that draw on the processor say so.
bool is_gpu(EGLDeviceEXT device) {
  const auto query_string = egl().extension_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  return !lists(query_string(device, EGL_EXTENSIONS), "EGL_MESA_device_software");
}

// Of the first device that starts: GPUs first, or GPUs only.
EGLDisplay device_display(bool only_gpus) {
  std::vector<EGLDeviceEXT> devices = all_devices();
  const auto rest = std::stable_partition(devices.begin(), devices.end(), is_gpu);
  if (only_gpus) devices.erase(rest, devices.end());
  const auto get_display = egl().extension_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  for (EGLDeviceEXT device : devices) {
    const EGLDisplay display = get_display(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
    if (starts(display)) return display;
  }
  throw egl().failure("device", "none of " + std::to_string(devices.size()) + " devices starts");
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

struct Version {
  EGLint major, minor;
};

// Null when the driver has no such context. With `tells_resets` it is lost, and says so, when the GPU is reset.
EGLContext try_core_context(EGLDisplay display, EGLConfig config, const Version& version, bool tells_resets) {
  std::vector<EGLint> attributes{EGL_CONTEXT_MAJOR_VERSION,       version.major,
                                 EGL_CONTEXT_MINOR_VERSION,       version.minor,
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

// The newest. Asked for 3.3, Mesa gives the newest that it has, NVIDIA's driver just 3.3.
EGLContext create_core_context(EGLDisplay display) {
  if (egl().bind_api(EGL_OPENGL_API) != EGL_TRUE) throw egl().failure("", "OpenGL is not offered");
  const EGLConfig config = any_config(display);
  constexpr std::array<Version, 8> versions{{{4, 6}, {4, 5}, {4, 4}, {4, 3}, {4, 2}, {4, 1}, {4, 0}, {3, 3}}};
  for (const Version& version : versions)
    for (const bool tells_resets : {true, false}) {
      const EGLContext context = try_core_context(display, config, version, tells_resets);
      if (context != EGL_NO_CONTEXT) return context;
    }
  throw egl().failure("", "no OpenGL 3.3 core context can be made");
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
  return std::make_unique<EglContext>("egl-device", device_display(kind == EglDisplayKind::gpu));
}

// OSMesa, opened at run time. Its header is not needed to build (Mesa dropped the library in 2025): the few
// declarations are repeated here from Mesa 22's GL/osmesa.h.

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
