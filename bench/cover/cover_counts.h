// How often boxes are covered beside how probable the models hold it: what bench_cover_probability counts and tells.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "json_output.h"

namespace occlod::bench {

// By the estimated share of the image that is covered (c_scr) and that of the box (c_bb), and by what each model
// predicts. Shares are of the pixels of the image.
class CoverCounts {
 public:
  // A box of share `box_share` behind what covers `covered`, both as estimated, and whether all of it was covered.
  void add(double covered, double box_share, bool hidden);

  // For people, as Markdown.
  void print() const;
  // The root mean square difference of predictions from counts for each model, and the counts.
  [[nodiscard]] tool::Json to_json() const;

 private:
  struct Cell {
    double objects = 0.0, hidden = 0.0;
    std::array<double, 2> predicted{};  // sums, by model
  };
  static constexpr std::size_t screen_bins = 10, box_bins = 6, predicted_bins = 10;

  [[nodiscard]] double difference(std::size_t model) const;
  [[nodiscard]] tool::Json by_coverage() const;
  [[nodiscard]] tool::Json by_prediction(std::size_t model) const;
  [[nodiscard]] std::uint64_t hash() const;

  std::array<std::array<Cell, box_bins>, screen_bins> cells_{};
  std::array<std::array<Cell, predicted_bins>, 2> predictions_{};  // by model; equal steps from 0 to 1
};

}  // namespace occlod::bench
