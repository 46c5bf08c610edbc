// Which setting to use.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace occlod::bench {

// What a setting costs and what it leaves wrong; an error that is not finite is never chosen.
struct Cost {
  double ms = 0.0;
  double error = 0.0;
};

// The places of those that no other beats in both, from the fastest to the most accurate: times ascend, errors descend.
// Of equal ones the first.
[[nodiscard]] std::vector<std::size_t> pareto_front(std::span<const Cost> costs);

// The fastest whose error is no larger; nothing when there is none.
[[nodiscard]] std::optional<std::size_t> fastest_within(std::span<const Cost> costs, double error);

}  // namespace occlod::bench
