#include "gl/gpu_pyramid.h"

#include <array>

namespace occlod::gl {
namespace {

constexpr const char* draw_vertex = R"(#version 330 core
layout(location = 0) in vec4 position;
void main() { gl_Position = vec4(position.x, -position.y, position.zw); }
)";

// The rasteriser may move a surface by 1/256 pixel, and the last bits of 1 / w and z are the driver's own: pushed away
// by 1/64 of what one pixel spans and by four steps of a float.
constexpr const char* draw_fragment = R"(#version 330 core
uniform bool orthographic;
out float nearness;
void main() {
  float at = orthographic ? 1.0 - gl_FragCoord.z : gl_FragCoord.w;
  float rounding = (orthographic ? 1.0 : at) / 4194304.0;
  nearness = max(at - (abs(dFdx(at)) + abs(dFdy(at))) / 64.0 - rounding, 0.0);
}
)";

// One level from the one below, of which the last column or row may be missing.
constexpr const char* reduce_source = R"(#version 430 core
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = 0) buffer Pyramid { float texels[]; };
uniform ivec3 below;  // first texel, width, height
uniform ivec3 level;
void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, level.yz))) return;
  ivec2 low = 2 * at;
  ivec2 high = min(low + 1, below.yz - 1);
  int upper = below.x + low.y * below.y;
  int lower = below.x + high.y * below.y;
  texels[level.x + at.y * level.y + at.x] = min(min(texels[upper + low.x], texels[upper + high.x]),
                                                min(texels[lower + low.x], texels[lower + high.x]));
}
)";

GLuint groups(GLint size) { return static_cast<GLuint>((size + 7) / 8); }

}  // namespace

GpuPyramid::GpuPyramid(const Functions& gl)
    : gl_(&gl),
      target_(gl, FloatTarget::Kind::red),
      draw_(gl, {{GL_VERTEX_SHADER, draw_vertex}, {GL_FRAGMENT_SHADER, draw_fragment}}),
      reduce_(gl, {{GL_COMPUTE_SHADER, reduce_source}}),
      occluder_(gl),
      texels_(gl) {}

void GpuPyramid::build(const OccluderMesh& occluder, const View& view) {
  target_.bind(view.width(), view.height());
  lay_out(view.width(), view.height());
  draw(occluder, view.is_orthographic());
  copy_finest();
  reduce();
  check(*gl_, "building a depth pyramid");
}

void GpuPyramid::lay_out(int width, int height) {
  if (!levels_.empty() && levels_[0].width == width && levels_[0].height == height) return;
  levels_.clear();
  GLint size = 0;
  for (;; width = (width + 1) / 2, height = (height + 1) / 2) {
    levels_.push_back({size, width, height});
    size += width * height;
    if (width == 1 && height == 1) break;
  }
  gl_->BindBuffer(GL_SHADER_STORAGE_BUFFER, texels_.id());
  gl_->BufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(sizeof(float)) * size, nullptr, GL_DYNAMIC_COPY);
}

// No depth buffer: the nearest wins by blending, at full precision however far away it is.
void GpuPyramid::draw(const OccluderMesh& occluder, bool orthographic) const {
  gl_->Viewport(0, 0, levels_[0].width, levels_[0].height);
  for (const int capability : {GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_CULL_FACE, GL_DEPTH_TEST, GL_POLYGON_OFFSET_FILL,
                               GL_DEPTH_CLAMP, GL_COLOR_LOGIC_OP})
    gl_->Disable(static_cast<GLenum>(capability));
  gl_->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  constexpr std::array<GLfloat, 4> nothing{};
  gl_->ClearBufferfv(GL_COLOR, 0, nothing.data());
  gl_->Enable(GL_BLEND);
  gl_->BlendEquation(GL_MAX);
  gl_->UseProgram(draw_.id());
  gl_->Uniform1i(draw_.uniform("orthographic"), orthographic ? 1 : 0);
  occluder_.draw(*gl_, occluder);
  gl_->Disable(GL_BLEND);
}

void GpuPyramid::copy_finest() const {
  gl_->BindBuffer(GL_PIXEL_PACK_BUFFER, texels_.id());
  gl_->PixelStorei(GL_PACK_ALIGNMENT, 4);
  for (const int skip : {GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS})
    gl_->PixelStorei(static_cast<GLenum>(skip), 0);
  gl_->ReadPixels(0, 0, levels_[0].width, levels_[0].height, GL_RED, GL_FLOAT, nullptr);
  gl_->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
}

void GpuPyramid::reduce() const {
  gl_->UseProgram(reduce_.id());
  gl_->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, texels_.id());
  const GLint below_uniform = reduce_.uniform("below");
  const GLint level_uniform = reduce_.uniform("level");
  for (std::size_t i = 1; i < levels_.size(); ++i) {
    const Level& below = levels_[i - 1];
    const Level& level = levels_[i];
    gl_->Uniform3i(below_uniform, below.first, below.width, below.height);
    gl_->Uniform3i(level_uniform, level.first, level.width, level.height);
    gl_->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    gl_->DispatchCompute(groups(level.width), groups(level.height), 1);
  }
  gl_->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void GpuPyramid::use(GLuint binding, GLint levels_uniform) const {
  gl_->BindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, texels_.id());
  std::vector<GLint> levels;
  for (const Level& level : levels_) levels.insert(levels.end(), {level.first, level.width});
  gl_->Uniform2iv(levels_uniform, static_cast<GLsizei>(levels_.size()), levels.data());
}

}  // namespace occlod::gl
