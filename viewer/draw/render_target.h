// Holds colour and depth of a picture that is being drawn, with one or more samples per pixel, and the finished
// texture.
#pragma once

#include "gl/objects.h"
#include "occlod/picture.h"

namespace occlod::viewer {

class RenderTarget {
 public:
  explicit RenderTarget(const gl::Functions& gl);

  // Binds the target for drawing with this size in pixels, and 1 or more samples. Throws Error when the driver has no
  // memory for it.
  void begin(int width, int height, int samples);
  // Finishes the picture: texture() shows it.
  void finish() const;
  [[nodiscard]] GLuint texture() const noexcept { return texture_.id(); }
  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  // Returns the picture, with rows from the top.
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

// Reads a part of the bound read framebuffer with its lower left corner at (x, y). Rows are from the top.
[[nodiscard]] Image read_pixels(const gl::Functions& gl, int x, int y, int width, int height);

}  // namespace occlod::viewer
