#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "gl/backend.h"
#include "gl/backend_options.h"
#include "gl/objects.h"
#include "gl/proxy_stage.h"
#include "occlod/gl.h"

namespace occlod::gl {
namespace {

// Owns everything that lives in the context.
struct Resources {
  Resources(const Functions& gl, const MarkOcclusionOptions& options)
      : stage(gl, options.divisor), proxies(gl, options.count_pixels ? Marking::pixels : Marking::visible), marks(gl) {}

  ProxyStage stage;
  ProxyMarks proxies;
  Buffer marks;
};

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
    max_pixels_.clear();
  }

  InContext<Resources> resources_;
  bool counts_;
  MarkedProxies proxies_;
  std::vector<std::uint32_t> max_pixels_;  // per query
};

std::optional<std::uint32_t> MarkOcclusion::ask(const VisibilityQuery& query) {
  const ProxyStage& stage = resources_.use().stage;
  const QueryPlan plan = stage.plan(query);
  if (!plan.draw) return stage.answer(plan, counts_);
  proxies_[static_cast<std::size_t>(plan.draw->shape)].push_back(
      {plan.draw->unit_to_clip, static_cast<std::uint32_t>(max_pixels_.size())});
  max_pixels_.push_back(plan.draw->max_pixels);
  return std::nullopt;
}

void MarkOcclusion::answer_all(std::vector<std::uint32_t>& answers) {
  const Resources& resources = resources_.use();
  const Functions& gl = resources.stage.gl();
  answers.assign(max_pixels_.size(), 0);
  gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, resources.marks.id());
  fill(gl, GL_SHADER_STORAGE_BUFFER, std::span<const std::uint32_t>(answers), GL_DYNAMIC_READ);
  resources.proxies.draw(proxies_, resources.marks);
  read_back(gl, std::span(answers), "marking visible proxies");
  if (counts_)
    for (std::size_t i = 0; i < answers.size(); ++i) answers[i] = resources.stage.pixels(answers[i], max_pixels_[i]);
  forget();
}

}  // namespace

std::unique_ptr<Visibility> make_mark_occlusion(std::shared_ptr<Context> context, const MarkOcclusionOptions& options) {
  require_options(context.get(), options.flight, options.divisor, "gl-mark");
  require_version(context->functions(), 43, "gl-mark");
  return std::make_unique<MarkOcclusion>(std::move(context), options);
}

std::unique_ptr<Visibility> make_mark_occlusion(std::shared_ptr<Context> context) {
  return make_mark_occlusion(std::move(context), MarkOcclusionOptions{});
}

}  // namespace occlod::gl
