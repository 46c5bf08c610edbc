// When the device worked during a frame, by timer queries.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "gl/objects.h"

namespace occlod::gl {

// Whether this renderer (GL_RENDERER) is a program on the processor. Such gather commands and work through them tile by
// tile.
[[nodiscard]] bool draws_on_cpu(std::string_view renderer);

// Between start() and stop() commands are given; between stop() and start() the device may run out of them. Its context
// is current in every call.
class FrameTimer {
 public:
  // renderer: GL_RENDERER. Of drivers that draw on the CPU, what timers say of single commands is the time of the last
  // tile, so they are not asked.
  FrameTimer(const Functions& gl, std::string_view renderer);

  [[nodiscard]] bool is_meaningful() const noexcept { return meaningful_; }
  void begin_frame();
  void start();  // nothing when started already
  void stop();   // nothing when stopped already

  struct Times {
    double busy_ms = 0.0;  // from each start to the next stop
    double idle_ms = 0.0;  // from each stop to the next start
  };
  // Of the frame, when all commands are done; zeros where timers are not meaningful.
  [[nodiscard]] Times read() const;

 private:
  void stamp();
  [[nodiscard]] double milliseconds(std::size_t stamp) const;

  const Functions* gl_;
  bool meaningful_;
  bool started_ = false;
  std::vector<Query> stamps_;
  std::size_t used_ = 0;  // of stamps_: starts and stops by turns
};

}  // namespace occlod::gl
