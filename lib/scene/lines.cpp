#include "scene/lines.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <utility>

#include "scene/color.h"

namespace occlod::picture {
namespace {

// Cuts a segment in clip space at the near plane; false when all of it lies before.
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

}  // namespace

void draw_line(Image& image, const View& view, const glm::dvec3& from, const glm::dvec3& to, const Pen& pen) {
  glm::dvec4 a = view.world_to_clip() * glm::dvec4(from, 1.0);
  glm::dvec4 b = view.world_to_clip() * glm::dvec4(to, 1.0);
  if (clip_near(a, b)) draw_segment(image, to_pixels(a, image), to_pixels(b, image), pen);
}

}  // namespace occlod::picture
