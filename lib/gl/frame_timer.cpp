#include "gl/frame_timer.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

namespace occlod::gl {
namespace {

bool has_timer(const Functions& gl) {
  GLint bits = 0;
  gl.GetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
  return bits > 0;
}

}  // namespace

bool draws_on_cpu(std::string_view renderer) {
  constexpr std::array<std::string_view, 4> names{"llvmpipe", "softpipe", "swrast", "SwiftShader"};
  return std::any_of(names.begin(), names.end(),
                     [&](std::string_view name) { return renderer.find(name) != std::string_view::npos; });
}

FrameTimer::FrameTimer(const Functions& gl, std::string_view renderer)
    : gl_(&gl), meaningful_(!draws_on_cpu(renderer) && has_timer(gl)) {}

void FrameTimer::begin_frame() {
  started_ = false;
  used_ = 0;
}

void FrameTimer::start() {
  if (!std::exchange(started_, true)) stamp();
}

void FrameTimer::stop() {
  if (std::exchange(started_, false)) stamp();
}

void FrameTimer::stamp() {
  if (!meaningful_) return;
  if (used_ == stamps_.size()) stamps_.emplace_back(*gl_);
  gl_->QueryCounter(stamps_[used_++].id(), GL_TIMESTAMP);
}

double FrameTimer::milliseconds(std::size_t stamp) const {
  GLuint64 nanoseconds = 0;
  gl_->GetQueryObjectui64v(stamps_[stamp].id(), GL_QUERY_RESULT, &nanoseconds);
  return static_cast<double>(nanoseconds) / 1e6;
}

FrameTimer::Times FrameTimer::read() const {
  assert(!started_);
  Times times;
  for (std::size_t i = 0; i + 1 < used_; ++i) {
    const double between = milliseconds(i + 1) - milliseconds(i);
    (i % 2 == 0 ? times.busy_ms : times.idle_ms) += between;
  }
  return times;
}

}  // namespace occlod::gl
