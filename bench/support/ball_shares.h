// How many columns of a matrix are near to each of them: vLOD (2003), figure 4.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "papers/hamming_tour.h"

namespace occlod::bench {

struct BallShares {
  std::uint32_t centres = 0;  // columns that were looked from
  double equal_share = 0.0;   // of them, that another column equals
  std::vector<double> mean;   // by factor: share of the other columns within so many times the distance of the nearest
  std::vector<double> least;  // that is not equal; mean and least over centres
};

// From at most `max_centres` columns, evenly spread, none without another that differs. `factors` >= 1.
// O(centres * columns * ones).
[[nodiscard]] BallShares ball_shares(const paper::BitColumns& columns, std::span<const double> factors,
                                     std::uint32_t max_centres);

}  // namespace occlod::bench
