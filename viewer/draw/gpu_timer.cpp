#include "gpu_timer.h"

namespace occlod::viewer {

GpuTimer::GpuTimer(const gl::Functions& gl) : gl_(&gl) {
  for (int i = 0; i < 4; ++i) queries_.emplace_back(gl);
}

void GpuTimer::begin() {
  while (read_ < begun_) {
    const GLuint id = queries_[read_ % queries_.size()].id();
    GLuint is_there = 0;
    gl_->GetQueryObjectuiv(id, GL_QUERY_RESULT_AVAILABLE, &is_there);
    if (is_there == 0) break;
    GLuint64 nanoseconds = 0;
    gl_->GetQueryObjectui64v(id, GL_QUERY_RESULT, &nanoseconds);
    milliseconds_ = static_cast<double>(nanoseconds) / 1e6;
    ++read_;
  }
  running_ = begun_ - read_ < queries_.size();
  if (running_) gl_->BeginQuery(GL_TIME_ELAPSED, queries_[begun_++ % queries_.size()].id());
}

void GpuTimer::end() {
  if (running_) gl_->EndQuery(GL_TIME_ELAPSED);
}

}  // namespace occlod::viewer
