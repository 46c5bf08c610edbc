#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "gl/backend.h"
#include "gl/backend_options.h"
#include "gl/objects.h"
#include "gl/proxy_stage.h"
#include "hlod/draw/box_proxy.h"
#include "occlod/gl.h"
#include "raster/screen_bounds.h"

namespace occlod::gl {
namespace {

// Stores the depth pyramid of the software backend in a storage buffer: levels of farthest nearness, finest first.

// Lives in a context of OpenGL 4.3 that must be current in every call.
class GpuPyramid {
 public:
  explicit GpuPyramid(const Functions& gl);

  // Draws the occluder into an image of this size, rows from the top, and reduces it until one texel is left. Odd sizes
  // round up.
  void build(const OccluderMesh& occluder, const View& view);
  // Binds the texels to a storage buffer and sets the array of ivec2 with (first texel, width) of each level.
  void use(GLuint binding, GLint levels_uniform) const;

 private:
  struct Level {
    GLint first = 0;  // index of its first texel
    GLint width = 0;
    GLint height = 0;
  };
  void lay_out(int width, int height);
  void draw(const OccluderMesh& occluder, bool orthographic) const;
  void copy_finest() const;
  void reduce() const;

  const Functions* gl_;
  FloatTarget target_;
  Program draw_;
  Program reduce_;
  OccluderBuffer occluder_;
  Buffer texels_;
  std::vector<Level> levels_;
};

constexpr const char* draw_vertex = R"(#version 330 core
layout(location = 0) in vec4 position;
void main() { gl_Position = vec4(position.x, -position.y, position.zw); }
)";

// The rasteriser may move a surface by 1/256 pixel, and the last bits of 1 / w and z depend on the driver. So surfaces
// are pushed away by 1/64 of the depth that one pixel spans plus four steps of a float.
constexpr const char* draw_fragment = R"(#version 330 core
uniform bool orthographic;
out float nearness;
void main() {
  float at = orthographic ? 1.0 - gl_FragCoord.z : gl_FragCoord.w;
  float rounding = (orthographic ? 1.0 : at) / 4194304.0;
  nearness = max(at - (abs(dFdx(at)) + abs(dFdy(at))) / 64.0 - rounding, 0.0);
}
)";

// Reduces one level from the finer one, whose last column or row may be missing.
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

// Blending keeps the nearest value instead of a depth buffer, at full precision at any distance.
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

// Runs one invocation per query. It descends from the level where the rectangle meets at most three texels in each
// direction, in Z order, without a stack. llvmpipe leaves every loop after 65,535 iterations, so a test that comes near
// that limit returns visible before.
constexpr const char* test_source = R"(#version 430 core
layout(local_size_x = 64) in;
struct Question { ivec4 rect; float nearest; };
layout(std430, binding = 0) readonly buffer Pyramid { float texels[]; };
layout(std430, binding = 1) readonly buffer Questions { Question questions[]; };
layout(std430, binding = 2) writeonly buffer Answers { uint answers[]; };
uniform uint question_count;
uniform ivec2 levels[16];  // first texel, width

bool visible(ivec4 rect, float nearest) {
  ivec2 size = rect.zw - rect.xy;
  int top = 0;
  while ((max(size.x, size.y) >> top) > 2) ++top;
  ivec2 first = rect.xy >> top;
  ivec2 last = (rect.zw - 1) >> top;
  ivec2 start = first;
  ivec2 at = start;
  int level = top;
  for (int i = 0; i < 16384; ++i) {
    ivec2 low = at << level;
    ivec2 high = (at + 1) << level;
    bool apart = any(greaterThanEqual(low, rect.zw)) || any(lessThanEqual(high, rect.xy));
    if (!apart && texels[levels[level].x + at.y * levels[level].y + at.x] <= nearest) {
      if (level == 0 || (all(greaterThanEqual(low, rect.xy)) && all(lessThanEqual(high, rect.zw)))) return true;
      --level;
      at *= 2;
      continue;
    }
    while (level < top && all(equal(at & 1, ivec2(1)))) {
      at >>= 1;
      ++level;
    }
    if (level < top) {
      at += (at.x & 1) == 0 ? ivec2(1, 0) : ivec2(-1, 1);
    } else {
      start = start.x < last.x ? start + ivec2(1, 0) : ivec2(first.x, start.y + 1);
      if (start.y > last.y) return false;
      at = start;
    }
  }
  return true;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < question_count) answers[i] = visible(questions[i].rect, questions[i].nearest) ? 1u : 0u;
}
)";

// The workgroups of one column share a query; their invocations share the pixels of its rectangle.
constexpr const char* count_source = R"(#version 430 core
layout(local_size_x = 64) in;
struct Question { ivec4 rect; float nearest; };
layout(std430, binding = 0) readonly buffer Pyramid { float texels[]; };
layout(std430, binding = 1) readonly buffer Questions { Question questions[]; };
layout(std430, binding = 2) buffer Answers { uint answers[]; };
uniform ivec2 levels[16];
uniform uint first_question;
void main() {
  uint question = first_question + gl_WorkGroupID.x;
  ivec4 rect = questions[question].rect;
  float nearest = questions[question].nearest;
  int width = rect.z - rect.x;
  int area = width * (rect.w - rect.y);
  int step = int(64u * gl_NumWorkGroups.y);
  uint count = 0u;
  for (int i = int(gl_LocalInvocationIndex + 64u * gl_WorkGroupID.y); i < area; i += step)
    if (texels[(rect.y + i / width) * levels[0].y + rect.x + i % width] <= nearest) ++count;
  if (count > 0u) atomicAdd(answers[question], count);
}
)";

// Follows the std430 layout.
struct Question {
  std::array<std::int32_t, 4> rect;
  float nearest;
  std::array<float, 3> padding{};
};
static_assert(sizeof(Question) == 32);

// Number of workgroups in one dispatch that every driver supports.
constexpr std::size_t max_groups = 65'535;
// Number of pixels that one workgroup counts at most: half of llvmpipe's loop iterations.
constexpr std::uint32_t pixels_per_group = 64 * 32'768;

// Owns everything that lives in the context.
struct Resources {
  Resources(const Functions& functions, bool counts)
      : gl(functions),
        pyramid(functions),
        program(functions, {{GL_COMPUTE_SHADER, counts ? count_source : test_source}}),
        questions(functions),
        answers(functions) {
    check(functions, "set-up of compute shaders");
  }
  void test(std::size_t asked) const;
  void count(std::size_t asked, std::uint32_t pixels) const;  // pixels: of the image

  const Functions& gl;
  GpuPyramid pyramid;
  Program program;
  Buffer questions;
  Buffer answers;
};

void Resources::test(std::size_t asked) const {
  gl.Uniform1ui(program.uniform("question_count"), static_cast<GLuint>(asked));
  gl.DispatchCompute(static_cast<GLuint>((asked + 63) / 64), 1, 1);
}

void Resources::count(std::size_t asked, std::uint32_t pixels) const {
  for (std::size_t first = 0; first < asked; first += max_groups) {
    gl.Uniform1ui(program.uniform("first_question"), static_cast<GLuint>(first));
    gl.DispatchCompute(static_cast<GLuint>(std::min(asked - first, max_groups)), 1 + pixels / pixels_per_group, 1);
  }
}

std::uint32_t area(const PixelRect& rect) {
  return static_cast<std::uint32_t>(rect.x1 - rect.x0) * static_cast<std::uint32_t>(rect.y1 - rect.y0);
}

class ComputeOcclusion final : public BatchedVisibility {
 public:
  ComputeOcclusion(std::shared_ptr<Context> context, const ComputeOcclusionOptions& options)
      : BatchedVisibility(options.flight),
        resources_(std::move(context), options.count_pixels),
        counts_(options.count_pixels) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "gl-compute"; }

 protected:
  void start_view(const View& view, std::span<const ObjectView> objects) override {
    view_ = view;
    objects_.assign(objects.begin(), objects.end());
    object_to_clip_ = clip_matrices(view.camera(), objects);
    questions_.clear();
    occluder_drawn_ = false;
  }
  void start_occluder(std::span<const OccluderPart> parts) override {
    mesh_.assign(parts, object_to_clip_);
    resources_.use().pyramid.build(mesh_, *view_);
    occluder_drawn_ = true;
  }
  [[nodiscard]] std::optional<std::uint32_t> ask(const VisibilityQuery& query) override;
  void answer_all(std::vector<std::uint32_t>& answers) override;

 private:
  [[nodiscard]] std::uint32_t image_area() const { return area({0, 0, view_->width(), view_->height()}); }

  InContext<Resources> resources_;
  bool counts_;
  std::optional<View> view_;
  std::vector<ObjectView> objects_;
  std::vector<glm::dmat4> object_to_clip_;  // per object of the occluder
  OccluderMesh mesh_;
  bool occluder_drawn_ = false;
  std::vector<Question> questions_;
};

std::optional<std::uint32_t> ComputeOcclusion::ask(const VisibilityQuery& query) {
  const std::optional<ScreenBounds> bounds = screen_bounds(*view_, objects_[query.object], query);
  const std::uint32_t most = bounds ? area(bounds->rect) : image_area();
  if (!bounds || most == 0 || !occluder_drawn_) return counts_ ? most : std::min(most, 1U);
  const PixelRect& rect = bounds->rect;
  questions_.push_back({{rect.x0, rect.y0, rect.x1, rect.y1}, bounds->largest_nearness});
  return std::nullopt;
}

void ComputeOcclusion::answer_all(std::vector<std::uint32_t>& answers) {
  const Resources& resources = resources_.use();
  const Functions& gl = resources.gl;
  gl.UseProgram(resources.program.id());
  resources.pyramid.use(0, resources.program.uniform("levels"));
  gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, resources.questions.id());
  fill(gl, GL_SHADER_STORAGE_BUFFER, std::span<const Question>(questions_), GL_STREAM_DRAW);
  gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, resources.answers.id());
  answers.assign(questions_.size(), 0);
  fill(gl, GL_SHADER_STORAGE_BUFFER, std::span<const std::uint32_t>(answers), GL_DYNAMIC_READ);
  if (counts_)
    resources.count(questions_.size(), image_area());
  else
    resources.test(questions_.size());
  read_back(gl, std::span(answers), "testing bounds");
  questions_.clear();
}

}  // namespace

std::unique_ptr<Visibility> make_compute_occlusion(std::shared_ptr<Context> context,
                                                   const ComputeOcclusionOptions& options) {
  require_options(context.get(), options.flight, 1, "gl-compute");
  require_version(context->functions(), 43, "gl-compute");
  return std::make_unique<ComputeOcclusion>(std::move(context), options);
}

std::unique_ptr<Visibility> make_compute_occlusion(std::shared_ptr<Context> context) {
  return make_compute_occlusion(std::move(context), ComputeOcclusionOptions{});
}

}  // namespace occlod::gl
