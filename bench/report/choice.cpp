#include "report/choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace occlod::bench {

std::vector<std::size_t> pareto_front(std::span<const Cost> costs) {
  std::vector<std::size_t> by_time;
  for (std::size_t i = 0; i < costs.size(); ++i)
    if (std::isfinite(costs[i].error)) by_time.push_back(i);
  std::stable_sort(by_time.begin(), by_time.end(), [&](std::size_t a, std::size_t b) {
    return std::tie(costs[a].ms, costs[a].error) < std::tie(costs[b].ms, costs[b].error);
  });
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : by_time) {
    if (!(costs[i].error < least)) continue;
    least = costs[i].error;
    front.push_back(i);
  }
  return front;
}

std::optional<std::size_t> fastest_within(std::span<const Cost> costs, double error) {
  for (const std::size_t i : pareto_front(costs))
    if (costs[i].error <= error) return i;
  return {};
}

}  // namespace occlod::bench
