#include "gl/functions.h"

#include <string_view>

namespace occlod::gl {
namespace {

const char* error_name(GLenum code) {
  switch (code) {
    case GL_INVALID_ENUM:
      return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
      return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
      return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY:
      return "GL_OUT_OF_MEMORY";
    default:
      return "an unknown error";
  }
}

std::string reset_reason(GLenum reset) {
  switch (reset) {
    case GL_GUILTY_CONTEXT_RESET:
      return "the context is lost: this program has made the GPU reset";
    case GL_INNOCENT_CONTEXT_RESET:
      return "the context is lost: another program has made the GPU reset";
    default:
      return "the context is lost: the GPU was reset, for a reason that the driver does not know";
  }
}

int version_of(const Functions& gl) {
  GLint major = 0;
  GLint minor = 0;
  gl.GetIntegerv(GL_MAJOR_VERSION, &major);
  gl.GetIntegerv(GL_MINOR_VERSION, &minor);
  return 10 * major + minor;
}

std::string dotted(int version) { return std::to_string(version / 10) + "." + std::to_string(version % 10); }

bool has_extension(const Functions& gl, std::string_view wanted) {
  GLint extensions = 0;
  gl.GetIntegerv(GL_NUM_EXTENSIONS, &extensions);
  for (GLuint i = 0; i < static_cast<GLuint>(extensions); ++i) {
    const GLubyte* name = gl.GetStringi(GL_EXTENSIONS, i);
    if (name != nullptr && reinterpret_cast<const char*>(name) == wanted) return true;
  }
  return false;
}

// Loads the function only where it is supported: drivers return addresses of functions that they do not have.
PFNGLGETGRAPHICSRESETSTATUSPROC find_reset_status(const Functions& gl, GetProc get_proc) {
  const char* name = gl.version >= 45 || has_extension(gl, "GL_KHR_robustness") ? "glGetGraphicsResetStatus"
                     : has_extension(gl, "GL_ARB_robustness")                   ? "glGetGraphicsResetStatusARB"
                                                                                : nullptr;
  return name != nullptr ? reinterpret_cast<PFNGLGETGRAPHICSRESETSTATUSPROC>(get_proc(name)) : nullptr;
}

// Returns whether the context supports indirect draws; the address alone does not show it.
bool has_indirect_draws(const Functions& gl) {
  return gl.version >= 43 ||
         (has_extension(gl, "GL_ARB_multi_draw_indirect") && has_extension(gl, "GL_ARB_base_instance"));
}

#ifndef NDEBUG
void APIENTRY keep_message(GLenum, GLenum type, GLuint, GLenum, GLsizei, const GLchar* message, const void* user) {
  if (type == GL_DEBUG_TYPE_ERROR) *static_cast<std::string*>(const_cast<void*>(user)) = message;
}

void listen_to_driver(Functions& gl, GetProc get_proc) {
  if (!has_extension(gl, "GL_KHR_debug")) return;
  const auto set_callback = reinterpret_cast<PFNGLDEBUGMESSAGECALLBACKPROC>(get_proc("glDebugMessageCallback"));
  if (set_callback == nullptr) return;
  gl.driver_message = std::make_shared<std::string>();
  gl.Enable(GL_DEBUG_OUTPUT);
  gl.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  set_callback(keep_message, gl.driver_message.get());
}
#endif

// Loads everything except what depends on extensions.
Functions load_table(GetProc get_proc, const std::string& subject) {
  Functions gl;
#define OCCLOD_GL_LOAD(TYPE, name)                                     \
  gl.name = reinterpret_cast<PFNGL##TYPE##PROC>(get_proc("gl" #name)); \
  if (gl.name == nullptr)                                              \
    throw Error({subject, "", "has no function gl" #name,              \
                 "install a driver with OpenGL 3.3 core, or use the software backend"});
  OCCLOD_GL_FUNCTIONS(OCCLOD_GL_LOAD)
#undef OCCLOD_GL_LOAD
#define OCCLOD_GL_LOAD_NEWER(TYPE, name) gl.name = reinterpret_cast<PFNGL##TYPE##PROC>(get_proc("gl" #name));
  OCCLOD_GL_NEWER_FUNCTIONS(OCCLOD_GL_LOAD_NEWER)
#undef OCCLOD_GL_LOAD_NEWER
  return gl;
}

}  // namespace

Functions load_functions(GetProc get_proc, const std::string& subject) {
  Functions gl = load_table(get_proc, subject);
  gl.version = version_of(gl);
  if (gl.version < 33)
    throw Error({subject, "", "offers OpenGL " + dotted(gl.version) + " only",
                 "install a driver with OpenGL 3.3 core, or use the software backend"});
  if (!has_indirect_draws(gl)) gl.MultiDrawElementsIndirect = nullptr;
  gl.GetGraphicsResetStatus = find_reset_status(gl, get_proc);
#ifndef NDEBUG
  listen_to_driver(gl, get_proc);
#endif
  return gl;
}

ContextLost::ContextLost(const char* where, GLenum reset)
    : Error({"OpenGL", where, reset_reason(reset), "run again, or use the software backend"}) {}

void check(const Functions& gl, const char* where) {
  // Called in this order, so that a context lost in between is reported with its reason.
  const GLenum first = gl.GetError();
  const GLenum reset = gl.GetGraphicsResetStatus != nullptr ? gl.GetGraphicsResetStatus() : GLenum{GL_NO_ERROR};
  if (reset != GL_NO_ERROR || first == GL_CONTEXT_LOST) throw ContextLost(where, reset);
  if (first == GL_NO_ERROR) return;
  // OpenGL keeps one flag for each kind of error; the loop is bounded, because a lost context never runs out of them.
  for (int i = 0; i < 8 && gl.GetError() != GL_NO_ERROR; ++i) {
  }
  std::string problem = error_name(first);
  if (gl.driver_message && !gl.driver_message->empty()) problem += " (" + *gl.driver_message + ")";
  throw Error({"OpenGL", where, problem,
               first == GL_OUT_OF_MEMORY ? "use a smaller image or a smaller occluder"
                                         : "try another driver, or use the software backend"});
}

}  // namespace occlod::gl
