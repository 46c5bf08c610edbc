#include "layer_buffer.h"

namespace occlod::viewer {

LayerBuffer::LayerBuffer(const gl::Functions& gl, const LayeredTexture& texture)
    : gl_(&gl), texture_(gl), from_below_(texture.origin == TextureOrigin::bottom_left) {
  gl.ActiveTexture(GL_TEXTURE1);
  gl.BindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  gl.TexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_RGBA8, texture.size, texture.size,
                static_cast<GLsizei>(texture.layers.size()), 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  for (std::size_t i = 0; i < texture.layers.size(); ++i)
    gl.TexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, static_cast<GLint>(i), texture.size, texture.size, 1, GL_RGBA,
                     GL_UNSIGNED_BYTE, texture.layers[i].pixels.data());
  gl.GenerateMipmap(GL_TEXTURE_2D_ARRAY);
  gl.TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  gl.TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl.ActiveTexture(GL_TEXTURE0);
}

void LayerBuffer::bind() const {
  gl_->ActiveTexture(GL_TEXTURE1);
  gl_->BindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
  gl_->ActiveTexture(GL_TEXTURE0);
}

ImageBuffer::ImageBuffer(const gl::Functions& gl, const Image& image) : gl_(&gl), texture_(gl) {
  bind();
  gl.ActiveTexture(GL_TEXTURE2);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, image.width, image.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                image.pixels.data());
  gl.GenerateMipmap(GL_TEXTURE_2D);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  gl.ActiveTexture(GL_TEXTURE0);
}

void ImageBuffer::bind() const {
  gl_->ActiveTexture(GL_TEXTURE2);
  gl_->BindTexture(GL_TEXTURE_2D, texture_.id());
  gl_->ActiveTexture(GL_TEXTURE0);
}

}  // namespace occlod::viewer
