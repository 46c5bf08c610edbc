// A link of limited speed between a store and its file, counted in frames: which load comes in which of them depends on
// bytes only.
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "hlod/build/mesh_loader.h"
#include "occlod/hlod/node_store.h"

namespace occlod::hlod {

class SimulatedLink {
 public:
  // That of CacheOptions::simulated_mb_per_s and simulated_delay.
  explicit SimulatedLink(const CacheOptions& options);

  // To be transferred after all that were pushed before.
  void push(std::vector<MeshLoad> loads);
  // Those whose transfer has not begun.
  [[nodiscard]] std::vector<MeshLoad> withdraw();
  // One frame goes by: what has been transferred meanwhile.
  [[nodiscard]] std::vector<MeshLoad> pass_frame();
  // How many of the loads so transferred, from the first on, come in this frame. Each is counted once.
  [[nodiscard]] std::size_t take_due();
  // Loads that were transferred are forgotten. Returns all others.
  [[nodiscard]] std::vector<MeshLoad> clear();

 private:
  double frame_bytes_;
  std::size_t delay_;
  double transferred_ = 0.0;  // bytes, of the load at the front of line_
  std::deque<MeshLoad> line_;
  std::deque<std::size_t> coming_;  // by load transferred: frames to go
};

}  // namespace occlod::hlod
