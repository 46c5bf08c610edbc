// Numbers that change at bounded rates while the view moves, one for each node of a front.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "priority/travel.h"

namespace occlod {

// How long a value is right, and by how much it may be off meanwhile.
struct Drift {
  float radius = 0.0F;  // of what it depends on: see Travel::at
  // While that moves by t <= lasts as it is seen from the eye, the value stays right to within a factor of 1 + growth *
  // t, and zeros stay zeros.
  float growth = 0.0F;
  float lasts = -1.0F;  // < 0: not at all
  // The same while the eye goes as far; both factors apply.
  float way_growth = 0.0F;
  float way_lasts = -1.0F;
};

// Values with their drifts, and the sums of travel when they were found.
struct DriftingValues {
  std::vector<float> value;  // >= 0, perhaps infinite
  // The factor to within which it is right in this frame: 1 when it has been found in this frame, NaN when it must be
  // found anew.
  std::vector<float> doubt;
  std::vector<float> radius, since, growth, lasts;
  std::vector<float> way_since, way_growth, way_lasts;

  void add();
  // Moves the last one into its place.
  void remove(std::size_t k);
  void clear();
  void put(std::size_t k, float found, const Drift& drift, const Travel& now);
  // Must be found anew.
  void forget(std::size_t k);
  void forget_all();
  // Brings doubt to the view that has travelled so far. O(values), in vectors.
  void age(const Travel& now);

  [[nodiscard]] bool is_exact(std::size_t k) const noexcept { return doubt[k] == 1.0F; }
  [[nodiscard]] bool is_outdated(std::size_t k) const noexcept { return doubt[k] != doubt[k]; }
};

// Which nodes: by their flags, and by value * weight as far as it is known. What must be found anew may be anything.
struct Selection {
  std::uint16_t all = 0;  // of these flags
  std::uint16_t none = 0;
  float may_exceed = -1.0F;
  float may_be_below = std::numeric_limits<float>::infinity();  // infinity: any
};

// All that selecting reads. `weights`: empty = 1 each; where a weight is 0 so is the product.
struct DriftingProducts {
  const DriftingValues& values;
  std::span<const float> weights;
  std::span<const std::uint16_t> flags;
};

// Appends the indices of selected nodes, ascending. O(nodes), in vectors.
void select(const DriftingProducts& products, const Selection& selection, std::vector<std::uint32_t>& out);
[[nodiscard]] std::size_t count(const DriftingProducts& products, const Selection& selection);
// Of the nodes with these flags: the largest product is no smaller.
[[nodiscard]] float largest_at_least(const DriftingProducts& products, std::uint16_t all, std::uint16_t none);

}  // namespace occlod
