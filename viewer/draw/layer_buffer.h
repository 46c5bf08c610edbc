// Holds images of meshes in OpenGL: those of materials, and those of nodes.
#pragma once

#include "gl/objects.h"
#include "layered_texture.h"
#include "occlod/picture.h"

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

// Holds an image that a node has of its own.
class ImageBuffer {
 public:
  // Uploads it with mipmaps.
  ImageBuffer(const gl::Functions& gl, const Image& image);
  void bind() const;  // to texture unit 2, which MeshProgram reads

 private:
  const gl::Functions* gl_;
  gl::Texture texture_;
};

}  // namespace occlod::viewer
