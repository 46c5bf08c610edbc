#include "gl/objects.h"

#include <string>

#include "occlod/core/error.h"

namespace occlod::gl {
namespace {

constexpr GLsizei longest_log = 2048;  // characters

[[noreturn]] void refuse_shader(const char* stage, const std::string& log) {
  throw Error(
      {"OpenGL", stage, log.empty() ? "does not compile" : log, "try another driver, or use the software backend"});
}

// The shader only has to live until the program is linked.
class Shader {
 public:
  Shader(const Functions& gl, GLenum kind, const char* source) : gl_(&gl), id_(gl.CreateShader(kind)) {
    gl.ShaderSource(id_, 1, &source, nullptr);
    gl.CompileShader(id_);
  }
  Shader(const Shader&) = delete;
  Shader(Shader&&) = delete;
  Shader& operator=(const Shader&) = delete;
  Shader& operator=(Shader&&) = delete;
  ~Shader() { gl_->DeleteShader(id_); }

  [[nodiscard]] GLuint id() const noexcept { return id_; }
  void require(const char* stage) const {
    GLint compiled = GL_FALSE;
    gl_->GetShaderiv(id_, GL_COMPILE_STATUS, &compiled);
    if (compiled == GL_TRUE) return;
    std::string log(longest_log, '\0');
    GLsizei length = 0;
    gl_->GetShaderInfoLog(id_, longest_log, &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    refuse_shader(stage, log);
  }

 private:
  const Functions* gl_;
  GLuint id_;
};

}  // namespace

Program::Program(const Functions& gl, const char* vertex_source, const char* fragment_source) : gl_(&gl) {
  const Shader vertex(gl, GL_VERTEX_SHADER, vertex_source);
  vertex.require("vertex shader");
  const Shader fragment(gl, GL_FRAGMENT_SHADER, fragment_source);
  fragment.require("fragment shader");
  id_ = gl.CreateProgram();
  gl.AttachShader(id_, vertex.id());
  gl.AttachShader(id_, fragment.id());
  gl.LinkProgram(id_);
  GLint linked = GL_FALSE;
  gl.GetProgramiv(id_, GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return;
  std::string log(longest_log, '\0');
  GLsizei length = 0;
  gl.GetProgramInfoLog(id_, longest_log, &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  gl.DeleteProgram(id_);
  refuse_shader("program", log);
}

DepthTarget::DepthTarget(const Functions& gl) : gl_(&gl), framebuffer_(gl), depth_(gl) {}

void DepthTarget::bind(int width, int height) {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  if (width == width_ && height == height_) return;
  GLint largest = 0;
  gl_->GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  if (width > largest || height > largest)
    throw Error({"OpenGL", "depth target", "the driver holds at most " + std::to_string(largest) + " pixels a side",
                 "use a smaller image, or the software backend"});
  gl_->BindRenderbuffer(GL_RENDERBUFFER, depth_.id());
  gl_->RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, width, height);
  gl_->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.id());
  gl_->DrawBuffer(GL_NONE);
  gl_->ReadBuffer(GL_NONE);
  check(*gl_, "depth target");
  if (gl_->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error({"OpenGL", "depth target", "the driver refuses a framebuffer with depth only",
                 "try another driver, or use the software backend"});
  width_ = width;
  height_ = height;
}

}  // namespace occlod::gl
