#include "support/ball_shares.h"

#include <algorithm>

namespace occlod::bench {

BallShares ball_shares(const paper::BitColumns& columns, std::span<const double> factors, std::uint32_t max_centres) {
  BallShares result;
  result.mean.assign(factors.size(), 0.0);
  result.least.assign(factors.size(), 1.0);
  const std::uint32_t wanted = std::min(max_centres, columns.size());
  std::vector<std::uint32_t> distances;
  for (std::uint32_t i = 0; i < wanted; ++i) {
    const auto centre = static_cast<std::uint32_t>(std::uint64_t{i} * columns.size() / wanted);
    distances.clear();
    for (std::uint32_t other = 0; other < columns.size(); ++other)
      if (other != centre) distances.push_back(columns.distance(centre, other));
    std::sort(distances.begin(), distances.end());
    const auto nearest = std::upper_bound(distances.begin(), distances.end(), 0U);
    if (nearest == distances.end()) continue;
    ++result.centres;
    result.equal_share += nearest != distances.begin() ? 1.0 : 0.0;
    for (std::size_t k = 0; k < factors.size(); ++k) {
      const auto end = std::upper_bound(distances.begin(), distances.end(), factors[k] * *nearest);
      const double share = static_cast<double>(end - distances.begin()) / static_cast<double>(distances.size());
      result.mean[k] += share;
      result.least[k] = std::min(result.least[k], share);
    }
  }
  if (result.centres == 0) return result;
  result.equal_share /= result.centres;
  for (double& share : result.mean) share /= result.centres;
  return result;
}

}  // namespace occlod::bench
