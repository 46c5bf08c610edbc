#include "cell_sight.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <unordered_map>

#include "base/arithmetic.h"
#include "occlod/build_hierarchy.h"
#include "occlod/item_buffer.h"

namespace occlod::tool {
namespace {

using WorldTriangle = std::array<glm::dvec3, 3>;

// Returns the distance as in Ericson 2005, 5.1.5.
double distance_to(const WorldTriangle& t, const glm::dvec3& p) {
  const glm::dvec3 &a = t[0], &b = t[1], &c = t[2], ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap), d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp),
               d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  glm::dvec3 nearest;
  if (d1 <= 0 && d2 <= 0)
    nearest = a;
  else if (d3 >= 0 && d4 <= d3)
    nearest = b;
  else if (d6 >= 0 && d5 <= d6)
    nearest = c;
  else if (vc <= 0 && d1 >= 0 && d3 <= 0)
    nearest = a + ab * (d1 / (d1 - d3));
  else if (vb <= 0 && d2 >= 0 && d6 <= 0)
    nearest = a + ac * (d2 / (d2 - d6));
  else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    nearest = b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  else
    nearest = a + ab * (vb / (va + vb + vc)) + ac * (vc / (va + vb + vc));
  return glm::distance(nearest, p);
}

// Holds, in each bucket of a grid, the triangles whose boxes touch it.
class TriangleGrid {
 public:
  explicit TriangleGrid(std::vector<WorldTriangle> triangles) : triangles_(std::move(triangles)) {
    glm::dvec3 low(1e300), high(-1e300);
    for (const WorldTriangle& t : triangles_)
      for (const glm::dvec3& p : t) low = glm::min(low, p), high = glm::max(high, p);
    step_ = std::max(glm::length(high - low) / 64.0, 1e-9);
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      const WorldTriangle& t = triangles_[i];
      for_each_bucket(glm::min(t[0], glm::min(t[1], t[2])), glm::max(t[0], glm::max(t[1], t[2])),
                      [&](std::uint64_t key) { return buckets_[key].push_back(i), false; });
    }
  }

  [[nodiscard]] bool any_within(const glm::dvec3& p, double radius) const {
    return for_each_bucket(p - radius, p + radius, [&](std::uint64_t key) {
      const auto at = buckets_.find(key);
      return at != buckets_.end() && std::any_of(at->second.begin(), at->second.end(), [&](std::uint32_t i) {
               return distance_to(triangles_[i], p) <= radius;
             });
    });
  }

 private:
  template <typename Visit>
  bool for_each_bucket(const glm::dvec3& low, const glm::dvec3& high, const Visit& visit) const {
    const glm::dvec3 first = glm::floor(low / step_), last = glm::floor(high / step_);
    for (double z = first.z; z <= last.z; ++z)
      for (double y = first.y; y <= last.y; ++y)
        for (double x = first.x; x <= last.x; ++x) {
          const auto part = [](double v) {
            return static_cast<std::uint64_t>(static_cast<std::int64_t>(v)) & 0x1FFFFFU;
          };
          if (visit(part(x) | part(y) << 21U | part(z) << 42U)) return true;
        }
    return false;
  }

  std::vector<WorldTriangle> triangles_;
  double step_ = 1.0;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> buckets_;
};

WorldTriangle world_triangle(const RefineObject& object, const Triangle& t) {
  WorldTriangle result;
  for (int k = 0; k < 3; ++k)
    result[static_cast<std::size_t>(k)] = object.object_to_world * glm::dvec4(object.hierarchy->positions()[t[k]], 1.0);
  return result;
}

// Returns the faces that may stand for what is seen: drawn ones, and those turned away from the whole cell.
std::vector<WorldTriangle> standing_faces(const CellBox& cell, std::span<const RefineObject> objects,
                                          const CellOptions& options, std::span<const CellObjectCut> cut) {
  std::vector<WorldTriangle> result;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (const Triangle& t : cut[i].triangles) result.push_back(world_triangle(objects[i], t));
    if (objects[i].two_sided) continue;
    const CellView view(cell, options.eyes, objects[i].object_to_world);
    FixedCut active{std::vector<bool>(objects[i].hierarchy->split_count(), false)};
    for (const SplitId s : cut[i].applied) active.applied[s] = true;
    active.triangles = objects[i].hierarchy->face_count();
    const std::span<const glm::vec3> p = objects[i].hierarchy->positions();
    for (const Triangle& t : triangles_of(*objects[i].hierarchy, active))
      if (view.faces_away(p[t.x], p[t.y], p[t.z])) result.push_back(world_triangle(objects[i], t));
  }
  return result;
}

std::vector<glm::dvec3> eyes_of(const CellBox& cell, const CellEyes& chosen) {
  std::vector<glm::dvec3> eyes = {0.5 * (cell.min + cell.max)};
  for (unsigned i = 0; i < 8; ++i)
    eyes.emplace_back((i & 1U) != 0 ? cell.max.x : cell.min.x, (i & 2U) != 0 ? cell.max.y : cell.min.y,
                      (i & 4U) != 0 ? cell.max.z : cell.min.z);
  RandomStream random(chosen.seed);
  for (int i = 0; i < chosen.random; ++i) {
    glm::dvec3 part;
    for (int axis = 0; axis < 3; ++axis) part[axis] = random.between(0.0, 1.0);
    eyes.push_back(glm::mix(cell.min, cell.max, part));
  }
  return eyes;
}

// Returns a camera for a face of the cube around the eye.
Camera face_camera(const glm::dvec3& eye, int face, int image_size, double near) {
  glm::dvec3 direction(0.0), up(0.0);
  direction[face / 2] = face % 2 == 0 ? 1.0 : -1.0;
  up[(face / 2 + 1) % 3] = 1.0;
  Camera camera;
  camera.eye = eye;
  camera.target = eye + direction;
  camera.up = up;
  camera.fov_y_deg = 90.0;
  camera.width = camera.height = image_size;
  camera.near = near;
  camera.far = 1e6;
  return camera;
}

// Draws all objects and tells whose triangles are seen.
class SceneItems {
 public:
  explicit SceneItems(std::span<const RefineObject> objects) : objects_(objects) {}

  // `triangles`(i) returns those of object i.
  template <typename Triangles>
  void draw(const View& view, const Triangles& triangles) {
    items_.reset(view.width(), view.height());
    first_item_.clear();
    std::uint32_t first = 0;
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      first_item_.push_back(first);
      const ObjectView object(view, objects_[i].object_to_world);
      draw_items(items_, objects_[i].hierarchy->positions(), triangles(i), object.object_to_clip(), first);
      first += static_cast<std::uint32_t>(triangles(i).size());
    }
  }
  // Returns the item of each pixel, rows from the top.
  [[nodiscard]] const std::vector<std::uint32_t>& items() const { return items_.items; }
  [[nodiscard]] std::size_t object_of(std::uint32_t item) const {
    return static_cast<std::size_t>(std::upper_bound(first_item_.begin() + 1, first_item_.end(), item) -
                                    first_item_.begin() - 1);
  }
  // Returns which of its object's triangles an item is.
  [[nodiscard]] std::size_t triangle_of(std::uint32_t item) const { return item - first_item_[object_of(item)]; }

 private:
  std::span<const RefineObject> objects_;
  ItemBuffer items_;
  std::vector<std::uint32_t> first_item_;
};

enum class Seen { front, back, unclear };
// Describes what a pixel shows.
struct SeenPoint {
  Seen what = Seen::unclear;
  glm::dvec3 place{0.0}, ray{0.0};  // `ray`: direction from the eye, unit length
  double distance = 0.0;
};

SeenPoint seen_point(const FullScene::Item& item, std::span<const RefineObject> objects, const View& view, int x,
                     int y) {
  const RefineObject& object = objects[item.object];
  const WorldTriangle t = world_triangle(object, item.triangle);
  const glm::dvec4 far =
      glm::inverse(view.world_to_clip()) *
      glm::dvec4(2.0 * (x + 0.5) / view.width() - 1.0, 1.0 - 2.0 * (y + 0.5) / view.height(), 0.5, 1.0);
  const glm::dvec3 eye = view.camera().eye, ray = glm::normalize(glm::dvec3(far) / far.w - eye);
  const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double towards = glm::dot(normal, ray), mirror = glm::determinant(glm::dmat3(object.object_to_world));
  if (std::abs(towards) < 1e-4 * glm::length(normal)) return {};  // edge-on, too close to decide
  if (!object.two_sided && (towards > 0.0) == (mirror > 0.0)) return {Seen::back};
  const double distance = glm::dot(normal, t[0] - eye) / towards;
  const glm::dvec3 seen = eye + distance * ray;
  if (distance_to(t, seen) > 1e-6 * distance) return {};  // the pixel is the triangle's only by rounding
  return {Seen::front, seen, ray, distance};
}

std::size_t pixel_at(const View& view, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width()) + static_cast<std::size_t>(x);
}

class Looking {
 public:
  Looking(const CellBox& cell, const FullScene& scene, std::span<const RefineObject> objects,
          const CellOptions& options, std::span<const CellObjectCut> cut)
      : scene_(scene),
        objects_(objects),
        options_(options),
        cut_(cut),
        standing_(standing_faces(cell, objects, options, cut)),
        drawn_(objects) {}

  void look(const View& view) {
    scene_.draw(items_, view);
    drawn_.draw(view, [&](std::size_t i) -> const std::vector<Triangle>& { return cut_[i].triangles; });
    for (int y = 0; y < view.height(); ++y)
      for (int x = 0; x < view.width(); ++x)
        if (items_.items[pixel_at(view, x, y)] != no_item) judge(view, x, y);
  }

  [[nodiscard]] const CellSight& result() const { return sight_; }

 private:
  void judge(const View& view, int x, int y) {
    const SeenPoint point = seen_point(scene_.item(items_.items[pixel_at(view, x, y)]), objects_, view, x, y);
    sight_.backs += point.what == Seen::back ? 1U : 0U;
    if (point.what != Seen::front) return;
    ++sight_.pixels;
    // This is what the promise allows there, plus a hundredth for the change of scale on the way.
    const double cos_angle = std::max(glm::dot(point.ray, view.direction()), options_.eyes.cos_corner_angle);
    const double allowed =
        1.01 * options_.tolerance_px * point.distance * cos_angle * cos_angle / options_.eyes.focal_length_px;
    sight_.missing +=
        is_drawn_there(view, x, y, point.place, allowed) || standing_.any_within(point.place, allowed) ? 0U : 1U;
  }

  // Returns whether what is drawn at the same pixel is near enough. Mostly it is, which saves the search.
  bool is_drawn_there(const View& view, int x, int y, const glm::dvec3& seen, double allowed) const {
    const std::uint32_t item = drawn_.items()[pixel_at(view, x, y)];
    if (item == no_item) return false;
    const std::size_t i = drawn_.object_of(item);
    return distance_to(world_triangle(objects_[i], cut_[i].triangles[drawn_.triangle_of(item)]), seen) <= allowed;
  }

  const FullScene& scene_;
  std::span<const RefineObject> objects_;
  const CellOptions& options_;
  std::span<const CellObjectCut> cut_;
  TriangleGrid standing_;
  SceneItems drawn_;
  ItemBuffer items_;
  CellSight sight_;
};

// Calls visit(View) for all sides of all eyes.
template <typename Visit>
void for_each_view(const CellBox& cell, double near, const CellEyes& eyes, const Visit& visit) {
  for (const glm::dvec3& eye : eyes_of(cell, eyes))
    for (int face = 0; face < 6; ++face) visit(View(face_camera(eye, face, eyes.image_size, near)));
}

}  // namespace

std::vector<std::uint32_t> count_pixels(const CellBox& cell, const FullScene& scene,
                                        std::span<const RefineObject> objects, double near, const CellEyes& eyes) {
  std::vector<std::uint32_t> pixels(scene.triangle_count(), 0);
  ItemBuffer items;
  for_each_view(cell, near, eyes, [&](const View& view) {
    scene.draw(items, view);
    for (int y = 0; y < view.height(); ++y)
      for (int x = 0; x < view.width(); ++x) {
        const std::uint32_t item = items.items[pixel_at(view, x, y)];
        if (item == no_item || seen_point(scene.item(item), objects, view, x, y).what != Seen::front) continue;
        ++pixels[item];
      }
  });
  return pixels;
}

CellSight look_from(const CellBox& cell, const FullScene& scene, std::span<const RefineObject> objects,
                    const CellOptions& options, std::span<const CellObjectCut> cut, const CellEyes& eyes) {
  Looking looking(cell, scene, objects, options, cut);
  for_each_view(cell, options.eyes.near, eyes, [&](const View& view) { looking.look(view); });
  return looking.result();
}

std::size_t count_seen(const CellBox& cell, std::span<const RefineObject> objects, double near,
                       std::span<const CellObjectCut> cut, const CellEyes& eyes) {
  SceneItems scene(objects);
  std::vector<std::vector<bool>> seen;
  for (const CellObjectCut& object : cut) seen.emplace_back(object.triangles.size(), false);
  for_each_view(cell, near, eyes, [&](const View& view) {
    scene.draw(view, [&](std::size_t i) -> const std::vector<Triangle>& { return cut[i].triangles; });
    for (const std::uint32_t item : scene.items())
      if (item != no_item) seen[scene.object_of(item)][scene.triangle_of(item)] = true;
  });
  std::size_t count = 0;
  for (const auto& object : seen) count += static_cast<std::size_t>(std::count(object.begin(), object.end(), true));
  return count;
}

EyeModel cube_eyes(double image_size, double near) { return {image_size / 2.0, std::sqrt(1.0 / 3.0), near, 0.0}; }

}  // namespace occlod::tool
