#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_inverse.hpp>
#include <glm/matrix.hpp>
#include <optional>

#include "scene/color.h"
#include "scene/shading.h"

namespace occlod {
namespace picture {
namespace {

// Computes lights that move with the viewer, so that no side of an object that faces the camera is dark.
class Lights {
 public:
  Lights(const View& view, const glm::dvec3& key_light) : view_(view) {
    const glm::dvec3 forward = view.direction();
    const glm::dvec3 right = glm::normalize(glm::cross(forward, view.camera().up));
    up_ = glm::cross(right, forward);
    key_ = glm::normalize(key_light.x * right + key_light.y * up_ - key_light.z * forward);
  }

  // Returns the light on a flat two-sided surface through `position`.
  [[nodiscard]] glm::vec3 on(const glm::dvec3& position, const glm::dvec3& normal) const {
    return on_corner(position, normal, to_eye(position));
  }

  // Returns the light at a corner of a triangle whose side that faces the eye has the normal `facing`.
  [[nodiscard]] glm::vec3 on_corner(const glm::dvec3& position, glm::dvec3 normal, const glm::dvec3& facing) const {
    if (glm::dot(normal, facing) < 0.0) normal = -normal;
    const auto head = static_cast<float>(std::max(glm::dot(normal, to_eye(position)), 0.0));
    const auto key = static_cast<float>(std::max(glm::dot(normal, key_), 0.0));
    const auto sky = static_cast<float>(0.5 + 0.5 * glm::dot(normal, up_));
    return 0.12F * head + 0.98F * key * glm::vec3(1.0F, 0.94F, 0.84F) +
           glm::mix(glm::vec3(0.045F, 0.036F, 0.034F), glm::vec3(0.12F, 0.15F, 0.20F), sky);
  }

 private:
  [[nodiscard]] glm::dvec3 to_eye(const glm::dvec3& position) const {
    return view_.is_orthographic() ? -view_.direction() : glm::normalize(view_.camera().eye - position);
  }

  const View& view_;
  glm::dvec3 up_;
  glm::dvec3 key_;
};

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

// Holds what is the same for all pixels of one item.
struct Appearance {
  Appearance(const ItemTable::Owner& owner, const View& view, const Lights& lights, const ItemColor& item_color)
      : Appearance(world_corners(owner), view, lights, item_color) {
    if (glm::determinant(glm::dmat3(owner.object->object_to_world)) < 0.0) faces_viewer = !faces_viewer;
  }
  Appearance(const std::array<glm::dvec3, 3>& corners, const View& view, const Lights& lights,
             const ItemColor& item_color)
      : screen(corners, view), color(item_color) {
    const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double length = glm::length(normal);
    const glm::dvec3 center = (corners[0] + corners[1] + corners[2]) / 3.0;
    faces_viewer = glm::dot(normal, view.is_orthographic() ? -view.direction() : view.camera().eye - center) > 0.0;
    const glm::dvec3 face = length > 0.0 ? normal / length : -view.direction();
    light.fill(lights.on(center, face));
    for (std::size_t i = 0; color.normals && length > 0.0 && i < light.size(); ++i)
      if (const glm::dvec3& smooth = (*color.normals)[i]; smooth != glm::dvec3(0.0))
        light[i] = lights.on_corner(corners[i], smooth, faces_viewer ? face : -face);
    // Lines fade out where they would fill their triangles.
    wire_strength = 0.6 * smooth_step(1.2, 6.0, screen.diameter_px());
  }

  ScreenTriangle screen;
  ItemColor color;
  std::array<glm::vec3, 3> light{};  // at the corners
  // its corners run counter-clockwise as seen by the viewer, or clockwise for a mirrored object
  bool faces_viewer = false;
  double wire_strength = 0.0;
};

int shared_corners(const Triangle& a, const Triangle& b) {
  int shared = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) shared += a[i] == b[k] ? 1 : 0;
  return shared;
}

// Returns the difference of nearness that corresponds to a step in depth as long as the distance from the eye. For
// orthographic views, uses the distance from which a perspective camera with 45 degrees would show as much.
float outline_unit(const View& view, float nearness) {
  if (!view.is_orthographic()) return nearness;
  const Camera& camera = view.camera();
  constexpr double distance_per_height = 1.2071;  // 1 / (2 tan 22.5 degrees)
  return static_cast<float>(distance_per_height * *camera.orthographic_height / (camera.far - camera.near));
}

// Returns how dark the outline is at a pixel beside which something farther is visible, in [0, 1]. A plane has a linear
// nearness on the screen, so it is a step only where nearness falls faster to one side than it rises from the other.
float outline(const View& view, const DepthBuffer& depth, int x, int y) {
  const auto at = [&](int px, int py) {
    return depth
        .nearness[static_cast<std::size_t>(py) * static_cast<std::size_t>(depth.width) + static_cast<std::size_t>(px)];
  };
  const float here = at(x, y), unit = outline_unit(view, here);
  float steepest = 0.0F;
  const auto look = [&](int dx, int dy) {
    const int nx = x + dx, ny = y + dy, ox = x - dx, oy = y - dy;
    if (nx < 0 || ny < 0 || nx >= depth.width || ny >= depth.height) return;
    const bool inside = ox >= 0 && oy >= 0 && ox < depth.width && oy < depth.height;
    const float rise = inside ? std::max(at(ox, oy) - here, 0.0F) : 0.0F;
    steepest = std::max(steepest, (here - at(nx, ny) - rise) / unit);
  };
  look(1, 0);
  look(-1, 0);
  look(0, 1);
  look(0, -1);
  return static_cast<float>(smooth_step(0.015, 0.05, steepest));
}

class Painter {
 public:
  Painter(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view, const Style& style,
          const ColorOfItem& color_of_item)
      : items_(items),
        table_(objects),
        view_(view),
        style_(style),
        lights_(view, style.key_light),
        color_of_item_(color_of_item) {}

  [[nodiscard]] Image paint() {
    const int width = items_.depth.width;
    const int height = items_.depth.height;
    Image image{width, height, {}};
    image.pixels.reserve(items_.items.size());
    for (int y = 0; y < height; ++y) {
      const glm::u8vec4 background = to_srgb(glm::mix(style_.background_top, style_.background_bottom,
                                                      (static_cast<float>(y) + 0.5F) / static_cast<float>(height)));
      for (int x = 0; x < width; ++x) {
        const std::uint32_t item = items_.items[image.pixels.size()];
        image.pixels.push_back(item == no_item ? background : to_srgb(surface(shown_item(item, x, y), x, y)));
      }
    }
    return image;
  }

 private:
  [[nodiscard]] std::uint32_t item_at(int x, int y) const {
    const DepthBuffer& depth = items_.depth;
    if (x < 0 || y < 0 || x >= depth.width || y >= depth.height) return no_item;
    return items_
        .items[static_cast<std::size_t>(y) * static_cast<std::size_t>(depth.width) + static_cast<std::size_t>(x)];
  }

  // Returns the item whose shading a pixel uses. At a contour a front face and the back face behind it meet, and
  // rounding can make the back face the nearer one in single pixels. Those are shaded as the front face beside them
  // that has the most corners in common with the back face; all other pixels use their own item.
  [[nodiscard]] std::uint32_t shown_item(std::uint32_t item, int x, int y) {
    if (appearance(item).faces_viewer || !is_single(item, x, y)) return item;
    const ItemTable::Owner owner = table_.owner(item);
    std::uint32_t shown = item;
    int max_shared = 0;
    for (int i = 0; i < 9; ++i) {
      const std::uint32_t other = item_at(x + i % 3 - 1, y + i / 3 - 1);
      if (other == no_item || table_.owner(other).object != owner.object) continue;
      const int shared = shared_corners(*table_.owner(other).triangle, *owner.triangle);
      if (shared <= max_shared || !appearance(other).faces_viewer) continue;
      shown = other;
      max_shared = shared;
    }
    return shown;
  }

  // Returns whether none of the four neighbouring pixels shows the same item.
  [[nodiscard]] bool is_single(std::uint32_t item, int x, int y) const {
    return item_at(x - 1, y) != item && item_at(x + 1, y) != item && item_at(x, y - 1) != item &&
           item_at(x, y + 1) != item;
  }

  glm::vec3 surface(std::uint32_t item, int x, int y) {
    const Appearance& a = appearance(item);
    const glm::dvec2 pixel(x + 0.5, y + 0.5);
    const glm::vec3 weights = a.screen.barycentric(pixel);
    const auto between = [&](const std::array<glm::vec3, 3>& at) {
      return weights.x * at[0] + weights.y * at[1] + weights.z * at[2];
    };
    glm::vec3 color = (a.color.normals ? between(a.light) : a.light[0]) * between(a.color.corners);
    if (a.color.image != nullptr) color *= texture(a, pixel, weights);
    if (style_.wire && a.wire_strength > 0.0) {
      const double line = 1.0 - smooth_step(0.2, 1.1, a.screen.edge_distance_px(pixel));
      color *= static_cast<float>(1.0 - a.wire_strength * line);
    }
    return style_.outlines ? color * (1.0F - 0.65F * outline(view_, items_.depth, x, y)) : color;
  }

  static glm::vec3 texture(const Appearance& a, const glm::dvec2& pixel, const glm::dvec3& weights) {
    const auto& corners = a.color.coordinates;
    const auto at = [&](const glm::dvec3& w) { return w.x * corners[0] + w.y * corners[1] + w.z * corners[2]; };
    return a.color.image->sample(at(weights), at(a.screen.barycentric_step(pixel, 0)),
                                 at(a.screen.barycentric_step(pixel, 1)));
  }

  // Returns the appearance of an item; caches the last one, because neighbouring pixels mostly belong to one item.
  const Appearance& appearance(std::uint32_t item) {
    if (!last_ || last_item_ != item) {
      const ItemTable::Owner owner = table_.owner(item);
      last_.emplace(owner, view_, lights_, color_of_item_(item, owner));
      last_item_ = item;
    }
    return *last_;
  }

  const ItemBuffer& items_;
  ItemTable table_;
  const View& view_;
  const Style& style_;
  Lights lights_;
  const ColorOfItem& color_of_item_;
  std::optional<Appearance> last_;
  std::uint32_t last_item_ = no_item;
};

// Returns the colours of the corners; `base` if there are no vertex colours.
ItemColor vertex_color(const ItemTable::Owner& owner, const glm::vec3& base) {
  const auto& colors = owner.object->colors;
  if (colors.empty()) return base;
  const Triangle& t = *owner.triangle;
  return {to_linear(colors[t.x]), to_linear(colors[t.y]), to_linear(colors[t.z])};
}

void lay_over(ItemColor& color, const ObjectTexture& texture, const Triangle& triangle) {
  if (texture.materials.empty()) return;
  const DrawMaterial& material =
      texture.materials[texture.vertex_materials.empty() ? 0 : texture.vertex_materials[triangle.x]];
  for (glm::vec3& corner : color.corners) corner *= material.base_color;
  if (texture.coordinates.empty()) return;
  color.image = material.image;
  for (int i = 0; i < 3; ++i) color.coordinates[static_cast<std::size_t>(i)] = texture.coordinates[triangle[i]];
}

Style usual_style(bool wire) {
  return {.wire = wire, .background_top = {0.33F, 0.41F, 0.52F}, .background_bottom = {0.80F, 0.83F, 0.86F}};
}

}  // namespace

Image shade_items(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view, const Style& style,
                  const ColorOfItem& color_of_item) {
  assert(items.depth.width == view.width() && items.depth.height == view.height());
  return Painter(items, objects, view, style, color_of_item).paint();
}

Image shade_smooth(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view,
                   const NormalAt& normal_at) {
  Style style = usual_style(false);
  style.outlines = false;
  return shade_items(items, objects, view, style, [&](std::uint32_t, const ItemTable::Owner& owner) {
    const glm::dmat3 to_world = glm::inverseTranspose(glm::dmat3(owner.object->object_to_world));
    ItemColor color = vertex_color(owner, ShadeOptions().base);
    color.normals.emplace();
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3 normal = normal_at(*owner.object, owner.object->positions[(*owner.triangle)[i]]);
      if (normal != glm::dvec3(0.0)) (*color.normals)[static_cast<std::size_t>(i)] = glm::normalize(to_world * normal);
    }
    return color;
  });
}

}  // namespace picture

Image shade(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view,
            const ShadeOptions& options) {
  const picture::Style style = picture::usual_style(options.wire);
  assert(options.textures.empty() || options.textures.size() == objects.size());
  return picture::shade_items(
      items, objects, view, style, [&](std::uint32_t, const picture::ItemTable::Owner& owner) -> picture::ItemColor {
        const auto object = static_cast<std::size_t>(owner.object - objects.data());
        const ObjectTexture texture = options.textures.empty() ? ObjectTexture() : options.textures[object];
        picture::ItemColor color =
            picture::vertex_color(owner, texture.materials.empty() ? options.base : glm::vec3(1.0F));
        picture::lay_over(color, texture, *owner.triangle);
        return color;
      });
}

Image draw_picture(std::span<const RefineObject> objects, const Refinement& refinement, const View& view,
                   const ShadeOptions& options) {
  assert(objects.size() == refinement.objects.size());
  std::vector<DrawObject> drawn;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Hierarchy& hierarchy = *objects[i].hierarchy;
    drawn.push_back(
        {hierarchy.positions(), hierarchy.data().colors, refinement.objects[i].triangles, objects[i].object_to_world});
  }
  ItemBuffer items;
  draw_items(items, drawn, view);
  return shade(items, drawn, view, options);
}

}  // namespace occlod
