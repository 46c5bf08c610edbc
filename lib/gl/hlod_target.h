// The image that HLODs are drawn into, and how it is read.
#pragma once

#include <optional>

#include "gl/objects.h"
#include "occlod/picture/picture.h"
#include "occlod/raster/item_buffer.h"
#include "occlod/view/view.h"

namespace occlod::gl {

// Colours of 8 bits and depths of 32, with one or several samples a pixel.
class HlodTarget {
 public:
  // Throws Error when the driver has fewer samples.
  HlodTarget(const Functions& gl, int samples);
  // Makes it what is drawn into, of the view's size and empty: alpha is 0 where nothing is drawn. Throws Error for a
  // size that the driver cannot hold.
  void begin(const View& view);
  // What has been drawn, before the background of shade(). Drawing may go on.
  [[nodiscard]] Image read_image() const;
  [[nodiscard]] DepthBuffer read_depth() const;
  [[nodiscard]] int samples() const noexcept { return samples_; }

 private:
  struct Storage {
    explicit Storage(const Functions& gl) : framebuffer(gl), color(gl), depth(gl) {}
    Framebuffer framebuffer;
    Renderbuffer color;
    Renderbuffer depth;
  };
  void require_size(int width, int height) const;
  void allocate(const Storage& storage, int samples) const;
  void read(GLbitfield what, GLenum format, GLenum type, void* pixels) const;

  const Functions* gl_;
  int samples_;
  Storage drawn_;
  std::optional<Storage> resolved_;  // with several samples
  Camera camera_;
  int width_ = 0;  // of the storage
  int height_ = 0;
};

}  // namespace occlod::gl
