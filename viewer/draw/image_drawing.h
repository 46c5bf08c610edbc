// Draws an image that was computed instead of a mesh.
#pragma once

#include <memory>

#include "full_mesh.h"
#include "gl/objects.h"
#include "render_target.h"

namespace occlod::viewer {

class ImageDrawing {
 public:
  explicit ImageDrawing(const gl::Functions& gl);
  // Fills the target of this size in pixels with the image, which is uploaded unless it was drawn last.
  void draw(RenderTarget& target, int width, int height, const std::shared_ptr<const DepthDifference>& difference);

 private:
  const gl::Functions* gl_;
  gl::Program program_;
  gl::VertexArray array_;
  gl::Texture texture_;
  std::shared_ptr<const DepthDifference> uploaded_;
};

}  // namespace occlod::viewer
