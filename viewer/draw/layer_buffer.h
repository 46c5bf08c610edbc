// Holds the images of a mesh's materials in OpenGL.
#pragma once

#include "gl/objects.h"
#include "layered_texture.h"

namespace occlod::viewer {

class LayerBuffer {
 public:
  // Uploads them with mipmaps.
  LayerBuffer(const gl::Functions& gl, const LayeredTexture& texture);
  void bind() const;  // to texture unit 1, which MeshProgram reads
  [[nodiscard]] bool from_below() const noexcept { return from_below_; }

 private:
  const gl::Functions* gl_;
  gl::Texture texture_;
  bool from_below_;
};

}  // namespace occlod::viewer
