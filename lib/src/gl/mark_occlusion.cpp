#include "occlod/gl/mark_occlusion.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "gl/backend_options.h"
#include "gl/batched_visibility.h"
#include "gl/in_context.h"
#include "gl/objects.h"
#include "gl/proxy_stage.h"

namespace occlod::gl {
namespace {

constexpr const char* vertex_source = R"(#version 430 core
layout(location = 0) in vec3 position;
layout(location = 1) in mat4 to_clip;
layout(location = 5) in uint word;
flat out uint marked;
void main() {
  gl_Position = to_clip * vec4(position, 1.0);
  marked = word;
}
)";

// Front faces of a convex proxy cover each sample once, so additions are samples.
constexpr const char* mark_source = R"(#version 430 core
layout(early_fragment_tests) in;
layout(std430, binding = 0) buffer Marks { uint marks[]; };
flat in uint marked;
void main() { if (marks[marked] == 0u) marks[marked] = 1u; }
)";
constexpr const char* count_source = R"(#version 430 core
layout(early_fragment_tests) in;
layout(std430, binding = 0) buffer Marks { uint marks[]; };
flat in uint marked;
void main() { atomicAdd(marks[marked], 1u); }
)";

struct Instance {
  glm::mat4 to_clip;
  std::uint32_t word;  // in the storage buffer: the place of the question in its batch
};
static_assert(sizeof(Instance) == 68);

// Everything that lives in the context.
struct Resources {
  Resources(const Functions& gl, const MarkOcclusionOptions& options);
  void draw(const std::array<std::vector<Instance>, proxy_shape_count>& proxies) const;

  ProxyStage stage;
  Program program;
  Buffer instances;
  Buffer marks;
};

Resources::Resources(const Functions& gl, const MarkOcclusionOptions& options)
    : stage(gl, options.divisor),
      program(gl, {{GL_VERTEX_SHADER, vertex_source},
                   {GL_FRAGMENT_SHADER, options.count_pixels ? count_source : mark_source}}),
      instances(gl),
      marks(gl) {
  stage.proxies().bind(gl);
  gl.BindBuffer(GL_ARRAY_BUFFER, instances.id());
  const auto attribute = [](std::size_t offset) {
    return reinterpret_cast<const void*>(offset);  // NOLINT(performance-no-int-to-ptr)
  };
  for (GLuint column = 0; column < 4; ++column) {
    gl.EnableVertexAttribArray(1 + column);
    gl.VertexAttribPointer(1 + column, 4, GL_FLOAT, GL_FALSE, sizeof(Instance), attribute(column * sizeof(glm::vec4)));
    gl.VertexAttribDivisor(1 + column, 1);
  }
  gl.EnableVertexAttribArray(5);
  gl.VertexAttribIPointer(5, 1, GL_UNSIGNED_INT, sizeof(Instance), attribute(offsetof(Instance, word)));
  gl.VertexAttribDivisor(5, 1);
  check(gl, "set-up of marks");
}

void Resources::draw(const std::array<std::vector<Instance>, proxy_shape_count>& proxies) const {
  const Functions& gl = stage.gl();
  std::size_t count = 0;
  for (const auto& of_shape : proxies) count += of_shape.size();
  gl.BindBuffer(GL_ARRAY_BUFFER, instances.id());
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(count * sizeof(Instance)), nullptr, GL_STREAM_DRAW);
  std::size_t first = 0;
  for (std::size_t i = 0; i < proxy_shape_count; ++i) {
    if (proxies[i].empty()) continue;
    gl.BufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(first * sizeof(Instance)),
                     static_cast<GLsizeiptr>(proxies[i].size() * sizeof(Instance)), proxies[i].data());
    first += proxies[i].size();
  }
  gl.UseProgram(program.id());
  first = 0;
  for (std::size_t i = 0; i < proxy_shape_count; ++i) {
    if (proxies[i].empty()) continue;
    const ProxyBuffer::Part& part = stage.proxies().part(static_cast<ProxyShape>(i));
    gl.DrawElementsInstancedBaseInstance(GL_TRIANGLES, part.count, GL_UNSIGNED_SHORT, part.pointer(),
                                         static_cast<GLsizei>(proxies[i].size()), static_cast<GLuint>(first));
    first += proxies[i].size();
  }
}

class MarkOcclusion final : public BatchedVisibility {
 public:
  MarkOcclusion(std::shared_ptr<Context> context, const MarkOcclusionOptions& options)
      : BatchedVisibility(options.flight), resources_(std::move(context), options), counts_(options.count_pixels) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "gl-mark"; }

 protected:
  void start_view(const View& view, std::span<const ObjectView> objects) override {
    forget();
    resources_.use().stage.begin_view(view, objects);
  }
  void start_occluder(std::span<const OccluderPart> parts) override { resources_.use().stage.draw_occluder(parts); }
  [[nodiscard]] std::optional<std::uint32_t> ask(const VisibilityQuery& query) override;
  void answer_all(std::vector<std::uint32_t>& answers) override;

 private:
  void forget() {
    for (auto& of_shape : proxies_) of_shape.clear();
    most_pixels_.clear();
  }

  InContext<Resources> resources_;
  bool counts_;
  std::array<std::vector<Instance>, proxy_shape_count> proxies_;  // by shape
  std::vector<std::uint32_t> most_pixels_;                        // of each question
};

std::optional<std::uint32_t> MarkOcclusion::ask(const VisibilityQuery& query) {
  const ProxyStage& stage = resources_.use().stage;
  const QueryPlan plan = stage.plan(query);
  if (!plan.draw) return stage.answer(plan, counts_);
  proxies_[static_cast<std::size_t>(plan.draw->shape)].push_back(
      {plan.draw->unit_to_clip, static_cast<std::uint32_t>(most_pixels_.size())});
  most_pixels_.push_back(plan.draw->most_pixels);
  return std::nullopt;
}

void MarkOcclusion::answer_all(std::vector<std::uint32_t>& answers) {
  const Resources& resources = resources_.use();
  const Functions& gl = resources.stage.gl();
  answers.assign(most_pixels_.size(), 0);
  gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, resources.marks.id());
  fill(gl, GL_SHADER_STORAGE_BUFFER, std::span<const std::uint32_t>(answers), GL_DYNAMIC_READ);
  resources.draw(proxies_);
  read_back(gl, std::span(answers), "marking visible proxies");
  if (counts_)
    for (std::size_t i = 0; i < answers.size(); ++i) answers[i] = resources.stage.pixels(answers[i], most_pixels_[i]);
  forget();
}

}  // namespace

std::unique_ptr<Visibility> make_mark_occlusion(std::shared_ptr<Context> context, const MarkOcclusionOptions& options) {
  require_options(context.get(), options.flight, options.divisor, "gl-mark");
  require_version(context->functions(), 43, "gl-mark");
  return std::make_unique<MarkOcclusion>(std::move(context), options);
}

}  // namespace occlod::gl
