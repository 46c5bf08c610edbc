#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <deque>
#include <glm/ext/matrix_transform.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "base/timing.h"
#include "gl/backend.h"
#include "gl/backend_options.h"
#include "gl/objects.h"
#include "gl/proxy_stage.h"
#include "occlod/base.h"
#include "occlod/gl.h"

namespace occlod::gl {
namespace {

using Clock = std::chrono::steady_clock;

GLenum gl_target(QueryTarget target) {
  switch (target) {
    case QueryTarget::any:
      return GL_ANY_SAMPLES_PASSED;
    case QueryTarget::any_conservative:
      return GL_ANY_SAMPLES_PASSED_CONSERVATIVE;
    default:
      return GL_SAMPLES_PASSED;
  }
}

// Draws one proxy with its own query.
Query draw_query(QueryPool& pool, const ProxyStage& stage, const ProxyDraw& draw) {
  Query query = pool.begin(stage.gl());
  stage.draw(draw);
  pool.end(stage.gl());
  return query;
}

// Measures how many queries can be issued between issuing one and its answer: with that many pending, the oldest is
// answered when the youngest has been issued. Returns twice that number, since neither time is steady.
std::size_t measured_window(const ProxyStage& stage, QueryPool& pool, std::size_t most) {
  constexpr int warm_up = 3;
  constexpr int rounds = 9;
  // Draws a box of about ten pixels in the middle of the screen.
  const ProxyDraw box{ProxyShape::box, glm::scale(glm::mat4(1.0F), glm::vec3(0.005F)), 1};
  std::vector<double> issue;
  std::vector<double> answer;
  for (int i = -warm_up; i < rounds; ++i) {
    const Clock::time_point start = Clock::now();
    Query query = draw_query(pool, stage, box);
    const Clock::time_point issued = Clock::now();
    static_cast<void>(pool.take(stage.gl(), std::move(query)));
    if (i < 0) continue;
    issue.push_back(std::chrono::duration<double>(issued - start).count());
    answer.push_back(std::chrono::duration<double>(Clock::now() - issued).count());
  }
  const double meanwhile = median(answer) / std::max(median(issue), 1e-9);
  return static_cast<std::size_t>(std::clamp(std::ceil(1.0 + 2.0 * meanwhile), 1.0, static_cast<double>(most)));
}

struct Pending {
  std::optional<ProxyDraw> draw;  // empty: answered without drawing
  std::optional<Query> query;     // set once it is issued
  std::uint32_t answer = 0;       // used when nothing is drawn
};

// Owns everything that lives in the context.
struct Resources {
  Resources(const Functions& gl, const QueryOcclusionOptions& options)
      : stage(gl, options.divisor), pool(gl_target(options.target)) {}
  ProxyStage stage;
  QueryPool pool;
  std::deque<Pending> pending;  // oldest first; issued ones before the others
};

class QueryOcclusion final : public Visibility {
 public:
  QueryOcclusion(std::shared_ptr<Context> context, const QueryOcclusionOptions& options)
      : resources_(std::move(context), options),
        flight_(options.flight),
        window_(options.window),
        counts_(options.target == QueryTarget::count) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "gl-query"; }
  [[nodiscard]] std::size_t flight() const noexcept override { return flight_; }
  void begin_view(const View& view, std::span<const ObjectView> objects) override;
  void draw_occluder(std::span<const OccluderPart> parts) override;
  void submit(const VisibilityQuery& query) override;
  [[nodiscard]] std::uint32_t collect() override;

 private:
  void issue(Resources& resources);

  InContext<Resources> resources_;
  std::size_t flight_;
  std::size_t window_;  // maximum of queries pending in OpenGL; 0 = not measured yet
  bool counts_;
  std::size_t looked_at_ = 0;  // number of processed entries at the front: issued, or answered without drawing
  std::size_t issued_ = 0;     // number of issued queries among them
};

void QueryOcclusion::begin_view(const View& view, std::span<const ObjectView> objects) {
  Resources& resources = resources_.use();
  // Unanswered queries are destroyed, so that a late answer of an older view cannot arrive.
  resources.pending.clear();
  looked_at_ = 0;
  issued_ = 0;
  resources.stage.begin_view(view, objects);
  if (window_ == 0) window_ = measured_window(resources.stage, resources.pool, flight_);
}

void QueryOcclusion::draw_occluder(std::span<const OccluderPart> parts) {
  Resources& resources = resources_.use();
  assert(resources.pending.empty());
  resources.stage.draw_occluder(parts);
}

void QueryOcclusion::submit(const VisibilityQuery& query) {
  Resources& resources = resources_.use();
  const QueryPlan plan = resources.stage.plan(query);
  resources.pending.push_back({plan.draw, std::nullopt, plan.draw ? 0U : resources.stage.answer(plan, counts_)});
  issue(resources);
}

// Issues as many queries as the window has room for.
void QueryOcclusion::issue(Resources& resources) {
  for (; issued_ < window_ && looked_at_ < resources.pending.size(); ++looked_at_) {
    Pending& next = resources.pending[looked_at_];
    if (!next.draw) continue;
    next.query = draw_query(resources.pool, resources.stage, *next.draw);
    ++issued_;
  }
}

std::uint32_t QueryOcclusion::collect() {
  Resources& resources = resources_.use();
  assert(!resources.pending.empty());
  Pending oldest = std::move(resources.pending.front());
  resources.pending.pop_front();
  --looked_at_;
  if (!oldest.query) return oldest.answer;
  --issued_;
  const std::uint32_t passed = resources.pool.take(resources.stage.gl(), *std::move(oldest.query));
  issue(resources);
  // Checks once for all queries between two occluders, because a lost context may return any answer.
  if (issued_ == 0) check(resources.stage.gl(), "occlusion query");
  return counts_ ? resources.stage.pixels(passed, oldest.draw->max_pixels) : std::min(passed, 1U);
}

}  // namespace

std::unique_ptr<Visibility> make_query_occlusion(std::shared_ptr<Context> context,
                                                 const QueryOcclusionOptions& options) {
  require_options(context.get(), options.flight, options.divisor, "gl-query");
  if (options.target == QueryTarget::any_conservative)
    require_version(context->functions(), 43, "gl-query with conservative queries");
  return std::make_unique<QueryOcclusion>(std::move(context), options);
}

std::unique_ptr<Visibility> make_query_occlusion(std::shared_ptr<Context> context) {
  return make_query_occlusion(std::move(context), QueryOcclusionOptions{});
}

}  // namespace occlod::gl
