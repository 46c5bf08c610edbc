#include "occlod/gl/compute_occlusion.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "hlod/draw/clip_matrix.h"
#include "gl/backend_options.h"
#include "gl/batched_visibility.h"
#include "gl/gpu_pyramid.h"
#include "gl/in_context.h"
#include "gl/objects.h"
#include "gl/occluder_mesh.h"
#include "raster/screen_bounds.h"

namespace occlod::gl {
namespace {

// One invocation a question: from the level where the rectangle meets at most three texels in each direction down, in
// the order of a Z curve, without a stack. llvmpipe leaves every loop after 65,535 rounds: a test that would come near
// that says visible before.
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

// The groups of one column share a question, and their invocations its rectangle's pixels.
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

// As std430 lays it out.
struct Question {
  std::array<std::int32_t, 4> rect;
  float nearest;
  std::array<float, 3> padding{};
};
static_assert(sizeof(Question) == 32);

// Groups in one dispatch that every driver takes.
constexpr std::size_t most_groups = 65'535;
// Pixels that one group counts at most: half of llvmpipe's rounds.
constexpr std::uint32_t pixels_per_group = 64 * 32'768;

// Everything that lives in the context.
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
  for (std::size_t first = 0; first < asked; first += most_groups) {
    gl.Uniform1ui(program.uniform("first_question"), static_cast<GLuint>(first));
    gl.DispatchCompute(static_cast<GLuint>(std::min(asked - first, most_groups)), 1 + pixels / pixels_per_group, 1);
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
  std::vector<glm::dmat4> object_to_clip_;  // of the occluder
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

}  // namespace occlod::gl
