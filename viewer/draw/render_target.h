// A picture in the making: colour and depth, with or without several samples a pixel, and the texture that comes of it.
#pragma once

#include "gl/objects.h"
#include "occlod/picture.h"

namespace occlod::viewer {

class RenderTarget {
 public:
  explicit RenderTarget(const gl::Functions& gl);

  // Binds it for drawing with this size in pixels, 1 or more samples. Throws Error when the driver has no room for it.
  void begin(int width, int height, int samples);
  // The picture is done: texture() shows it.
  void finish() const;
  [[nodiscard]] GLuint texture() const noexcept { return texture_.id(); }
  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  // Rows from the top.
  [[nodiscard]] Image read() const;

 private:
  using Renderbuffer = gl::Object<&gl::Functions::GenRenderbuffers, &gl::Functions::DeleteRenderbuffers>;
  void allocate();

  const gl::Functions* gl_;
  gl::Framebuffer drawn_;
  gl::Framebuffer finished_;
  Renderbuffer color_;
  Renderbuffer depth_;
  gl::Texture texture_;
  int width_ = 0;
  int height_ = 0;
  int samples_ = 0;
};

// What the bound read framebuffer shows, its lower left corner at (x, y); rows from the top.
[[nodiscard]] Image read_pixels(const gl::Functions& gl, int x, int y, int width, int height);

}  // namespace occlod::viewer
