// Order, epochs, several backends in one process, and what is left behind.
#include <array>
#include <deque>

#include "gl/support.h"
#include "occlod/core/error.h"

namespace occlod::gl {
namespace {

// A context that counts the objects alive: made less deleted.
class CountingContext final : public Context {
 public:
  explicit CountingContext(std::shared_ptr<Context> inner) : inner_(std::move(inner)), functions_(inner_->functions()) {
    real = &inner_->functions();
    alive = 0;
#define COUNT(Gen, Delete)                               \
  functions_.Gen = [](GLsizei n, GLuint* ids) {          \
    alive += n;                                          \
    real->Gen(n, ids);                                   \
  };                                                     \
  functions_.Delete = [](GLsizei n, const GLuint* ids) { \
    alive -= n;                                          \
    real->Delete(n, ids);                                \
  };
    COUNT(GenBuffers, DeleteBuffers)
    COUNT(GenVertexArrays, DeleteVertexArrays)
    COUNT(GenFramebuffers, DeleteFramebuffers)
    COUNT(GenRenderbuffers, DeleteRenderbuffers)
    COUNT(GenQueries, DeleteQueries)
#undef COUNT
    functions_.CreateShader = [](GLenum kind) {
      ++alive;
      return real->CreateShader(kind);
    };
    functions_.DeleteShader = [](GLuint id) {
      --alive;
      real->DeleteShader(id);
    };
    functions_.CreateProgram = [] {
      ++alive;
      return real->CreateProgram();
    };
    functions_.DeleteProgram = [](GLuint id) {
      --alive;
      real->DeleteProgram(id);
    };
  }
  [[nodiscard]] const Functions& functions() const noexcept override { return functions_; }
  [[nodiscard]] std::string_view platform_name() const noexcept override { return inner_->platform_name(); }
  [[nodiscard]] std::string renderer() const override { return inner_->renderer(); }
  [[nodiscard]] std::string version() const override { return inner_->version(); }
  void make_current() override { inner_->make_current(); }

  static inline long alive = 0;

 private:
  static inline const Functions* real = nullptr;
  std::shared_ptr<Context> inner_;
  Functions functions_;
};

class QueryLifetime : public testing::TestWithParam<Platform> {
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
  static VisibilityQuery at_the_eye() { return {0, Sphere{{0, 0, 3}, 0.1F}}; }

  View view_ = test_view();
  std::shared_ptr<Context> context_;
};
INSTANTIATE_TEST_SUITE_P(Gl, QueryLifetime, testing::Values(Platform::egl, Platform::osmesa),
                         [](const auto& param) { return platform_label(param.param); });

TEST_P(QueryLifetime, SaysWhatItIs) {
  const auto occlusion = make_query_occlusion(context_, {.flight = 5, .count_pixels = false});
  EXPECT_EQ(occlusion->name(), "gl-query");
  EXPECT_EQ(occlusion->flight(), 5U);
  EXPECT_TRUE(occlusion->can_hide());
}

TEST_P(QueryLifetime, RefusesNoContextAndNoFlight) {
  EXPECT_THROW(static_cast<void>(make_query_occlusion(nullptr)), Error);
  EXPECT_THROW(static_cast<void>(make_query_occlusion(context_, {.flight = 0, .count_pixels = false})), Error);
}

// Drawn and undrawn answers mixed, far more under way than the flight, taken out in uneven portions: each must be its
// own.
TEST_P(QueryLifetime, AnswersComeInTheOrderOfTheQuestions) {
  const auto occlusion = make_query_occlusion(context_);
  start(*occlusion, wall());
  std::deque<std::uint32_t> expected;
  std::mt19937 random(3);
  int asked = 0;
  while (asked < 500 || !expected.empty()) {
    if (asked < 500 && (expected.empty() || random() % 5U < 3)) {
      const auto kind = random() % 3U;
      occlusion->submit(kind == 0 ? in_front() : kind == 1 ? behind() : at_the_eye());
      expected.push_back(kind == 1 ? 0 : 1);
      ++asked;
    } else {
      ASSERT_EQ(occlusion->collect(), expected.front()) << asked;
      expected.pop_front();
    }
  }
}

// Ten visible answers are left behind; the new view's first answer must be that of its own query.
TEST_P(QueryLifetime, ANewViewForgetsUnansweredQueries) {
  const auto occlusion = make_query_occlusion(context_);
  for (int round = 0; round < 3; ++round) {
    start(*occlusion, wall());
    for (int i = 0; i < 10; ++i) occlusion->submit(in_front());
    start(*occlusion, wall());
    occlusion->submit(behind());
    EXPECT_EQ(occlusion->collect(), 0U);
  }
}

TEST_P(QueryLifetime, TheSizeOfTheViewMayChange) {
  const auto occlusion = make_query_occlusion(context_, {.flight = 1, .count_pixels = true});
  std::array<std::uint32_t, 3> counts{};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    Camera camera = view_.camera();
    camera.width = 64 << i;
    camera.height = 48 << i;
    view_ = View(camera);
    start(*occlusion, wall());
    occlusion->submit(in_front());
    counts[i] = occlusion->collect();
    occlusion->submit(behind());
    EXPECT_EQ(occlusion->collect(), 0U);
  }
  // Twice the side, four times the pixels, less the growth, which stays the same in pixels.
  EXPECT_GT(counts[1], 2 * counts[0]);
  EXPECT_GT(counts[2], 3 * counts[1]);
}

TEST_P(QueryLifetime, BothKindsOfQueryLiveInOneContext) {
  for (int round = 0; round < 4; ++round) {
    const auto any = make_query_occlusion(context_, {.flight = 8, .count_pixels = false});
    const auto count = make_query_occlusion(context_, {.flight = 8, .count_pixels = true});
    start(*any, wall());
    for (int i = 0; i < 4; ++i) {
      any->submit(in_front());
      any->submit(behind());
      EXPECT_EQ(any->collect(), 1U);
      EXPECT_EQ(any->collect(), 0U);
    }
    start(*count, wall());
    for (int i = 0; i < 4; ++i) {
      count->submit(in_front());
      count->submit(behind());
      EXPECT_GT(count->collect(), 5U);  // a sphere of about 4 pixels' radius
      EXPECT_EQ(count->collect(), 0U);
    }
    EXPECT_NO_THROW(check(context_->functions(), "queries of both kinds"));
  }
}

TEST_P(QueryLifetime, ContextsDoNotMixTheirAnswers) {
  for (const Platform other_platform : {Platform::egl, Platform::osmesa}) {
    std::string why;
    const std::shared_ptr<Context> other_context = context_or_null(other_platform, why);
    if (!other_context) continue;
    const auto walled = make_query_occlusion(context_);
    const auto open = make_query_occlusion(other_context);
    start(*walled, wall());
    start(*open, Soup{});
    for (int i = 0; i < 20; ++i) {
      walled->submit(behind());
      open->submit(behind());
      walled->submit(in_front());
      EXPECT_EQ(walled->collect(), 0U);
      EXPECT_EQ(open->collect(), 1U);
      EXPECT_EQ(walled->collect(), 1U);
    }
  }
}

// Two objects, each with its own transform, and parts in any order.
TEST_P(QueryLifetime, PartsAndQueriesUseTheirOwnObject) {
  const auto occlusion = make_query_occlusion(context_);
  const std::array<ObjectView, 2> objects{ObjectView(view_, glm::translate(glm::dmat4(1.0), glm::dvec3(-0.8, 0, 0))),
                                          ObjectView(view_, glm::translate(glm::dmat4(1.0), glm::dvec3(0.8, 0, -2)))};
  occlusion->begin_view(view_, objects);
  Soup small;
  small.add_quad({-0.5F, -0.5F, 0}, {0.5F, -0.5F, 0}, {0.5F, 0.5F, 0}, {-0.5F, 0.5F, 0});
  const std::array<OccluderPart, 2> parts{small.part(1), small.part(0)};
  occlusion->draw_occluder(parts);
  for (const std::uint32_t object : {0U, 1U}) {
    occlusion->submit({object, Sphere{{0, 0, -0.2F}, 0.1F}});
    occlusion->submit({object, Sphere{{0, 0, 0.2F}, 0.1F}});
    EXPECT_EQ(occlusion->collect(), 0U) << object;
    EXPECT_EQ(occlusion->collect(), 1U) << object;
  }
}

// The same memory holds another mesh of the same size in the next view: a copy kept by address would hide the bound
// still.
TEST_P(QueryLifetime, PositionsMayChangeInPlace) {
  const auto occlusion = make_query_occlusion(context_);
  Soup soup = wall();
  start(*occlusion, soup);
  occlusion->submit(behind());
  EXPECT_EQ(occlusion->collect(), 0U);
  for (glm::vec3& p : soup.positions) p.z = -1.0F;
  start(*occlusion, soup);
  occlusion->submit(behind());
  EXPECT_EQ(occlusion->collect(), 1U);
}

// A thousand views that each leave queries behind: as many objects as after the first, and none in the end.
TEST_P(QueryLifetime, AThousandViewsLeaveNothing) {
  auto counting = std::make_shared<CountingContext>(context_);
  auto occlusion = make_query_occlusion(counting);
  long after_first = 0;
  for (int i = 0; i < 1000; ++i) {
    start(*occlusion, wall());
    for (int k = 0; k < 3; ++k) occlusion->submit(k == 1 ? behind() : in_front());
    ASSERT_EQ(occlusion->collect(), 1U);
    ASSERT_EQ(occlusion->collect(), 0U);
    if (i == 0) after_first = CountingContext::alive;
  }
  EXPECT_GT(after_first, 0);
  EXPECT_LE(CountingContext::alive, after_first);
  EXPECT_NO_THROW(check(counting->functions(), "a thousand views"));
  occlusion.reset();
  EXPECT_EQ(CountingContext::alive, 0);
}

// A context whose driver never finishes a query.
class SilentContext final : public Context {
 public:
  explicit SilentContext(std::shared_ptr<Context> inner) : inner_(std::move(inner)), functions_(inner_->functions()) {
    functions_.GetQueryObjectuiv = [](GLuint, GLenum, GLuint* value) { *value = 0; };
  }
  [[nodiscard]] const Functions& functions() const noexcept override { return functions_; }
  [[nodiscard]] std::string_view platform_name() const noexcept override { return "silent"; }
  [[nodiscard]] std::string renderer() const override { return inner_->renderer(); }
  [[nodiscard]] std::string version() const override { return inner_->version(); }
  void make_current() override { inner_->make_current(); }

 private:
  std::shared_ptr<Context> inner_;
  Functions functions_;
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
  const auto occlusion = make_query_occlusion(std::make_shared<SilentContext>(context));
  const std::array<ObjectView, 1> objects{ObjectView(view, glm::dmat4(1.0))};
  occlusion->begin_view(view, objects);
  occlusion->submit({0, Sphere{{0, 0, 0}, 0.1F}});
  EXPECT_THROW(static_cast<void>(occlusion->collect()), Error);
}

}  // namespace
}  // namespace occlod::gl
