#include "render_target.h"

#include <algorithm>

#include "occlod/base.h"

namespace occlod::viewer {

RenderTarget::RenderTarget(const gl::Functions& gl)
    : gl_(&gl), drawn_(gl), finished_(gl), color_(gl), depth_(gl), texture_(gl) {}

void RenderTarget::begin(int width, int height, int samples) {
  if (width != width_ || height != height_ || samples != samples_) {
    width_ = width;
    height_ = height;
    samples_ = samples;
    allocate();
  }
  gl_->BindFramebuffer(GL_FRAMEBUFFER, drawn_.id());
  gl_->Viewport(0, 0, width_, height_);
}

void RenderTarget::allocate() {
  const gl::Functions& gl = *gl_;
  gl.BindFramebuffer(GL_FRAMEBUFFER, drawn_.id());
  const int stored = samples_ > 1 ? samples_ : 0;
  gl.BindRenderbuffer(GL_RENDERBUFFER, color_.id());
  gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, stored, GL_RGBA8, width_, height_);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_.id());
  gl.BindRenderbuffer(GL_RENDERBUFFER, depth_.id());
  gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, stored, GL_DEPTH_COMPONENT24, width_, height_);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.id());
  const bool complete = gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;

  gl.BindFramebuffer(GL_FRAMEBUFFER, finished_.id());
  gl.BindTexture(GL_TEXTURE_2D, texture_.id());
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width_, height_, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_.id(), 0);
  if (complete && gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE) return;
  check(gl, "picture");
  throw Error({"OpenGL", std::to_string(width_) + "x" + std::to_string(height_) + " pixels",
               "the driver has no such picture", "use a smaller one"});
}

void RenderTarget::finish() const {
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, drawn_.id());
  gl_->BindFramebuffer(GL_DRAW_FRAMEBUFFER, finished_.id());
  gl_->BlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  gl_->BindFramebuffer(GL_FRAMEBUFFER, 0);
}

Image RenderTarget::read() const {
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, finished_.id());
  gl_->ReadBuffer(GL_COLOR_ATTACHMENT0);
  Image image = read_pixels(*gl_, 0, 0, width_, height_);
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  return image;
}

Image read_pixels(const gl::Functions& gl, int x, int y, int width, int height) {
  Image image{width, height, {}};
  image.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl.ReadPixels(x, y, width, height, GL_RGBA, GL_UNSIGNED_BYTE, image.pixels.data());
  check(gl, "reading a picture");
  for (int row = 0; row < height / 2; ++row)
    std::swap_ranges(image.pixels.begin() + static_cast<std::ptrdiff_t>(row) * width,
                     image.pixels.begin() + static_cast<std::ptrdiff_t>(row + 1) * width,
                     image.pixels.begin() + static_cast<std::ptrdiff_t>(height - 1 - row) * width);
  for (glm::u8vec4& pixel : image.pixels) pixel.w = 255;
  return image;
}

}  // namespace occlod::viewer
