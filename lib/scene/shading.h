// Maps the number of an item back to its triangle.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "occlod/picture.h"
#include "occlod/view.h"

namespace occlod::picture {

// Uses the numbering of draw_items(): object by object.
class ItemTable {
 public:
  explicit ItemTable(std::span<const DrawObject> objects);

  [[nodiscard]] std::size_t size() const noexcept { return first_items_.back(); }
  [[nodiscard]] std::uint32_t first_item(std::size_t object) const noexcept { return first_items_[object]; }

  struct Owner {
    const DrawObject* object;
    const Triangle* triangle;
  };
  // Returns the triangle of an item. Precondition: item < size().
  [[nodiscard]] Owner owner(std::uint32_t item) const;

 private:
  std::span<const DrawObject> objects_;
  std::vector<std::uint32_t> first_items_;  // of each object, then the total
};

// Returns the corners in world space.
[[nodiscard]] std::array<glm::dvec3, 3> world_corners(const ItemTable::Owner& owner);

// Interpolates corner values over a triangle on the screen.

// Holds the three edge functions of a triangle in homogeneous pixel coordinates (Olano & Greer 1997): they are linear
// over the image and valid for triangles that reach behind the eye. Their ratios are perspective-correct barycentric
// coordinates.
class ScreenTriangle {
 public:
  // Takes the corners in world space.
  ScreenTriangle(const std::array<glm::dvec3, 3>& corners, const View& view);

  [[nodiscard]] glm::vec3 barycentric(const glm::dvec2& pixel) const;
  // Returns barycentric coordinates that are neither clamped to the triangle nor rounded. The triangle must have an
  // area on the screen.
  [[nodiscard]] glm::dvec3 exact_barycentric(const glm::dvec2& pixel) const;

  // Returns how much the barycentric coordinates change per pixel; axis 0: to the right, 1: down.
  [[nodiscard]] glm::dvec3 barycentric_step(const glm::dvec2& pixel, int axis) const;

  // Returns the distance from the pixel to the nearest edge.
  [[nodiscard]] double edge_distance_px(const glm::dvec2& pixel) const;

  // Returns the diameter of the inscribed circle; infinite when the triangle reaches behind the eye.
  [[nodiscard]] double diameter_px() const { return diameter_px_; }

 private:
  // Evaluates the edge functions.
  [[nodiscard]] glm::dvec3 at(const glm::dvec2& pixel) const;

  std::array<glm::dvec3, 3> edges_;
  double diameter_px_;
};

// Shades all pictures alike; they differ only in the colour of a triangle.

// Holds linear colours of the three corners of an item, and an image that multiplies them.
struct ItemColor {
  ItemColor(const glm::vec3& color) : corners{color, color, color} {}  // NOLINT: the same colour everywhere
  ItemColor(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) : corners{a, b, c} {}

  std::array<glm::vec3, 3> corners;
  const TextureImage* image = nullptr;
  std::array<glm::dvec2, 3> coordinates{};  // texture coordinates
  // Unit length, world space; zero: that of the triangle. None: the triangle is flat.
  std::optional<std::array<glm::dvec3, 3>> normals;
};
using ColorOfItem = std::function<ItemColor(std::uint32_t item, const ItemTable::Owner& owner)>;

struct Style {
  bool wire = true;
  bool outlines = true;
  glm::vec3 background_top{0.0F};  // linear
  glm::vec3 background_bottom{0.0F};
  glm::dvec3 key_light{-0.60, 0.75, 0.45};  // towards the light: right, up and towards the viewer
};

[[nodiscard]] Image shade_items(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view,
                                const Style& style, const ColorOfItem& color_of_item);

// Returns the normal at a vertex of an object: unit length, object space; zero where there is none.
using NormalAt = std::function<glm::dvec3(const DrawObject& object, const glm::vec3& position)>;

// Shades like shade(), but without wires and outlines, and with light that is interpolated between the corners of a
// triangle. Such pictures differ where surfaces do.
[[nodiscard]] Image shade_smooth(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view,
                                 const NormalAt& normal_at);

}  // namespace occlod::picture
