// Shows one level of the occluder's depth as a grey picture.
#pragma once

#include <memory>

#include "gl/objects.h"
#include "raster/depth_pyramid.h"

namespace occlod::viewer {

class DepthTexture {
 public:
  explicit DepthTexture(const gl::Functions& gl);
  // Shows this level, or the last one where there are fewer.
  void show(const std::shared_ptr<const DepthPyramid>& pyramid, int level);
  [[nodiscard]] GLuint texture() const noexcept { return texture_.id(); }
  [[nodiscard]] int level() const noexcept { return level_; }
  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }

 private:
  const gl::Functions* gl_;
  gl::Texture texture_;
  std::shared_ptr<const DepthPyramid> pyramid_;
  int level_ = -1;
  int width_ = 0;
  int height_ = 0;
};

}  // namespace occlod::viewer
