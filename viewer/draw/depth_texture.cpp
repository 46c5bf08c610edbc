#include "depth_texture.h"

#include <algorithm>
#include <glm/vec4.hpp>
#include <limits>
#include <vector>

namespace occlod::viewer {
namespace {

constexpr glm::u8vec4 nothing{30, 33, 40, 255};

// Near is bright, far is dark, linear in nearness between the nearest and the farthest.
std::vector<glm::u8vec4> greys(const DepthPyramid& pyramid, int level, int width, int height) {
  float low = std::numeric_limits<float>::infinity();
  float high = 0.0F;
  const auto for_each = [&](const auto& visit) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) visit(pyramid.farthest(level, x, y));
  };
  for_each([&](float nearness) {
    if (nearness > 0.0F) low = std::min(low, nearness);
    high = std::max(high, nearness);
  });
  const float span = high > low ? high - low : 1.0F;
  std::vector<glm::u8vec4> pixels;
  for_each([&](float nearness) {
    const auto grey = static_cast<std::uint8_t>(70.0F + 180.0F * std::clamp((nearness - low) / span, 0.0F, 1.0F));
    pixels.push_back(nearness > 0.0F ? glm::u8vec4(grey, grey, grey, 255) : nothing);
  });
  return pixels;
}

}  // namespace

DepthTexture::DepthTexture(const gl::Functions& gl) : gl_(&gl), texture_(gl) {
  gl.BindTexture(GL_TEXTURE_2D, texture_.id());
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

void DepthTexture::show(const std::shared_ptr<const DepthPyramid>& pyramid, int level) {
  const int last = pyramid->level_count() - 1;
  const int shown = std::min(level, last);
  if (pyramid == pyramid_ && shown == level_) return;
  pyramid_ = pyramid;
  level_ = shown;
  width_ = pyramid->width();
  height_ = pyramid->height();
  for (int i = 0; i < shown; ++i) {
    width_ = (width_ + 1) / 2;
    height_ = (height_ + 1) / 2;
  }
  const std::vector<glm::u8vec4> pixels = greys(*pyramid, shown, width_, height_);
  gl_->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  gl_->BindTexture(GL_TEXTURE_2D, texture_.id());
  gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width_, height_, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
}

}  // namespace occlod::viewer
