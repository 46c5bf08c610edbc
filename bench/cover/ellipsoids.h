// Fig. 3 of Guthe, Balazs and Klein 2006: ellipsoids at random places in the frustum, drawn front to back.
#pragma once

#include <cstdint>

#include "cover/cover_counts.h"

namespace occlod::bench {

struct EllipsoidOptions {
  int runs = 100;        // images
  int objects = 10'000;  // in each
  double largest = 3.0;  // radius; the frustum reaches from 1 to 100
  std::uint64_t seed = 1;
};

// The estimated share of the image that is covered, minus what really is, after each object.
struct CoverageError {
  double mean = 0.0;
  double root_mean_square = 0.0;
};

// Counts the box of every ellipsoid that the image shows.
CoverageError count_ellipsoids(const EllipsoidOptions& options, CoverCounts& counts);

}  // namespace occlod::bench
