#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "occlod/picture.h"
#include "scene/color.h"
#include "scene/frustum_edges.h"
#include "scene/shading.h"

namespace occlod::picture {
namespace {

// Draws lines over a picture.

struct Pen {
  glm::vec3 color;  // linear
  float opacity = 1.0F;
  float width_px = 2.0F;
};

// Clips a segment in clip space at the near plane; returns false when nothing is left.
bool clip_near(glm::dvec4& a, glm::dvec4& b) {
  const double da = a.z + a.w;
  const double db = b.z + b.w;
  if (da < 0.0 && db < 0.0) return false;
  const glm::dvec4 cut = a + da / (da - db) * (b - a);
  if (da < 0.0) a = cut;
  if (db < 0.0) b = cut;
  return a.w > 0.0 && b.w > 0.0;
}

glm::dvec2 to_pixels(const glm::dvec4& clip, const Image& image) {
  return (glm::dvec2(clip.x, -clip.y) / clip.w * 0.5 + 0.5) * glm::dvec2(image.width, image.height);
}

void blend(glm::u8vec4& pixel, const Pen& pen, float coverage) {
  pixel = to_srgb(glm::mix(to_linear(pixel), pen.color, pen.opacity * coverage));
}

// Walks along the longer axis, called `major`, and covers the pixels across it by their distance to the line.
void draw_segment(Image& image, const glm::dvec2& a, const glm::dvec2& b, const Pen& pen) {
  const int major = std::abs(b.x - a.x) >= std::abs(b.y - a.y) ? 0 : 1;
  const int minor = 1 - major;
  const glm::ivec2 size(image.width, image.height);
  const auto [start, end] = std::minmax(a[major], b[major]);
  const double slope = a[major] == b[major] ? 0.0 : (b[minor] - a[minor]) / (b[major] - a[major]);
  const double across = std::sqrt(1.0 + slope * slope);  // pixels along the minor axis per pixel of distance
  const double reach = (pen.width_px / 2.0 + 0.5) * across;
  const auto first = static_cast<int>(std::clamp(std::floor(start), 0.0, static_cast<double>(size[major])));
  const auto last = static_cast<int>(std::clamp(std::ceil(end), 0.0, static_cast<double>(size[major])));
  for (int i = first; i < last; ++i) {
    const double middle = a[minor] + slope * (i + 0.5 - a[major]);
    const auto low = static_cast<int>(std::clamp(std::floor(middle - reach), 0.0, static_cast<double>(size[minor])));
    const auto high = static_cast<int>(std::clamp(std::ceil(middle + reach), 0.0, static_cast<double>(size[minor])));
    for (int j = low; j < high; ++j) {
      const double distance = std::abs(j + 0.5 - middle) / across;
      const auto coverage = static_cast<float>(std::clamp(pen.width_px / 2.0 + 0.5 - distance, 0.0, 1.0));
      const auto x = static_cast<std::size_t>(major == 0 ? i : j);
      const auto y = static_cast<std::size_t>(major == 0 ? j : i);
      blend(image.pixels[y * static_cast<std::size_t>(image.width) + x], pen, coverage);
    }
  }
}

// Draws an antialiased line between two points in world space over everything in the picture; the part in front of the
// near plane of `view` is left out.
void draw_line(Image& image, const View& view, const glm::dvec3& from, const glm::dvec3& to, const Pen& pen) {
  glm::dvec4 a = view.world_to_clip() * glm::dvec4(from, 1.0);
  glm::dvec4 b = view.world_to_clip() * glm::dvec4(to, 1.0);
  if (clip_near(a, b)) draw_segment(image, to_pixels(a, image), to_pixels(b, image), pen);
}

}  // namespace

}  // namespace occlod::picture

namespace occlod {
namespace {

// Returns the corners of the boxes of all objects, in world space.
std::vector<glm::dvec3> scene_corners(std::span<const DrawObject> objects) {
  std::vector<glm::dvec3> corners;
  for (const DrawObject& object : objects) {
    if (object.positions.empty()) continue;
    const Box box = bounding_box(object.positions);
    for (int i = 0; i < 8; ++i) corners.emplace_back(object.object_to_world * glm::dvec4(corner(box, i), 1.0));
  }
  return corners;
}

// Returns the length at which the frustum is drawn: to the farthest part of the scene, or to the far plane when nothing
// of the scene lies ahead.
double frustum_length(std::span<const glm::dvec3> corners, const View& view) {
  double farthest = 0.0;
  for (const glm::dvec3& p : corners) farthest = std::max(farthest, glm::dot(p - view.camera().eye, view.direction()));
  return farthest > 0.0 ? std::min(farthest, view.camera().far) : view.camera().far;
}

void draw_frustum(Image& image, const View& view, const View& main_view, double length) {
  const picture::Pen pen{{0.95F, 0.72F, 0.05F}, 0.9F, 2.0F};
  for (const auto& [from, to] : picture::frustum_edges(main_view, length))
    picture::draw_line(image, view, from, to, pen);
}

// The main eye is at the bottom of the picture, so the light comes from there and shines on what it sees.
constexpr picture::Style dark_style{.background_top = {0.045F, 0.055F, 0.075F},
                                    .background_bottom = {0.10F, 0.115F, 0.14F},
                                    .key_light = {-0.35, -0.55, 0.75}};

void draw_box(Image& image, const View& view, const DrawObject& object, const MarkedObject& mark) {
  const picture::Pen pen{glm::mix(mark.color, glm::vec3(1.0F), 0.25F), 0.8F, 1.0F};
  const auto at = [&](int i) { return glm::dvec3(object.object_to_world * glm::dvec4(corner(mark.box, i), 1.0)); };
  for (int i = 0; i < 8; ++i)
    for (int axis = 1; axis < 8; axis *= 2)  // bits of a corner's number give its sides
      if ((i & axis) == 0) picture::draw_line(image, view, at(i), at(i | axis), pen);
}

}  // namespace

Image birdseye(std::span<const DrawObject> objects, const ItemBuffer& main_items, const View& main_view,
               const View& view) {
  ItemBuffer items;
  draw_items(items, objects, view);
  const std::vector<bool> visible = visible_items(main_items, picture::ItemTable(objects).size());
  const glm::vec3 seen(0.82F, 0.42F, 0.12F);
  const glm::vec3 unseen(0.06F, 0.11F, 0.22F);
  Image image = picture::shade_items(items, objects, view, dark_style,
                                     [&](std::uint32_t item, const picture::ItemTable::Owner&) -> picture::ItemColor {
                                       return visible[item] ? seen : unseen;
                                     });
  draw_frustum(image, view, main_view, frustum_length(scene_corners(objects), main_view));
  return image;
}

Image birdseye_boxes(std::span<const DrawObject> objects, std::span<const MarkedObject> marks, const View& main_view,
                     const View& view) {
  assert(objects.size() == marks.size());
  ItemBuffer items;
  draw_items(items, objects, view);
  Image image = picture::shade_items(items, objects, view, dark_style,
                                     [&](std::uint32_t, const picture::ItemTable::Owner& owner) -> picture::ItemColor {
                                       return marks[static_cast<std::size_t>(owner.object - objects.data())].color;
                                     });
  for (std::size_t i = 0; i < objects.size(); ++i) draw_box(image, view, objects[i], marks[i]);
  draw_frustum(image, view, main_view, frustum_length(scene_corners(objects), main_view));
  return image;
}

Camera birdseye_camera(std::span<const DrawObject> objects, const View& main_view) {
  const Camera& main = main_view.camera();
  std::vector<glm::dvec3> points = scene_corners(objects);
  points.push_back(main.eye);
  const glm::dvec3 up = glm::normalize(main.up);
  const glm::dvec3 right = glm::normalize(glm::cross(main_view.direction(), up));
  const glm::dvec3 ahead = glm::cross(up, right);  // up in the picture

  // Extents along the three axes of the camera, relative to the main eye.
  glm::dvec3 low(0.0), high(0.0);
  for (const glm::dvec3& p : points) {
    const glm::dvec3 d = p - main.eye;
    const glm::dvec3 local(glm::dot(d, right), glm::dot(d, ahead), glm::dot(d, up));
    low = glm::min(low, local);
    high = glm::max(high, local);
  }
  const glm::dvec3 size = high - low;
  const double largest = std::max({size.x, size.y, size.z});
  const double scale = largest > 0.0 ? largest : 1.0;

  Camera camera;
  camera.width = main.width;
  camera.height = main.height;
  camera.fov_y_deg = 30.0;
  const double half_tangent = std::tan(glm::radians(camera.fov_y_deg) / 2.0);
  const double half_height = std::max(size.y, size.x * camera.height / camera.width) / 2.0;
  // The whole box fits when its top does; a margin of a twentieth is left around it.
  const double distance = std::max(1.05 * half_height / half_tangent, 0.05 * scale);
  const glm::dvec3 middle = (low + high) / 2.0;
  camera.target = main.eye + middle.x * right + middle.y * ahead + middle.z * up;
  camera.eye = camera.target + (size.z / 2.0 + distance) * up;
  camera.up = ahead;
  camera.near = distance / 2.0;
  camera.far = 1.5 * (distance + size.z);
  return camera;
}

}  // namespace occlod

namespace occlod::picture {

std::vector<std::array<glm::dvec3, 2>> frustum_edges(const View& view, double length) {
  const Camera& camera = view.camera();
  const glm::dvec3 right = glm::normalize(glm::cross(view.direction(), camera.up));
  const glm::dvec3 up = glm::cross(right, view.direction());
  const glm::dvec2 half = glm::dvec2(camera.width, camera.height) / (2.0 * view.focal_length_px());
  const glm::dvec2 low = (-1.0 - camera.principal_point) * half, high = (1.0 - camera.principal_point) * half;
  const std::array<glm::dvec3, 4> to_corners = {low.x * right + low.y * up, high.x * right + low.y * up,
                                                high.x * right + high.y * up, low.x * right + high.y * up};
  const bool parallel = view.is_orthographic();
  const auto corner = [&](std::size_t i, double distance) {
    return camera.eye + distance * view.direction() + (parallel ? 1.0 : distance) * to_corners[i % 4];
  };
  std::vector<std::array<glm::dvec3, 2>> edges;
  for (std::size_t i = 0; i < 4; ++i) {
    edges.push_back({corner(i, 0.0), corner(i, length)});
    edges.push_back({corner(i, length), corner(i + 1, length)});
    if (parallel) edges.push_back({corner(i, 0.0), corner(i + 1, 0.0)});
  }
  return edges;
}

}  // namespace occlod::picture
