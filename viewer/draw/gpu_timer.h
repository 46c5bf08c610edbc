// Measures the time that OpenGL itself takes, which is known a few pictures later.
#pragma once

#include <vector>

#include "gl/objects.h"

namespace occlod::viewer {

class GpuTimer {
 public:
  explicit GpuTimer(const gl::Functions& gl);
  void begin();
  void end();
  // Returns the time of the last picture whose time is known; 0 before.
  [[nodiscard]] double milliseconds() const noexcept { return milliseconds_; }

 private:
  const gl::Functions* gl_;
  std::vector<gl::Query> queries_;
  std::size_t begun_ = 0;
  std::size_t read_ = 0;
  bool running_ = false;
  double milliseconds_ = 0.0;
};

}  // namespace occlod::viewer
