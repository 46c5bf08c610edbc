// A link of limited speed between a store and its file, counted in frames: which load comes in which of them depends on
// bytes only, so it is the same in every run.
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "hlod/store/mesh_loader.h"
#include "occlod/node_store.h"

namespace occlod::hlod {

// How meshes come: as with LoadMode, or by a simulated link.
enum class TrialLoad { blocking, async, simulated };

// CacheOptions, and the speed of the link, at 60 frames a second.
struct TrialCacheOptions {
  std::size_t budget_bytes = CacheOptions().budget_bytes;
  TrialLoad load = TrialLoad::async;
  std::size_t frame_bytes = max_bytes_in_frame;  // of a simulated link; > 0
  double simulated_mb_per_s = 50.0;              // 10^6 bytes a second, > 0
  int simulated_delay = 1;  // frames from the transfer of a mesh's bytes to its coming, in [0, 1000]

  [[nodiscard]] CacheOptions cache() const;
};

// Puts a link between the store, which was opened with the same options and has seen no frame yet, and its file where
// they say so. Throws Error for a speed out of its range.
void simulate_link(NodeStore& store, const TrialCacheOptions& options);

class SimulatedLink final : public MeshLink {
 public:
  explicit SimulatedLink(const TrialCacheOptions& options);

  void push(std::vector<MeshLoad> loads) override;
  [[nodiscard]] std::vector<MeshLoad> withdraw() override;
  [[nodiscard]] std::vector<MeshLoad> pass_frame() override;
  [[nodiscard]] std::size_t take_due() override;
  [[nodiscard]] std::vector<MeshLoad> clear() override;

 private:
  double bytes_in_frame_;
  std::size_t delay_;
  double transferred_ = 0.0;  // bytes, of the load at the front of line_
  std::deque<MeshLoad> line_;
  std::deque<std::size_t> coming_;  // by load transferred: frames to go
};

}  // namespace occlod::hlod
