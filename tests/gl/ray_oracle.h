// What a bound's answer must be, by casting rays through pixels on the CPU.
#pragma once

#include <limits>
#include <random>
#include <vector>

#include "gl/support.h"

namespace occlod::gl {

// Depths (distance along the axis) of the occluder around each pixel's centre: the rasteriser may move an edge by 1/256
// pixel, so a few rays 1/64 pixel apart give the nearest and farthest that it can have drawn.
struct RayDepth {
  double nearest = std::numeric_limits<double>::infinity();
  double farthest = 0.0;  // infinite where some ray misses
};

class RayImage {
 public:
  RayImage(const View& view, const Soup& occluder, const glm::dmat4& object_to_world);
  // GL's pixels: y upwards.
  [[nodiscard]] const RayDepth& at(int x, int y) const { return pixels_[index(x, y)]; }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(view_.width()) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] RayDepth depths(const Soup& occluder, double x, double y) const;
  [[nodiscard]] double cast(const Soup& occluder, const glm::dvec2& pixel) const;

  View view_;
  std::vector<glm::dvec3> world_;
  std::vector<RayDepth> pixels_;
};

struct Verdict {
  bool must_be_visible = false;
  bool must_be_hidden = false;
};

// Visible for certain: some point of the bound is no farther than anything that can have been drawn at the centre of
// its pixel. Hidden for certain: over all pixels near the bound the occluder is nearer than any point of it, with room
// for a proxy that is wider and nearer than it.
[[nodiscard]] Verdict verdict(const View& view, const RayImage& image, const VisibilityQuery& query,
                              const glm::dmat4& object_to_world, std::mt19937& random);

// A random occluder, a random placement and random bounds of one kind among it: a third touches it.
class RandomScene {
 public:
  RandomScene(const View& view, std::mt19937& random);

  [[nodiscard]] const Soup& soup() const { return soup_; }  // object space
  [[nodiscard]] const glm::dmat4& transform() const { return transform_; }
  [[nodiscard]] VisibilityQuery next_bound(ProxyShape shape);
  [[nodiscard]] Verdict verdict(const VisibilityQuery& query) {
    return gl::verdict(view_, image_, query, transform_, random_);
  }

 private:
  View view_;
  std::mt19937& random_;
  glm::dmat4 transform_;
  glm::dmat4 to_object_;
  Soup world_;
  Soup soup_;
  RayImage image_;
  int bounds_ = 0;
};

}  // namespace occlod::gl
