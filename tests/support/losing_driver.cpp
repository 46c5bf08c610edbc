// Preloaded into a program (LD_PRELOAD), changes its OpenGL driver, whichever it is:
// - LOSE_CONTEXT_AT=N: says once that the context was lost, when the program asks for that the time N (0 = the first).
// - REFUSE_LOSING_CONTEXTS=1: makes no contexts that would be lost when the GPU is reset, though it says that it can.
// Programs find drivers' functions through dlsym().
#define EGL_NO_X11
#include <EGL/egl.h>
#include <GL/glcorearb.h>
#include <dlfcn.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

using Proc = void (*)();
using GetProc = Proc (*)(const char*);

GLenum APIENTRY reset_status() {
  static std::atomic<long> asked{0};
  static const char* const when = std::getenv("LOSE_CONTEXT_AT");
  return when != nullptr && asked++ == std::atol(when) ? GL_GUILTY_CONTEXT_RESET : GL_NO_ERROR;
}

// In a list of names and values.
bool has_attribute(const int* list, int name) {
  for (; list != nullptr && *list != 0 && *list != EGL_NONE; list += 2)
    if (*list == name) return true;
  return false;
}

PFNEGLCREATECONTEXTPROC egl_create = nullptr;
EGLContext EGLAPIENTRY refuse_egl(EGLDisplay display, EGLConfig config, EGLContext shared, const EGLint* attributes) {
  if (has_attribute(attributes, EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY)) return EGL_NO_CONTEXT;
  return egl_create(display, config, shared, attributes);
}

using GlxExtensions = const char* (*)(void*, int);
GlxExtensions glx_extensions = nullptr;
// Xvfb does not offer this one, and GLFW asks for nothing that is not offered.
const char* promise_glx(void* display, int screen) {
  static const std::string text = std::string(glx_extensions(display, screen)) + " GLX_ARB_create_context_robustness";
  return text.c_str();
}

// Display*, GLXFBConfig, GLXContext, direct, attributes.
using GlxCreate = void* (*)(void*, void*, void*, int, const int*);
GlxCreate glx_create = nullptr;
void* refuse_glx(void* display, void* config, void* shared, int direct, const int* attributes) {
  constexpr int reset_notification_strategy = 0x8256;  // GLX_CONTEXT_RESET_NOTIFICATION_STRATEGY_ARB
  if (has_attribute(attributes, reset_notification_strategy)) return nullptr;
  return glx_create(display, config, shared, direct, attributes);
}

// The driver's functions that find others by their names.
constexpr std::array<const char*, 4> finders{"eglGetProcAddress", "glXGetProcAddress", "glXGetProcAddressARB",
                                             "OSMesaGetProcAddress"};
std::array<GetProc, finders.size()> drivers_own{};

// What programs get instead of a function that is called so.
Proc changed(const char* name, Proc found) {
  static const bool refuses = std::getenv("REFUSE_LOSING_CONTEXTS") != nullptr;
  if (std::strcmp(name, "glGetGraphicsResetStatus") == 0) return reinterpret_cast<Proc>(reset_status);
  if (refuses && std::strcmp(name, "eglCreateContext") == 0) {
    egl_create = reinterpret_cast<PFNEGLCREATECONTEXTPROC>(found);
    return reinterpret_cast<Proc>(refuse_egl);
  }
  if (refuses && std::strcmp(name, "glXQueryExtensionsString") == 0) {
    glx_extensions = reinterpret_cast<GlxExtensions>(found);
    return reinterpret_cast<Proc>(promise_glx);
  }
  if (refuses && std::strcmp(name, "glXCreateContextAttribsARB") == 0) {
    glx_create = reinterpret_cast<GlxCreate>(found);
    return reinterpret_cast<Proc>(refuse_glx);
  }
  return found;
}

template <std::size_t finder>
Proc find(const char* name) {
  return changed(name, drivers_own[finder](name));
}
constexpr std::array<GetProc, finders.size()> ours{find<0>, find<1>, find<2>, find<3>};

using Dlsym = void* (*)(void*, const char*);
Dlsym system_dlsym() {
  // Since glibc 2.34, before that, and before that on 64-bit ARM.
  for (const char* version : {"GLIBC_2.34", "GLIBC_2.2.5", "GLIBC_2.17"})
    if (void* found = dlvsym(RTLD_NEXT, "dlsym", version)) return reinterpret_cast<Dlsym>(found);
  std::abort();
}

}  // namespace

extern "C" void* dlsym(void* handle, const char* name) noexcept {
  static const Dlsym real = system_dlsym();
  void* const found = real(handle, name);
  if (found == nullptr) return nullptr;
  for (std::size_t i = 0; i < finders.size(); ++i)
    if (std::strcmp(name, finders[i]) == 0) {
      drivers_own[i] = reinterpret_cast<GetProc>(found);
      return reinterpret_cast<void*>(ours[i]);
    }
  return reinterpret_cast<void*>(changed(name, reinterpret_cast<Proc>(found)));
}
