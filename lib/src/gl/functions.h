// The OpenGL entry points we use, one table for each context: EGL and OSMesa answer with different addresses in one
// process, which process-wide loaders (epoxy, GLEW) cannot hold.
#pragma once

#include <GL/glcorearb.h>

#include <memory>
#include <string>

namespace occlod::gl {

// X(the middle of the PFNGL...PROC type, the name without "gl")
#define OCCLOD_GL_FUNCTIONS(X)                        \
  X(ATTACHSHADER, AttachShader)                       \
  X(BEGINQUERY, BeginQuery)                           \
  X(BINDBUFFER, BindBuffer)                           \
  X(BINDFRAMEBUFFER, BindFramebuffer)                 \
  X(BINDRENDERBUFFER, BindRenderbuffer)               \
  X(BINDVERTEXARRAY, BindVertexArray)                 \
  X(BUFFERDATA, BufferData)                           \
  X(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus)   \
  X(CLEAR, Clear)                                     \
  X(CLEARDEPTH, ClearDepth)                           \
  X(COMPILESHADER, CompileShader)                     \
  X(CREATEPROGRAM, CreateProgram)                     \
  X(CREATESHADER, CreateShader)                       \
  X(CULLFACE, CullFace)                               \
  X(DELETEBUFFERS, DeleteBuffers)                     \
  X(DELETEFRAMEBUFFERS, DeleteFramebuffers)           \
  X(DELETEPROGRAM, DeleteProgram)                     \
  X(DELETEQUERIES, DeleteQueries)                     \
  X(DELETERENDERBUFFERS, DeleteRenderbuffers)         \
  X(DELETESHADER, DeleteShader)                       \
  X(DELETEVERTEXARRAYS, DeleteVertexArrays)           \
  X(DEPTHFUNC, DepthFunc)                             \
  X(DEPTHMASK, DepthMask)                             \
  X(DEPTHRANGE, DepthRange)                           \
  X(DISABLE, Disable)                                 \
  X(DRAWBUFFER, DrawBuffer)                           \
  X(DRAWELEMENTS, DrawElements)                       \
  X(ENABLE, Enable)                                   \
  X(ENABLEVERTEXATTRIBARRAY, EnableVertexAttribArray) \
  X(ENDQUERY, EndQuery)                               \
  X(FLUSH, Flush)                                     \
  X(FRAMEBUFFERRENDERBUFFER, FramebufferRenderbuffer) \
  X(FRONTFACE, FrontFace)                             \
  X(GENBUFFERS, GenBuffers)                           \
  X(GENFRAMEBUFFERS, GenFramebuffers)                 \
  X(GENQUERIES, GenQueries)                           \
  X(GENRENDERBUFFERS, GenRenderbuffers)               \
  X(GENVERTEXARRAYS, GenVertexArrays)                 \
  X(GETERROR, GetError)                               \
  X(GETINTEGERV, GetIntegerv)                         \
  X(GETPROGRAMINFOLOG, GetProgramInfoLog)             \
  X(GETPROGRAMIV, GetProgramiv)                       \
  X(GETQUERYOBJECTUIV, GetQueryObjectuiv)             \
  X(GETSHADERINFOLOG, GetShaderInfoLog)               \
  X(GETSHADERIV, GetShaderiv)                         \
  X(GETSTRING, GetString)                             \
  X(GETSTRINGI, GetStringi)                           \
  X(GETUNIFORMLOCATION, GetUniformLocation)           \
  X(LINKPROGRAM, LinkProgram)                         \
  X(POLYGONOFFSET, PolygonOffset)                     \
  X(READBUFFER, ReadBuffer)                           \
  X(RENDERBUFFERSTORAGE, RenderbufferStorage)         \
  X(SHADERSOURCE, ShaderSource)                       \
  X(UNIFORMMATRIX4FV, UniformMatrix4fv)               \
  X(USEPROGRAM, UseProgram)                           \
  X(VERTEXATTRIBPOINTER, VertexAttribPointer)         \
  X(VIEWPORT, Viewport)

struct Functions {
#define OCCLOD_GL_MEMBER(TYPE, name) PFNGL##TYPE##PROC name = nullptr;
  OCCLOD_GL_FUNCTIONS(OCCLOD_GL_MEMBER)
#undef OCCLOD_GL_MEMBER
  // The driver's last complaint, filled in debug builds where it offers KHR_debug; check() quotes it. Else null.
  std::shared_ptr<std::string> driver_message;
};

using Proc = void (*)();
using GetProc = Proc (*)(const char* name);

// Needs the context to be current. `subject` names it in errors. Throws Error that names a missing function, or for a
// context older than 3.3.
[[nodiscard]] Functions load_functions(GetProc get_proc, const std::string& subject);

// Throws Error when OpenGL has recorded one since the last check. `where`: the step that has just been done.
void check(const Functions& gl, const char* where);

}  // namespace occlod::gl
