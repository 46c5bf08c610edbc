#include "gl/hlod_target.h"

#include <array>
#include <cstddef>
#include <glm/common.hpp>
#include <string>

#include "occlod/core/error.h"
#include "scene/color.h"

namespace occlod::gl {
namespace {

std::size_t pixel_count(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

// OpenGL's rows run from the bottom.
std::size_t from_bottom(std::size_t row, int height) { return static_cast<std::size_t>(height) - 1 - row; }

glm::u8vec4 background(std::size_t row, int height) {
  constexpr glm::vec3 top{0.33F, 0.41F, 0.52F};
  constexpr glm::vec3 bottom{0.80F, 0.83F, 0.86F};
  return picture::to_srgb(glm::mix(top, bottom, (static_cast<float>(row) + 0.5F) / static_cast<float>(height)));
}

// As DepthBuffer has it, from a depth in [0, 1].
float nearness(const Camera& camera, float depth) {
  if (depth >= 1.0F) return 0.0F;
  if (camera.orthographic_height) return 1.0F - depth;
  return static_cast<float>((camera.far - depth * (camera.far - camera.near)) / (camera.far * camera.near));
}

}  // namespace

HlodTarget::HlodTarget(const Functions& gl, int samples) : gl_(&gl), samples_(samples), drawn_(gl) {
  if (samples == 1) return;
  GLint most = 0;
  gl.GetIntegerv(GL_MAX_SAMPLES, &most);
  check(gl, "image");
  if (most < samples)
    throw Error({"gl device", "quality",
                 "needs " + std::to_string(samples) + " samples a pixel, and the driver has " + std::to_string(most),
                 "use another driver, or draw without quality"});
  resolved_.emplace(gl);
}

void HlodTarget::begin(const View& view) {
  camera_ = view.camera();
  const int width = camera_.width;
  const int height = camera_.height;
  if (width != width_ || height != height_) {
    require_size(width, height);
    width_ = width;
    height_ = height;
    if (resolved_) allocate(*resolved_, 1);
    allocate(drawn_, samples_);
  }
  gl_->BindFramebuffer(GL_FRAMEBUFFER, drawn_.framebuffer.id());
  gl_->DrawBuffer(GL_COLOR_ATTACHMENT0);
  gl_->Viewport(0, 0, width, height);
  gl_->Disable(GL_SCISSOR_TEST);
  gl_->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_->DepthMask(GL_TRUE);
  constexpr std::array<GLfloat, 4> nothing{};
  constexpr GLfloat farthest = 1.0F;
  gl_->ClearBufferfv(GL_COLOR, 0, nothing.data());
  gl_->ClearBufferfv(GL_DEPTH, 0, &farthest);
}

void HlodTarget::require_size(int width, int height) const {
  GLint largest = 0;
  gl_->GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  check(*gl_, "image");
  if (width > largest || height > largest)
    throw Error({"OpenGL", "image", "the driver holds at most " + std::to_string(largest) + " pixels a side",
                 "use a smaller image, or the software device"});
}

void HlodTarget::allocate(const Storage& storage, int samples) const {
  const auto attach = [&](const Renderbuffer& buffer, GLenum format, GLenum attachment) {
    gl_->BindRenderbuffer(GL_RENDERBUFFER, buffer.id());
    gl_->RenderbufferStorageMultisample(GL_RENDERBUFFER, samples > 1 ? samples : 0, format, width_, height_);
    gl_->FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer.id());
  };
  gl_->BindFramebuffer(GL_FRAMEBUFFER, storage.framebuffer.id());
  attach(storage.color, GL_RGBA8, GL_COLOR_ATTACHMENT0);
  attach(storage.depth, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT);
  const GLenum status = gl_->CheckFramebufferStatus(GL_FRAMEBUFFER);
  check(*gl_, "image");
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw Error({"OpenGL", "image",
                 "the driver refuses " + std::to_string(width_) + " x " + std::to_string(height_) + " pixels with " +
                     std::to_string(samples) + (samples == 1 ? " sample" : " samples"),
                 "use a smaller image, or the software device"});
}

void HlodTarget::read(GLbitfield what, GLenum format, GLenum type, void* pixels) const {
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, drawn_.framebuffer.id());
  gl_->ReadBuffer(GL_COLOR_ATTACHMENT0);
  if (resolved_) {
    gl_->Disable(GL_SCISSOR_TEST);
    gl_->BindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_->framebuffer.id());
    gl_->BlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, what, GL_NEAREST);
    gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, resolved_->framebuffer.id());
    gl_->ReadBuffer(GL_COLOR_ATTACHMENT0);
    gl_->BindFramebuffer(GL_DRAW_FRAMEBUFFER, drawn_.framebuffer.id());
  }
  gl_->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  gl_->PixelStorei(GL_PACK_ALIGNMENT, 4);
  for (const int skip : {GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS})
    gl_->PixelStorei(static_cast<GLenum>(skip), 0);
  gl_->ReadPixels(0, 0, width_, height_, format, type, pixels);
  check(*gl_, "reading an image");
}

Image HlodTarget::read_image() const {
  std::vector<glm::u8vec4> found(pixel_count(width_, height_));
  read(GL_COLOR_BUFFER_BIT, GL_RGBA, GL_UNSIGNED_BYTE, found.data());
  Image image{width_, height_, {}};
  image.pixels.reserve(found.size());
  const auto width = static_cast<std::size_t>(width_);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height_); ++y) {
    const glm::vec4 behind(background(y, height_));
    for (std::size_t x = 0; x < width; ++x) {
      // What is drawn has been multiplied by its share of the pixel.
      const glm::vec4 drawn(found[from_bottom(y, height_) * width + x]);
      const glm::vec4 mixed = drawn + behind * (1.0F - drawn.w / 255.0F);
      image.pixels.emplace_back(glm::u8vec4(glm::vec3(mixed) + 0.5F, 255));
    }
  }
  return image;
}

DepthBuffer HlodTarget::read_depth() const {
  std::vector<GLfloat> found(pixel_count(width_, height_));
  read(GL_DEPTH_BUFFER_BIT, GL_DEPTH_COMPONENT, GL_FLOAT, found.data());
  DepthBuffer depth;
  depth.reset(width_, height_);
  const auto width = static_cast<std::size_t>(width_);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height_); ++y)
    for (std::size_t x = 0; x < width; ++x)
      depth.nearness[y * width + x] = nearness(camera_, found[from_bottom(y, height_) * width + x]);
  return depth;
}

}  // namespace occlod::gl
