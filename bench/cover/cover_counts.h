// How often boxes are covered beside how probable the models hold it: what bench_cover_probability counts and tells.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "json_output.h"

namespace occlod::bench {

// A box behind what has been drawn, both as estimated: shares of the pixels of the image, and of those of the part of
// it that the scene covers.
struct BoxBehind {
  double covered = 0.0, share = 0.0;
  double covered_of_scene = 0.0, share_of_scene = 0.0;
  bool hidden = false;  // all of it was covered
};

// By the estimated share of the image that is covered (c_scr) and that of the box (c_bb), and by what each model
// predicts.
class CoverCounts {
 public:
  void add(const BoxBehind& box);

  // For people, as Markdown.
  void print() const;
  // The root mean square difference of predictions from counts for each model, and the counts.
  [[nodiscard]] tool::Json to_json() const;

 private:
  static constexpr std::size_t models = 2;  // printed, in_scene
  struct Cell {
    double objects = 0.0, hidden = 0.0;
    std::array<double, models> predicted{};  // sums
  };
  static constexpr std::size_t screen_bins = 10, box_bins = 6, predicted_bins = 10;

  [[nodiscard]] double difference(std::size_t model) const;
  [[nodiscard]] tool::Json by_coverage() const;
  [[nodiscard]] tool::Json by_prediction(std::size_t model) const;
  [[nodiscard]] std::uint64_t hash() const;

  std::array<std::array<Cell, box_bins>, screen_bins> cells_{};
  std::array<std::array<Cell, predicted_bins>, models> predictions_{};  // equal steps from 0 to 1
};

}  // namespace occlod::bench
