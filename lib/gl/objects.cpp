#include "gl/objects.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "occlod/base.h"

namespace occlod::gl {
namespace {

constexpr GLsizei longest_log = 2048;  // characters
// Drivers answer within milliseconds; after this time they never will.
constexpr std::uint64_t longest_wait_ns = 10'000'000'000;

[[noreturn]] void refuse_shader(const Functions& gl, const char* stage, const std::string& log) {
  if (log.empty()) check(gl, stage);
  throw Error(
      {"OpenGL", stage, log.empty() ? "does not compile" : log, "try another driver, or use the software backend"});
}

const char* stage_name(GLenum kind) {
  return kind == GL_VERTEX_SHADER ? "vertex shader" : kind == GL_FRAGMENT_SHADER ? "fragment shader" : "compute shader";
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
    refuse_shader(*gl_, stage, log);
  }

 private:
  const Functions* gl_;
  GLuint id_;
};

}  // namespace

Program::Program(const Functions& gl, std::initializer_list<ShaderSource> sources) : gl_(&gl) {
  std::vector<std::unique_ptr<Shader>> shaders;
  for (const ShaderSource& source : sources)
    shaders.emplace_back(std::make_unique<Shader>(gl, source.kind, source.text))->require(stage_name(source.kind));
  id_ = gl.CreateProgram();
  for (const auto& shader : shaders) gl.AttachShader(id_, shader->id());
  gl.LinkProgram(id_);
  GLint linked = GL_FALSE;
  gl.GetProgramiv(id_, GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return;
  std::string log(longest_log, '\0');
  GLsizei length = 0;
  gl.GetProgramInfoLog(id_, longest_log, &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  gl.DeleteProgram(id_);
  refuse_shader(gl, "program", log);
}

FloatTarget::FloatTarget(const Functions& gl, Kind kind) : gl_(&gl), kind_(kind), framebuffer_(gl), texture_(gl) {}

void FloatTarget::bind(int width, int height) {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  if (width == width_ && height == height_) return;
  GLint largest = 0;
  gl_->GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  check(*gl_, "occlusion target");
  if (width > largest || height > largest)
    throw Error({"OpenGL", "occlusion target", "the driver holds at most " + std::to_string(largest) + " pixels a side",
                 "use a smaller image, or the software backend"});
  width_ = width;
  height_ = height;
  allocate();
}

void FloatTarget::allocate() const {
  const bool depth = kind_ == Kind::depth;
  gl_->BindTexture(GL_TEXTURE_2D, texture_.id());
  gl_->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  gl_->TexImage2D(GL_TEXTURE_2D, 0, depth ? GL_DEPTH_COMPONENT32F : GL_R32F, width_, height_, 0,
                  depth ? GL_DEPTH_COMPONENT : GL_RED, GL_FLOAT, nullptr);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  gl_->FramebufferTexture2D(GL_FRAMEBUFFER, depth ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                            texture_.id(), 0);
  gl_->DrawBuffer(depth ? GL_NONE : GL_COLOR_ATTACHMENT0);
  gl_->ReadBuffer(depth ? GL_NONE : GL_COLOR_ATTACHMENT0);
  const GLenum status = gl_->CheckFramebufferStatus(GL_FRAMEBUFFER);
  check(*gl_, "occlusion target");
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw Error({"OpenGL", "occlusion target", "the driver refuses a framebuffer with one image of floats",
                 "try another driver, or use the software backend"});
}

// A fence of a lost context counts as over, and wait() reports the loss.
bool Fence::is_over() const { return gl_->ClientWaitSync(sync_, GL_SYNC_FLUSH_COMMANDS_BIT, 0) != GL_TIMEOUT_EXPIRED; }

void Fence::wait(const char* work) const {
  const GLenum state = gl_->ClientWaitSync(sync_, GL_SYNC_FLUSH_COMMANDS_BIT, longest_wait_ns);
  check(*gl_, work);
  if (state != GL_ALREADY_SIGNALED && state != GL_CONDITION_SATISFIED)
    throw Error({"OpenGL", work, "the driver gave no answer", "use another driver, or the software backend"});
}

void finish(const Functions& gl, const char* work) { Fence(gl).wait(work); }

void read_back(const Functions& gl, std::span<std::uint32_t> words, const char* work) {
  gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  read_back(gl, words, Fence(gl), work);
}

void read_back(const Functions& gl, std::span<std::uint32_t> words, const Fence& written, const char* work) {
  written.wait(work);
  gl.GetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(words.size_bytes()), words.data());
  check(gl, work);
}

}  // namespace occlod::gl
