#include "occlod/compare.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <numeric>
#include <vector>

#include "scene/shading.h"

namespace occlod {
namespace {

constexpr double largest_difference_px = 10.0;

struct SquaredDifferences {
  double y = 0.0;
  double cb = 0.0;
  double cr = 0.0;
};

// Sums over all pixels, using the encoded values and ITU-R BT.601; the colour differences are at JPEG's scale.
SquaredDifferences squared_differences(const Image& image, const Image& reference) {
  SquaredDifferences sum;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const glm::dvec3 d = glm::dvec3(image.pixels[i]) - glm::dvec3(reference.pixels[i]);
    const double y = 0.299 * d.x + 0.587 * d.y + 0.114 * d.z;
    sum.y += y * y;
    sum.cb += std::pow((d.z - y) / 1.772, 2);
    sum.cr += std::pow((d.x - y) / 1.402, 2);
  }
  return sum;
}

double psnr(double squared_sum, std::size_t pixels) {
  if (squared_sum == 0.0) return std::numeric_limits<double>::infinity();
  return 10.0 * std::log10(255.0 * 255.0 * static_cast<double>(pixels) / squared_sum);
}

// Returns infinity when `part` is positive and `whole` is 0.
double percent(std::size_t part, std::size_t whole) {
  if (part == 0) return 0.0;
  return whole == 0 ? std::numeric_limits<double>::infinity()
                    : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

// Returns the smallest (or, by std::greater, the largest) value within `radius` along rows, then along columns.
template <typename Better>
std::vector<float> extreme_around(const DepthBuffer& depth, int radius, const Better& better) {
  const int width = depth.width, height = depth.height;
  const auto pick = [&](float a, float b) { return better(b, a) ? b : a; };
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  };
  std::vector<float> rows(depth.nearness.size()), result(rows.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float best = depth.nearness[at(x, y)];
      for (int k = std::max(x - radius, 0); k <= std::min(x + radius, width - 1); ++k)
        best = pick(best, depth.nearness[at(k, y)]);
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

// Replaces every value by the best within one pixel around it; `rows` is scratch.
template <typename Pick>
void spread(std::vector<float>& values, std::vector<float>& rows, int width, int height, const Pick& pick) {
  const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  rows.resize(values.size());
  for (std::size_t y = 0; y < h; ++y) {
    const float* from = &values[y * w];
    float* to = &rows[y * w];
    to[0] = pick(from[0], from[std::min<std::size_t>(1, w - 1)]);
    for (std::size_t x = 1; x + 1 < w; ++x) to[x] = pick(pick(from[x - 1], from[x]), from[x + 1]);
    if (w > 1) to[w - 1] = pick(from[w - 2], from[w - 1]);
  }
  for (std::size_t y = 0; y < h; ++y) {
    const float* above = &rows[(y > 0 ? y - 1 : y) * w];
    const float* here = &rows[y * w];
    const float* below = &rows[(y + 1 < h ? y + 1 : y) * w];
    float* to = &values[y * w];
    for (std::size_t x = 0; x < w; ++x) to[x] = pick(pick(above[x], here[x]), below[x]);
  }
}

// Returns by what share of its own depth a pixel must be allowed to move to lie between `farthest` and `nearest`, where
// 0 is infinitely far.
double depth_share(double nearness, double nearest, double farthest) {
  double share = 0.0;
  if (nearness > nearest) share = nearest > 0.0 ? nearness / nearest - 1.0 : std::numeric_limits<double>::infinity();
  if (nearness < farthest) share = std::max(share, 1.0 - nearness / farthest);
  return share;
}

// Returns the depth motion of depth_share() in pixels at that depth.
double depth_motion_px(const View& view, double nearness, double nearest, double farthest) {
  if (!view.is_orthographic()) return view.focal_length_px() * depth_share(nearness, nearest, farthest);
  const auto apart = [&](double near, double far) {
    if (!(near > far)) return 0.0;
    return far > 0.0 ? (view.distance_at(far) - view.distance_at(near)) * view.focal_length_px()
                     : std::numeric_limits<double>::infinity();
  };
  return std::max(apart(nearness, nearest), apart(farthest, nearness));
}

// Returns whether a pixel lies between `farthest` and `nearest`, within a tolerance of this many pixels at its depth.
bool is_within(const View& view, double nearness, double nearest, double farthest, double allowed_px) {
  if (view.is_orthographic()) return depth_motion_px(view, nearness, nearest, farthest) <= allowed_px;
  // The tolerance has length allowed_px * d / f at depth d: depths become d (1 -+ share), nearnesses are divided by (1
  // -+ share).
  const double share = allowed_px / view.focal_length_px();
  return nearest >= nearness / (1.0 + share) && (share >= 1.0 || farthest <= nearness / (1.0 - share));
}

// Returns the radius in whole pixels in which to search for this tolerance.
int whole_pixels(double allowed_px, const DepthBuffer& depth) {
  return static_cast<int>(std::min(std::ceil(allowed_px), static_cast<double>(std::max(depth.width, depth.height))));
}

// Returns by how many pixels, at the depth of b, the depth at b departs from a straight line from a to c. Nearness is
// linear over the image of a plane.
double bend_px(const View& view, float a, float b, float c) {
  const double straight = (static_cast<double>(a) + c) / 2.0;
  if (b == straight) return 0.0;
  return depth_motion_px(view, b, straight, straight);
}

// Returns 1 where there is a step in depth, or may be one just outside the image; 0 elsewhere.
DepthBuffer depth_steps(const View& view, const DepthBuffer& depth) {
  constexpr double largest_bend_px = 2.0;
  DepthBuffer steps;
  steps.reset(depth.width, depth.height);
  const auto width = static_cast<std::size_t>(depth.width);
  const auto mark = [&](std::size_t i, std::size_t stride) {
    const std::vector<float>& n = depth.nearness;
    if (bend_px(view, n[i - stride], n[i], n[i + stride]) > largest_bend_px) steps.nearness[i] = 1.0F;
  };
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
      if (x == 0 || y == 0 || x + 1 == depth.width || y + 1 == depth.height) {
        steps.nearness[i] = 1.0F;
        continue;
      }
      mark(i, 1);
      mark(i, width);
    }
  return steps;
}

// Returns the largest motion of any pixel of `expected`.
double motion_into(const View& view, const DepthBuffer& expected, const DepthBuffer& found, double max_px) {
  std::vector<float> nearest = found.nearness, farthest = found.nearness, rows;
  std::vector<std::size_t> open(expected.nearness.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  double largest = 0.0;
  for (int radius = 0; radius < max_px; ++radius) {
    const auto is_explained = [&](std::size_t i) {
      const double px = depth_motion_px(view, expected.nearness[i], nearest[i], farthest[i]);
      if (px >= radius + 1) return false;
      largest = std::max(largest, std::max(px, static_cast<double>(radius)));
      return true;
    };
    open.erase(std::remove_if(open.begin(), open.end(), is_explained), open.end());
    if (open.empty()) return std::min(largest, max_px);
    spread(nearest, rows, found.width, found.height, [](float a, float b) { return a > b ? a : b; });
    spread(farthest, rows, found.width, found.height, [](float a, float b) { return a < b ? a : b; });
  }
  return max_px;
}

struct DepthDistance {
  double rms_px = 0.0;
  double silhouette_mismatch = 0.0;
};

DepthDistance depth_distance(const View& view, const DepthBuffer& depth, const DepthBuffer& reference) {
  std::size_t in_reference = 0, in_one = 0, in_both = 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < depth.nearness.size(); ++i) {
    const double here = depth.nearness[i];
    const double there = reference.nearness[i];
    in_reference += there > 0.0 ? 1 : 0;
    in_one += (here > 0.0) != (there > 0.0) ? 1 : 0;
    if (!(here > 0.0 && there > 0.0)) continue;
    ++in_both;
    const double difference = std::abs(view.distance_at(here) - view.distance_at(there)) * view.scale_px_at(there);
    sum += std::pow(std::min(difference, largest_difference_px), 2);
  }
  return {in_both > 0 ? std::sqrt(sum / static_cast<double>(in_both)) : 0.0, percent(in_one, in_reference)};
}

}  // namespace

PictureDistance compare_pictures(const View& view, const DepthBuffer& depth, const Image& image,
                                 const DepthBuffer& reference_depth, const Image& reference_image) {
  assert(depth.nearness.size() == reference_depth.nearness.size() &&
         image.pixels.size() == reference_image.pixels.size());
  const DepthDistance distance = depth_distance(view, depth, reference_depth);
  const SquaredDifferences sums = squared_differences(image, reference_image);
  const std::size_t pixels = image.pixels.size();
  return {distance.rms_px, distance.silhouette_mismatch, psnr(sums.y, pixels), psnr(sums.cb, pixels),
          psnr(sums.cr, pixels)};
}

double largest_motion_px(const View& view, const DepthBuffer& one, const DepthBuffer& other, double max_px) {
  assert(one.nearness.size() == other.nearness.size() && max_px >= 0.0);
  return std::max(motion_into(view, one, other, max_px), motion_into(view, other, one, max_px));
}

Popping measure_popping(const View& view, const DepthBuffer& before, const DepthBuffer& after) {
  const DepthDistance distance = depth_distance(view, before, after);
  return {largest_motion_px(view, before, after), distance.rms_px, distance.silhouette_mismatch};
}

std::size_t count_unexplained_pixels(const View& view, const DepthBuffer& expected, const DepthBuffer& found,
                                     double allowed_px) {
  assert(expected.nearness.size() == found.nearness.size() && allowed_px >= 0.0);
  const int radius = whole_pixels(allowed_px, found);
  const std::vector<float> farthest = extreme_around(found, radius, std::less<>());
  const std::vector<float> nearest = extreme_around(found, radius, std::greater<>());
  std::size_t unexplained = 0;
  for (std::size_t i = 0; i < expected.nearness.size(); ++i)
    unexplained += is_within(view, expected.nearness[i], nearest[i], farthest[i], allowed_px) ? 0U : 1U;
  return unexplained;
}

std::size_t count_lost_pixels(const View& view, const DepthBuffer& full, const DepthBuffer& found, double allowed_px) {
  assert(full.nearness.size() == found.nearness.size() && allowed_px >= 0.0);
  const int radius = allowed_px > 0.0 ? whole_pixels(allowed_px + 1.0, full) : 0;
  const std::vector<float> farthest = extreme_around(full, radius, std::less<>());
  const std::vector<float> nearest = extreme_around(found, radius, std::greater<>());
  std::size_t lost = 0;
  for (std::size_t i = 0; i < farthest.size(); ++i)
    lost += is_within(view, farthest[i], nearest[i], 0.0, radius) ? 0U : 1U;
  return lost;
}

std::size_t count_crack_pixels(const View& view, const DepthBuffer& full, const DepthBuffer& found, double allowed_px) {
  assert(full.nearness.size() == found.nearness.size() && allowed_px >= 0.0);
  const double none = std::numeric_limits<double>::infinity();
  const int radius = std::max(2, whole_pixels(allowed_px, full));
  const std::vector<float> farthest = extreme_around(full, radius, std::less<>());
  const std::vector<float> steps = extreme_around(depth_steps(view, full), radius, std::greater<>());
  const std::vector<float> nearest_beside = extreme_around(found, 1, std::greater<>());
  std::size_t cracks = 0;
  for (std::size_t i = 0; i < full.nearness.size(); ++i) {
    const bool is_behind = !is_within(view, found.nearness[i], none, farthest[i], allowed_px);
    cracks += is_behind && steps[i] == 0.0F && is_within(view, full.nearness[i], nearest_beside[i], 0.0, allowed_px);
  }
  return cracks;
}

namespace {

// Computes the texels of one item, for all its pixels.
class TexelsOfItem {
 public:
  TexelsOfItem(const picture::ItemTable::Owner& owner, std::size_t object, const ObjectTexture& texture,
               const View& view)
      : screen_(picture::world_corners(owner), view) {
    if (texture.coordinates.empty()) return;
    const Triangle& t = *owner.triangle;
    const std::uint64_t material = texture.vertex_materials.empty() ? 0 : texture.vertex_materials[t.x];
    surface_ = (static_cast<std::uint64_t>(object) << 32U) + material + 1;
    for (int i = 0; i < 3; ++i) corners_[static_cast<std::size_t>(i)] = texture.coordinates[t[i]];
  }

  [[nodiscard]] Texel at(const glm::dvec2& pixel) const {
    if (surface_ == 0) return {};
    const Texel texel{surface_, of(screen_.exact_barycentric(pixel)), of(screen_.barycentric_step(pixel, 0)),
                      of(screen_.barycentric_step(pixel, 1))};
    const glm::dvec2 sum = texel.coordinate + texel.across + texel.down;
    return std::isfinite(sum.x) && std::isfinite(sum.y) ? texel : Texel();
  }

 private:
  [[nodiscard]] glm::dvec2 of(const glm::dvec3& weights) const {
    return weights.x * corners_[0] + weights.y * corners_[1] + weights.z * corners_[2];
  }

  picture::ScreenTriangle screen_;
  std::uint64_t surface_ = 0;
  std::array<glm::dvec2, 3> corners_{};
};

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

// Returns whether texture coordinates change in two independent directions; a change in the second direction of less
// than a ten-thousandth counts as rounding.
bool has_place(const Texel& texel) {
  constexpr double least = 1e-4;
  const double changes = glm::dot(texel.across, texel.across) + glm::dot(texel.down, texel.down);
  return texel.surface != 0 && std::abs(cross(texel.across, texel.down)) > least * changes;
}

// Describes a pixel near another.
struct Offset {
  int x;
  int y;
  double distance;
};

// Limits how far outside its pixel a texel is searched for: half a diagonal, plus a margin for nonlinearity.
constexpr double reach_px = 0.75;

// Returns all offsets from which a texel can be found, the nearest first.
std::vector<Offset> offsets_by_distance() {
  constexpr double most = largest_slip_px + reach_px;
  const int radius = static_cast<int>(most);
  std::vector<Offset> offsets;
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x)
      if (const double distance = std::hypot(x, y); distance <= most) offsets.push_back({x, y, distance});
  std::stable_sort(offsets.begin(), offsets.end(),
                   [](const Offset& a, const Offset& b) { return a.distance < b.distance; });
  return offsets;
}

// Locates texels in the picture of the full mesh.
class Places {
 public:
  explicit Places(const TexelBuffer& full) : full_(full), offsets_(offsets_by_distance()) {}

  [[nodiscard]] const Texel& at(int x, int y) const {
    return full_
        .texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(full_.width) + static_cast<std::size_t>(x)];
  }

  // Returns the distance from the pixel (x, y), which shows the texel, to the nearest place where the full mesh shows
  // it.
  [[nodiscard]] double distance_to(const Texel& texel, int x, int y) const {
    double nearest = largest_slip_px;
    for (const Offset& offset : offsets_) {
      if (offset.distance >= nearest + reach_px) break;
      const int other_x = x + offset.x, other_y = y + offset.y;
      if (other_x < 0 || other_y < 0 || other_x >= full_.width || other_y >= full_.height) continue;
      const Texel& other = at(other_x, other_y);
      if (other.surface != texel.surface || !has_place(other)) continue;
      const glm::dvec2 change = texel.coordinate - other.coordinate;
      const double area = cross(other.across, other.down);
      const glm::dvec2 beyond(cross(change, other.down) / area, cross(other.across, change) / area);
      if (!(glm::length(beyond) <= reach_px)) continue;
      nearest = std::min(nearest, glm::length(glm::dvec2(offset.x, offset.y) + beyond));
    }
    return nearest;
  }

 private:
  const TexelBuffer& full_;
  std::vector<Offset> offsets_;
};

}  // namespace

TexelBuffer find_texels(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view,
                        std::span<const ObjectTexture> textures) {
  assert(textures.size() == objects.size());
  assert(items.depth.width == view.width() && items.depth.height == view.height());
  const picture::ItemTable table(objects);
  TexelBuffer buffer{items.depth.width, items.depth.height, {}};
  buffer.texels.reserve(items.items.size());
  std::optional<TexelsOfItem> last;  // neighbouring pixels mostly belong to one item
  std::uint32_t last_item = no_item;
  for (int y = 0; y < buffer.height; ++y)
    for (int x = 0; x < buffer.width; ++x) {
      const std::uint32_t item = items.items[buffer.texels.size()];
      if (item != no_item && (!last || item != last_item)) {
        const picture::ItemTable::Owner owner = table.owner(item);
        const auto object = static_cast<std::size_t>(owner.object - objects.data());
        last.emplace(owner, object, textures[object], view);
        last_item = item;
      }
      buffer.texels.push_back(item == no_item ? Texel() : last->at({x + 0.5, y + 0.5}));
    }
  return buffer;
}

std::optional<double> texture_slip_px(const TexelBuffer& shown, const TexelBuffer& full) {
  assert(shown.width == full.width && shown.height == full.height);
  const Places places(full);
  double sum = 0.0;
  std::size_t count = 0;
  for (int y = 0; y < full.height; ++y)
    for (int x = 0; x < full.width; ++x) {
      const Texel& texel =
          shown
              .texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(full.width) + static_cast<std::size_t>(x)];
      if (texel.surface == 0 || !has_place(places.at(x, y))) continue;
      const double distance = places.distance_to(texel, x, y);
      sum += distance * distance;
      ++count;
    }
  if (count == 0) return std::nullopt;
  return std::sqrt(sum / static_cast<double>(count));
}

}  // namespace occlod
