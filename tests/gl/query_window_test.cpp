// What gl-query alone has: a window of queries, their pool, and a wait for each.
#include <array>

#include "gl/backend_options.h"
#include "gl/counting_context.h"
#include "gl/support.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "occlod/refiner.h"
#include "oracle/random_shapes.h"

namespace occlod::gl {
namespace {

class QueryWindow : public testing::TestWithParam<Platform> {
 protected:
  void SetUp() override {
    std::string why;
    context_ = context_or_null(GetParam(), why);
    if (!context_) GTEST_SKIP() << "no context: " << why;
  }
  void start(Visibility& occlusion, const Soup& occluder) const {
    const std::array<ObjectView, 1> objects{ObjectView(view_, glm::dmat4(1.0))};
    occlusion.begin_view(view_, objects);
    const std::array<OccluderPart, 1> parts{occluder.part()};
    occlusion.draw_occluder(parts);
  }
  static VisibilityQuery in_front() { return {0, Sphere{{0, 0, 0.5F}, 0.1F}}; }
  static VisibilityQuery behind() { return {0, Sphere{{0, 0, -0.5F}, 0.1F}}; }

  View view_ = test_view();
  std::shared_ptr<Context> context_;
};
INSTANTIATE_TEST_SUITE_P(Gl, QueryWindow, testing::Values(Platform::egl, Platform::osmesa),
                         [](const auto& param) { return platform_label(param.param); });

// Refinement sees the flight, whatever window has been measured.
TEST_P(QueryWindow, TheFlightIsAsGiven) {
  for (const std::size_t flight : {1U, 5U, 64U}) {
    const auto occlusion = make_query_occlusion(context_, {.flight = flight});
    start(*occlusion, wall());
    EXPECT_EQ(occlusion->flight(), flight);
  }
}

// Both ask about the same proxies in the same order, so with the same flight the same triangles are left.
TEST_P(QueryWindow, MarksRefineAsQueriesWithTheSameFlight) {
  const Hierarchy hierarchy = build_hierarchy(generate("rough-planet", {{"level", 4}}));
  const RefineObject objects[] = {{.hierarchy = &hierarchy}};
  Camera camera{.eye = {0.0, 0.0, 3.0}, .target = {0.0, 0.0, 0.0}};
  camera.width = 320;
  camera.height = 240;
  const auto refined = [&](Visibility& visibility) {
    Refiner refiner(objects);
    return refiner.refine(View(camera), {.budget = 1000}, visibility).objects[0].triangles;
  };
  const auto queries = make_query_occlusion(context_, {.flight = 16});
  const auto marks = make_mark_occlusion(context_, {.flight = 16});
  EXPECT_EQ(refined(*queries), refined(*marks));
}

// The same 300 questions, 20 under way: the window changes when they are put to OpenGL, not what it answers.
TEST_P(QueryWindow, DoesNotChangeAnswers) {
  std::vector<std::vector<std::uint32_t>> answers;
  for (const std::size_t window : {0U, 1U, 2U, 7U, 20U, 100U}) {
    const auto occlusion =
        make_query_occlusion(context_, {.flight = 20, .window = window, .target = QueryTarget::count});
    start(*occlusion, wall_with_hole(-0.4F, 0.3F, -0.2F, 0.5F));
    test::RandomShapes random(8);
    std::vector<std::uint32_t>& of_window = answers.emplace_back();
    for (int i = 0; i < 300; ++i) {
      occlusion->submit(random.bound(test::BoundKind::box, glm::vec3(glm::dvec2(random.point(1.0)), -0.5F), 0.3));
      if (i >= 20) of_window.push_back(occlusion->collect());
    }
    for (int i = 0; i < 20; ++i) of_window.push_back(occlusion->collect());
    EXPECT_EQ(of_window, answers.front()) << window;
  }
}

// Never more objects than the window holds at once, however many questions are under way; then they are used again.
TEST_P(QueryWindow, BoundsTheObjectsOfThePool) {
  const auto counting = std::make_shared<CountingContext>(context_);
  const auto occlusion = make_query_occlusion(counting, {.flight = 32, .window = 4});
  start(*occlusion, wall());
  for (int i = 0; i < 300; ++i) {
    occlusion->submit(i % 2 == 0 ? behind() : in_front());
    if (i >= 32) {
      EXPECT_EQ(occlusion->collect(), static_cast<std::uint32_t>(i % 2));
    }
  }
  EXPECT_EQ(CountingContext::queries_made, 4);
}

// Each query object keeps one target for its whole life, also when backends of all kinds share the context.
class TargetContext final : public ContextWithFunctions {
 public:
  explicit TargetContext(const std::shared_ptr<Context>& inner) : ContextWithFunctions(inner) {
    real = &inner->functions();
    targets.clear();
    mixed = false;
    functions_.BeginQuery = [](GLenum target, GLuint id) {
      if (targets.resize(std::max<std::size_t>(targets.size(), id + 1)); targets[id] == 0) targets[id] = target;
      mixed = mixed || targets[id] != target;
      real->BeginQuery(target, id);
    };
    functions_.DeleteQueries = [](GLsizei n, const GLuint* ids) {
      for (GLsizei i = 0; i < n; ++i)
        if (ids[i] < targets.size()) targets[ids[i]] = 0;
      real->DeleteQueries(n, ids);
    };
  }
  static inline bool mixed = false;

 private:
  static inline const Functions* real = nullptr;
  static inline std::vector<GLenum> targets;
};

TEST_P(QueryWindow, ObjectsAreNeverUsedForTwoTargets) {
  const auto watched = std::make_shared<TargetContext>(context_);
  std::vector<QueryTarget> targets{QueryTarget::any, QueryTarget::count};
  if (context_->functions().version >= 43) targets.push_back(QueryTarget::any_conservative);
  std::vector<std::unique_ptr<Visibility>> backends;
  for (const QueryTarget target : targets) backends.push_back(make_query_occlusion(watched, {.target = target}));
  for (int round = 0; round < 5; ++round)
    for (const auto& occlusion : backends) {
      start(*occlusion, wall());
      for (int i = 0; i < 6; ++i) occlusion->submit(in_front());
      for (int i = 0; i < 3; ++i) EXPECT_GE(occlusion->collect(), 1U);
    }
  EXPECT_FALSE(TargetContext::mixed);
  EXPECT_NO_THROW(check(watched->functions(), "queries of all kinds"));
}

// A driver that never finishes a query.
class SilentContext final : public ContextWithFunctions {
 public:
  explicit SilentContext(const std::shared_ptr<Context>& inner) : ContextWithFunctions(inner) {
    functions_.GetQueryObjectuiv = [](GLuint, GLenum, GLuint* value) { *value = 0; };
  }
};

// An error after a wait with an end (10 s), not a hang.
TEST(QueryWait, ADriverWithoutAnswersIsAnError) {
  std::shared_ptr<Context> context;
  try {
    context = create_any_context();
  } catch (const Error& error) {
    GTEST_SKIP() << "no context: " << error.what();
  }
  const View view = test_view();
  const auto occlusion = make_query_occlusion(std::make_shared<SilentContext>(context), {.window = 1});
  const std::array<ObjectView, 1> objects{ObjectView(view, glm::dmat4(1.0))};
  occlusion->begin_view(view, objects);
  occlusion->submit({0, Sphere{{0, 0, 0}, 0.1F}});
  EXPECT_THROW(static_cast<void>(occlusion->collect()), Error);
}

}  // namespace
}  // namespace occlod::gl
