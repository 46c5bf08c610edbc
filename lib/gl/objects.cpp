#include "gl/objects.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
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

const char* stage_name(GLenum kind) { return kind == GL_VERTEX_SHADER ? "vertex shader" : "fragment shader"; }

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

// A fence of a lost context counts as over, and wait() reports the loss.
bool Fence::is_over() const { return gl_->ClientWaitSync(sync_, GL_SYNC_FLUSH_COMMANDS_BIT, 0) != GL_TIMEOUT_EXPIRED; }

void Fence::wait(const char* work) const {
  const GLenum state = gl_->ClientWaitSync(sync_, GL_SYNC_FLUSH_COMMANDS_BIT, longest_wait_ns);
  check(*gl_, work);
  if (state != GL_ALREADY_SIGNALED && state != GL_CONDITION_SATISFIED)
    throw Error({"OpenGL", work, "the driver gave no answer", "use another driver, or the software backend"});
}

namespace {

using Clock = std::chrono::steady_clock;

// Polls between two checks for a lost context; this many take a millisecond. A lost context should answer at once, but
// some drivers do not.
constexpr int looks_for_each_check = 1024;

void wait_for(const Functions& gl, const Query& query) {
  if (QueryPool::is_available(gl, query)) return;
  gl.Flush();
  const auto deadline = Clock::now() + std::chrono::nanoseconds(longest_wait_ns);
  for (int looks = 1;; ++looks) {
    if (QueryPool::is_available(gl, query)) return;
    if (Clock::now() > deadline)
      throw Error(
          {"OpenGL", "occlusion query", "the driver gave no answer", "use another driver, or the software backend"});
    if (looks % looks_for_each_check == 0) check(gl, "occlusion query");
    std::this_thread::yield();
  }
}

}  // namespace

Query QueryPool::begin(const Functions& gl) {
  if (idle_.empty()) idle_.emplace_back(gl);
  Query query = std::move(idle_.back());
  idle_.pop_back();
  gl.BeginQuery(target_, query.id());
  return query;
}

bool QueryPool::is_available(const Functions& gl, const Query& query) {
  GLuint available = GL_FALSE;
  gl.GetQueryObjectuiv(query.id(), GL_QUERY_RESULT_AVAILABLE, &available);
  return available == GL_TRUE;
}

std::uint32_t QueryPool::take(const Functions& gl, Query query) {
  wait_for(gl, query);
  GLuint passed = 0;
  gl.GetQueryObjectuiv(query.id(), GL_QUERY_RESULT, &passed);
  idle_.push_back(std::move(query));
  return passed;
}

}  // namespace occlod::gl
