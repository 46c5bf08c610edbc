// Holds the OpenGL entry points we use, in one table per context: EGL and OSMesa return different addresses in one
// process, which process-wide loaders (epoxy, GLEW) cannot represent.
#pragma once

#include <GL/glcorearb.h>

#include <memory>
#include <string>

#include "occlod/base.h"

namespace occlod::gl {

// The arguments of X are the middle of the PFNGL...PROC type and the name without "gl".
#define OCCLOD_GL_FUNCTIONS(X)                                      \
  X(ACTIVETEXTURE, ActiveTexture)                                   \
  X(ATTACHSHADER, AttachShader)                                     \
  X(BEGINQUERY, BeginQuery)                                         \
  X(BINDBUFFER, BindBuffer)                                         \
  X(BINDBUFFERBASE, BindBufferBase)                                 \
  X(BINDFRAMEBUFFER, BindFramebuffer)                               \
  X(BINDRENDERBUFFER, BindRenderbuffer)                             \
  X(BINDTEXTURE, BindTexture)                                       \
  X(BINDVERTEXARRAY, BindVertexArray)                               \
  X(BLENDFUNC, BlendFunc)                                           \
  X(BLITFRAMEBUFFER, BlitFramebuffer)                               \
  X(BUFFERDATA, BufferData)                                         \
  X(BUFFERSUBDATA, BufferSubData)                                   \
  X(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus)                 \
  X(CLEAR, Clear)                                                   \
  X(CLEARBUFFERFV, ClearBufferfv)                                   \
  X(CLEARDEPTH, ClearDepth)                                         \
  X(CLIENTWAITSYNC, ClientWaitSync)                                 \
  X(COLORMASK, ColorMask)                                           \
  X(COMPILESHADER, CompileShader)                                   \
  X(CREATEPROGRAM, CreateProgram)                                   \
  X(CREATESHADER, CreateShader)                                     \
  X(CULLFACE, CullFace)                                             \
  X(DELETEBUFFERS, DeleteBuffers)                                   \
  X(DELETEFRAMEBUFFERS, DeleteFramebuffers)                         \
  X(DELETEPROGRAM, DeleteProgram)                                   \
  X(DELETEQUERIES, DeleteQueries)                                   \
  X(DELETERENDERBUFFERS, DeleteRenderbuffers)                       \
  X(DELETESHADER, DeleteShader)                                     \
  X(DELETESYNC, DeleteSync)                                         \
  X(DELETETEXTURES, DeleteTextures)                                 \
  X(DELETEVERTEXARRAYS, DeleteVertexArrays)                         \
  X(DEPTHFUNC, DepthFunc)                                           \
  X(DEPTHMASK, DepthMask)                                           \
  X(DEPTHRANGE, DepthRange)                                         \
  X(DISABLE, Disable)                                               \
  X(DISABLEVERTEXATTRIBARRAY, DisableVertexAttribArray)             \
  X(DRAWARRAYS, DrawArrays)                                         \
  X(DRAWBUFFER, DrawBuffer)                                         \
  X(DRAWELEMENTS, DrawElements)                                     \
  X(DRAWELEMENTSBASEVERTEX, DrawElementsBaseVertex)                 \
  X(ENABLE, Enable)                                                 \
  X(ENABLEVERTEXATTRIBARRAY, EnableVertexAttribArray)               \
  X(ENDQUERY, EndQuery)                                             \
  X(FENCESYNC, FenceSync)                                           \
  X(FLUSH, Flush)                                                   \
  X(FRAMEBUFFERRENDERBUFFER, FramebufferRenderbuffer)               \
  X(FRAMEBUFFERTEXTURE2D, FramebufferTexture2D)                     \
  X(FRONTFACE, FrontFace)                                           \
  X(GENBUFFERS, GenBuffers)                                         \
  X(GENERATEMIPMAP, GenerateMipmap)                                 \
  X(GENFRAMEBUFFERS, GenFramebuffers)                               \
  X(GENQUERIES, GenQueries)                                         \
  X(GENRENDERBUFFERS, GenRenderbuffers)                             \
  X(GENTEXTURES, GenTextures)                                       \
  X(GENVERTEXARRAYS, GenVertexArrays)                               \
  X(GETBUFFERSUBDATA, GetBufferSubData)                             \
  X(GETERROR, GetError)                                             \
  X(GETINTEGERV, GetIntegerv)                                       \
  X(GETPROGRAMINFOLOG, GetProgramInfoLog)                           \
  X(GETPROGRAMIV, GetProgramiv)                                     \
  X(GETQUERYIV, GetQueryiv)                                         \
  X(GETQUERYOBJECTUI64V, GetQueryObjectui64v)                       \
  X(GETQUERYOBJECTUIV, GetQueryObjectuiv)                           \
  X(GETSHADERINFOLOG, GetShaderInfoLog)                             \
  X(GETSHADERIV, GetShaderiv)                                       \
  X(GETSTRING, GetString)                                           \
  X(GETSTRINGI, GetStringi)                                         \
  X(GETUNIFORMLOCATION, GetUniformLocation)                         \
  X(LINKPROGRAM, LinkProgram)                                       \
  X(MULTIDRAWELEMENTSBASEVERTEX, MultiDrawElementsBaseVertex)       \
  X(PIXELSTOREI, PixelStorei)                                       \
  X(POLYGONOFFSET, PolygonOffset)                                   \
  X(QUERYCOUNTER, QueryCounter)                                     \
  X(READBUFFER, ReadBuffer)                                         \
  X(READPIXELS, ReadPixels)                                         \
  X(RENDERBUFFERSTORAGEMULTISAMPLE, RenderbufferStorageMultisample) \
  X(SHADERSOURCE, ShaderSource)                                     \
  X(TEXIMAGE2D, TexImage2D)                                         \
  X(TEXIMAGE3D, TexImage3D)                                         \
  X(TEXPARAMETERI, TexParameteri)                                   \
  X(TEXSUBIMAGE2D, TexSubImage2D)                                   \
  X(TEXSUBIMAGE3D, TexSubImage3D)                                   \
  X(UNIFORM1F, Uniform1f)                                           \
  X(UNIFORM1I, Uniform1i)                                           \
  X(UNIFORM3FV, Uniform3fv)                                         \
  X(UNIFORM4FV, Uniform4fv)                                         \
  X(UNIFORMMATRIX3FV, UniformMatrix3fv)                             \
  X(UNIFORMMATRIX4FV, UniformMatrix4fv)                             \
  X(USEPROGRAM, UseProgram)                                         \
  X(VERTEXATTRIB1F, VertexAttrib1f)                                 \
  X(VERTEXATTRIBDIVISOR, VertexAttribDivisor)                       \
  X(VERTEXATTRIBIPOINTER, VertexAttribIPointer)                     \
  X(VERTEXATTRIBPOINTER, VertexAttribPointer)                       \
  X(VIEWPORT, Viewport)

// Functions of OpenGL 4.2 and 4.3, null where the driver does not have them. Callers look at `version` first. The
// exception is MultiDrawElementsIndirect: it is also available in older contexts that have ARB_multi_draw_indirect and
// ARB_base_instance, so that each draw has its base instance, and null in all others.
#define OCCLOD_GL_NEWER_FUNCTIONS(X)                                      \
  X(DRAWELEMENTSINSTANCEDBASEINSTANCE, DrawElementsInstancedBaseInstance) \
  X(MEMORYBARRIER, MemoryBarrier)                                         \
  X(MULTIDRAWELEMENTSINDIRECT, MultiDrawElementsIndirect)

struct Functions {
#define OCCLOD_GL_MEMBER(TYPE, name) PFNGL##TYPE##PROC name = nullptr;
  OCCLOD_GL_FUNCTIONS(OCCLOD_GL_MEMBER)
  OCCLOD_GL_NEWER_FUNCTIONS(OCCLOD_GL_MEMBER)
  // Function of OpenGL 4.5, KHR_robustness or ARB_robustness. Null where the driver does not have it; such a driver
  // never reports a reset.
  OCCLOD_GL_MEMBER(GETGRAPHICSRESETSTATUS, GetGraphicsResetStatus)
#undef OCCLOD_GL_MEMBER
  int version = 0;  // 10 * major + minor
  // Holds the driver's last message, set in debug builds if the driver supports KHR_debug; check() quotes it. Otherwise
  // null.
  std::shared_ptr<std::string> driver_message;
};

using Proc = void (*)();
using GetProc = Proc (*)(const char* name);

// Loads the functions of the current context. `subject` names the context in errors. Throws Error that names a missing
// function, or when the context is older than 3.3.
[[nodiscard]] Functions load_functions(GetProc get_proc, const std::string& subject);

// Thrown when the context is lost with everything in it, because the GPU or its driver was reset. Calls no longer have
// an effect and may return anything; objects may still be deleted, and another context may be created.
class ContextLost : public Error {
 public:
  // `reset` is the value of glGetGraphicsResetStatus; GL_NO_ERROR when it is only known that the context is lost.
  ContextLost(const char* where, GLenum reset);
};

// Throws Error when OpenGL has recorded an error since the last check, and ContextLost when the context is lost, which
// a driver may report only once. `where` names the step just done. May cost a call into the kernel, so call it once for
// many queries, not for each.
void check(const Functions& gl, const char* where);

}  // namespace occlod::gl
