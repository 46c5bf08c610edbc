#include "occlod/picture/compare.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

namespace occlod {
namespace {

constexpr double largest_difference_px = 10.0;

// ITU-R BT.601, of the encoded values.
double luma(const glm::u8vec4& p) { return 0.299 * p.x + 0.587 * p.y + 0.114 * p.z; }

double psnr_of_luma(const Image& image, const Image& reference) {
  double sum = 0.0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const double difference = luma(image.pixels[i]) - luma(reference.pixels[i]);
    sum += difference * difference;
  }
  if (sum == 0.0) return std::numeric_limits<double>::infinity();
  return 10.0 * std::log10(255.0 * 255.0 * static_cast<double>(image.pixels.size()) / sum);
}

// Infinite when there is something and nothing is expected.
double percent(std::size_t part, std::size_t whole) {
  if (part == 0) return 0.0;
  return whole == 0 ? std::numeric_limits<double>::infinity()
                    : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

// The smallest (or, by std::greater, the largest) value within `radius` along rows, then along columns.
template <typename Better>
std::vector<float> extreme_around(const DepthBuffer& depth, int radius, const Better& better) {
  const int width = depth.width, height = depth.height;
  const auto pick = [&](float a, float b) { return better(b, a) ? b : a; };
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  };
  std::vector<float> rows(depth.inverse_depth.size()), result(rows.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float best = depth.inverse_depth[at(x, y)];
      for (int k = std::max(x - radius, 0); k <= std::min(x + radius, width - 1); ++k)
        best = pick(best, depth.inverse_depth[at(k, y)]);
      rows[at(x, y)] = best;
    }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float best = rows[at(x, y)];
      for (int k = std::max(y - radius, 0); k <= std::min(y + radius, height - 1); ++k)
        best = pick(best, rows[at(x, k)]);
      result[at(x, y)] = best;
    }
  return result;
}

}  // namespace

PictureDistance compare_pictures(const View& view, const DepthBuffer& depth, const Image& image,
                                 const DepthBuffer& reference_depth, const Image& reference_image) {
  assert(depth.inverse_depth.size() == reference_depth.inverse_depth.size() &&
         image.pixels.size() == reference_image.pixels.size());
  std::size_t in_reference = 0, in_one = 0, in_both = 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < depth.inverse_depth.size(); ++i) {
    const double here = depth.inverse_depth[i];
    const double there = reference_depth.inverse_depth[i];
    in_reference += there > 0.0 ? 1 : 0;
    in_one += (here > 0.0) != (there > 0.0) ? 1 : 0;
    if (!(here > 0.0 && there > 0.0)) continue;
    ++in_both;
    // A length across the axis covers focal_length_px / w pixels at the reference depth w = 1 / there.
    const double difference = std::abs(1.0 / here - 1.0 / there) * view.focal_length_px() * there;
    sum += std::pow(std::min(difference, largest_difference_px), 2);
  }
  return {in_both > 0 ? std::sqrt(sum / static_cast<double>(in_both)) : 0.0, percent(in_one, in_reference),
          psnr_of_luma(image, reference_image)};
}

std::size_t count_unexplained_pixels(const View& view, const DepthBuffer& expected, const DepthBuffer& found,
                                     double allowed_px) {
  assert(expected.inverse_depth.size() == found.inverse_depth.size() && allowed_px >= 0.0);
  const int radius =
      static_cast<int>(std::min(std::ceil(allowed_px), static_cast<double>(std::max(found.width, found.height))));
  const std::vector<float> farthest = extreme_around(found, radius, std::less<>());
  const std::vector<float> nearest = extreme_around(found, radius, std::greater<>());
  std::size_t unexplained = 0;
  for (std::size_t i = 0; i < expected.inverse_depth.size(); ++i) {
    const double inverse = expected.inverse_depth[i];
    // allowed_px pixels at depth d are allowed_px * d / f long: depths d (1 -+ share), inverse depths inverse / (1 -+
    // share).
    const double share = allowed_px / view.focal_length_px();
    const bool near_enough = static_cast<double>(nearest[i]) >= inverse / (1.0 + share);
    const bool far_enough = share >= 1.0 || static_cast<double>(farthest[i]) <= inverse / (1.0 - share);
    unexplained += near_enough && far_enough ? 0U : 1U;
  }
  return unexplained;
}

}  // namespace occlod
