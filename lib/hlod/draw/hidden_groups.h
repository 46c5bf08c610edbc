// Which hidden nodes are asked about in one query: the multi-queries of CHC++ (Mattausch and others 2008, sec. 5.2).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "hlod/draw/per_node.h"

namespace occlod::hlod {

class HiddenGroups {
 public:
  void begin_frame(const FrameScene& scene) { hidden_frames_.fit(scene); }
  void note_answer(NodeRef n, bool visible) { hidden_frames_[n] = visible ? 0 : hidden_frames_[n] + 1; }

  // The largest V = m / (1 + p_fail m), greedily; first those that are most likely to stay hidden. They go to the
  // front; returns their number.
  [[nodiscard]] std::size_t group(std::span<NodeRef> hidden) const {
    std::sort(hidden.begin(), hidden.end(), [this](NodeRef a, NodeRef b) {
      if (hidden_frames_[a] != hidden_frames_[b]) return hidden_frames_[a] > hidden_frames_[b];
      return a.object != b.object ? a.object < b.object : a.node < b.node;
    });
    double keep = 1.0, best = 0.0;
    for (std::size_t m = 1; m <= hidden.size(); ++m) {
      keep *= 0.99 - 0.7 * std::exp(-static_cast<double>(hidden_frames_[hidden[m - 1]]));
      const auto size = static_cast<double>(m);
      const double value = size / (1.0 + (1.0 - keep) * size);
      if (value < best) return m - 1;
      best = value;
    }
    return hidden.size();
  }

 private:
  PerNode<std::uint32_t> hidden_frames_;
};

}  // namespace occlod::hlod
