#include "cover/cover_counts.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "hlod/draw/cover_model.h"

namespace occlod::bench {
namespace {

using tool::Json;

constexpr std::array<const char*, 2> model_names{"printed", "in_scene"};
constexpr std::array<double, 7> box_limits{0.0, 0.0005, 0.002, 0.008, 0.03, 0.1, 1.0};  // of c_bb
constexpr double enough_objects = 100.0;                                                // to compare with a count

std::size_t bin_of(double share, std::size_t bins) {
  return static_cast<std::size_t>(std::min(share * static_cast<double>(bins), static_cast<double>(bins) - 1.0));
}

}  // namespace

void CoverCounts::add(const BoxBehind& box) {
  const auto* const limit = std::upper_bound(box_limits.begin() + 1, box_limits.end() - 1, box.share);
  Cell& cell =
      cells_[bin_of(box.covered, screen_bins)][static_cast<std::size_t>(std::distance(box_limits.begin(), limit)) - 1];
  const std::array<double, models> predicted{hlod::cover_probability(box.covered, box.share),
                                             hlod::cover_probability(box.covered_of_scene, box.share_of_scene)};
  cell.objects += 1.0;
  cell.hidden += box.hidden ? 1.0 : 0.0;
  for (std::size_t m = 0; m < models; ++m) {
    cell.predicted[m] += predicted[m];
    Cell& prediction = predictions_[m][bin_of(predicted[m], predicted_bins)];
    prediction.objects += 1.0;
    prediction.hidden += box.hidden ? 1.0 : 0.0;
    prediction.predicted[m] += predicted[m];
  }
}

void CoverCounts::print() const {
  for (std::size_t b = 0; b < box_bins; ++b) {
    fmt::print("\nc_bb {} to {}\n\n| c_scr | objects | counted | printed | in the scene |\n|---|---|---|---|---|\n",
               box_limits[b], box_limits[b + 1]);
    for (std::size_t s = 0; s < screen_bins; ++s)
      if (const Cell& cell = cells_[s][b]; cell.objects > 0.0)
        fmt::print("| {:.2f} | {:.0f} | {:.3f} | {:.3f} | {:.3f} |\n", (static_cast<double>(s) + 0.5) / screen_bins,
                   cell.objects, cell.hidden / cell.objects, cell.predicted[0] / cell.objects,
                   cell.predicted[1] / cell.objects);
  }
  fmt::print(
      "\nRoot mean square difference from the count, cells of {:.0f} objects or more, each by the root of its "
      "objects: printed {:.3f}, in the scene {:.3f}.\nhash {:016x}\n",
      enough_objects, difference(0), difference(1), hash());
}

Json CoverCounts::to_json() const {
  Json result = {{"by_coverage", by_coverage()}, {"hash", fmt::format("{:016x}", hash())}};
  for (std::size_t m = 0; m < models; ++m)
    result["models"][model_names[m]] = {{"difference", difference(m)}, {"by_prediction", by_prediction(m)}};
  return result;
}

// Weighed so that the many small objects do not decide alone. NaN, in JSON null, where there are too few of all.
double CoverCounts::difference(std::size_t model) const {
  double sum = 0.0, weights = 0.0;
  for (const auto& row : cells_)
    for (const Cell& cell : row) {
      if (cell.objects < enough_objects) continue;
      const double weight = std::sqrt(cell.objects), d = (cell.predicted[model] - cell.hidden) / cell.objects;
      sum += weight * d * d;
      weights += weight;
    }
  return weights > 0.0 ? std::sqrt(sum / weights) : std::numeric_limits<double>::quiet_NaN();
}

Json CoverCounts::by_coverage() const {
  Json rows = Json::array();
  for (std::size_t s = 0; s < screen_bins; ++s)
    for (std::size_t b = 0; b < box_bins; ++b)
      if (const Cell& cell = cells_[s][b]; cell.objects > 0.0)
        rows.push_back({{"c_scr", (static_cast<double>(s) + 0.5) / screen_bins},
                        {"c_bb_from", box_limits[b]},
                        {"c_bb_to", box_limits[b + 1]},
                        {"objects", cell.objects},
                        {"hidden", cell.hidden / cell.objects},
                        {"printed", cell.predicted[0] / cell.objects},
                        {"in_scene", cell.predicted[1] / cell.objects}});
  return rows;
}

Json CoverCounts::by_prediction(std::size_t model) const {
  Json rows = Json::array();
  for (const Cell& cell : predictions_[model])
    if (cell.objects > 0.0)
      rows.push_back({{"predicted", cell.predicted[model] / cell.objects},
                      {"hidden", cell.hidden / cell.objects},
                      {"objects", cell.objects}});
  return rows;
}

std::uint64_t CoverCounts::hash() const { return XXH3_64bits(cells_.data(), sizeof(cells_)); }

}  // namespace occlod::bench
