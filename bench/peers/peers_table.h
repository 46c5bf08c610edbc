// What bench_build_peers prints and writes.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace occlod::bench {

struct PeerRow {
  std::string mesh;
  std::size_t input_triangles = 0;
  std::size_t target_triangles = 0;
  std::string tool;
  std::size_t triangles = 0;         // that came out
  std::vector<double> milliseconds;  // of every run, at least one
  double rms_percent = 0.0;          // distance to the input, both ways, of the diagonal of its box
  double max_percent = 0.0;

  [[nodiscard]] double median_ms() const;
  [[nodiscard]] double mtri_per_s() const;  // input triangles by the median
};

// Ratios are to `reference` on the same mesh and target, by medians.
[[nodiscard]] std::string format_table(const std::vector<PeerRow>& rows, const std::string& reference);
[[nodiscard]] std::string format_json(const std::vector<PeerRow>& rows, const std::string& reference);

}  // namespace occlod::bench
