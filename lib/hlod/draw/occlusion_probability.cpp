#include "occlod/traverse/occlusion_probability.h"

#include <algorithm>
#include <cmath>

namespace occlod::hlod {

double box_coverage(double box_area, double distance, const ImageScale& image) noexcept {
  if (!image.orthographic && !(distance > 0.0)) return 1.0;
  const double scale = image.focal_length_px / (image.orthographic ? 1.0 : distance);
  return std::min(1.0, scale * scale * box_area / (6.0 * image.pixels));
}

double coverage_ratio(double mesh_area, double box_area) noexcept {
  return box_area > 0.0 ? 1.5 * mesh_area / box_area : 1.0;
}

double mesh_coverage(double box_share, double ratio) noexcept { return box_share * std::min(ratio, 1.0); }

double covered_with(double covered, double share) noexcept { return covered + (1.0 - covered) * share; }

double cover_probability(double covered, double box_share, CoverModel model) noexcept {
  if (!(box_share < covered)) return 0.0;
  const double edge = std::sqrt(box_share), room = std::sqrt(covered) - edge;
  const double share = model == CoverModel::printed ? room : room / (1.0 - edge);
  return share * share;
}

double occlusion_probability(double cover_probability, LastSight last) noexcept {
  switch (last) {
    case LastSight::visible:
      return 0.5 * cover_probability * cover_probability;
    case LastSight::outside:
      return cover_probability;
    case LastSight::hidden:
      break;
  }
  return 1.0;
}

}  // namespace occlod::hlod
