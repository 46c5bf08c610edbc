#include "occlod/picture/texture_slip.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>

#include "scene/item_table.h"
#include "scene/screen_triangle.h"

namespace occlod {
namespace {

// Of one item, for all its pixels.
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

// Less than a ten-thousandth in the other direction is rounding.
bool has_place(const Texel& texel) {
  constexpr double least = 1e-4;
  const double changes = glm::dot(texel.across, texel.across) + glm::dot(texel.down, texel.down);
  return texel.surface != 0 && std::abs(cross(texel.across, texel.down)) > least * changes;
}

// A pixel near another.
struct Offset {
  int x;
  int y;
  double distance;
};

// How far beyond its pixel a texel may be looked for: half a diagonal, and some more for what is not linear.
constexpr double reach_px = 0.75;

// All that a texel can be found from, the nearest first.
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

// Where texels of the full mesh's picture are.
class Places {
 public:
  explicit Places(const TexelBuffer& full) : full_(full), offsets_(offsets_by_distance()) {}

  [[nodiscard]] const Texel& at(int x, int y) const {
    return full_
        .texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(full_.width) + static_cast<std::size_t>(x)];
  }

  // From the pixel (x, y), at which it is shown, to the nearest place.
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
