#include "image_drawing.h"

namespace occlod::viewer {
namespace {

constexpr const char* vertex_shader = R"(#version 330 core
out vec2 at;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  at = vec2(0.5 + 0.5 * corner.x, 0.5 - 0.5 * corner.y);  // rows are from the top
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";

constexpr const char* fragment_shader = R"(#version 330 core
in vec2 at;
uniform sampler2D image;
out vec4 target;
void main() { target = vec4(texture(image, at).rgb, 1.0); }
)";

}  // namespace

ImageDrawing::ImageDrawing(const gl::Functions& gl)
    : gl_(&gl),
      program_(gl, {{GL_VERTEX_SHADER, vertex_shader}, {GL_FRAGMENT_SHADER, fragment_shader}}),
      array_(gl),
      texture_(gl) {
  gl.BindTexture(GL_TEXTURE_2D, texture_.id());
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

void ImageDrawing::draw(RenderTarget& target, int width, int height,
                        const std::shared_ptr<const DepthDifference>& difference) {
  target.begin(width, height, 1);
  gl_->Disable(GL_DEPTH_TEST);
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, texture_.id());
  if (difference != uploaded_) {
    const Image& image = difference->image;
    gl_->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, image.width, image.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                    image.pixels.data());
    uploaded_ = difference;
  }
  gl_->UseProgram(program_.id());
  gl_->BindVertexArray(array_.id());
  gl_->DrawArrays(GL_TRIANGLES, 0, 3);
  gl_->BindVertexArray(0);
  target.finish();
}

}  // namespace occlod::viewer
