// Order, epochs, several backends in one process, and what is left behind, for every backend.
#include <array>
#include <deque>
#include <random>

#include "gl/backend_options.h"
#include "gl/backends.h"
#include "gl/counting_context.h"
#include "occlod/base.h"
#include "occlod/gl.h"

namespace occlod::gl {
namespace {

VisibilityQuery in_front() { return {0, Sphere{{0, 0, 0.5F}, 0.1F}}; }
VisibilityQuery behind() { return {0, Sphere{{0, 0, -0.5F}, 0.1F}}; }
VisibilityQuery at_the_eye() { return {0, Sphere{{0, 0, 3}, 0.1F}}; }

class BackendLifetime : public EachBackend {};
INSTANTIATE_TEST_SUITE_P(Gl, BackendLifetime, testing::ValuesIn(tested_backends()), backend_label);

// Runs on those that have a context.
class BackendContext : public EachBackend {};
INSTANTIATE_TEST_SUITE_P(Gl, BackendContext, testing::ValuesIn(tested_gl_backends()), backend_label);

TEST_P(BackendLifetime, SaysWhatItIs) {
  const auto occlusion = make();
  const std::string name(occlusion->name());
  EXPECT_TRUE(name == "software" || name.rfind("gl-", 0) == 0) << name;
  EXPECT_GE(occlusion->flight(), 1U);
  EXPECT_TRUE(occlusion->can_hide());
}

// Drawn and undrawn answers mixed, far more under way than the flight, taken out in uneven portions: each must be its
// own.
TEST_P(BackendLifetime, AnswersComeInTheOrderOfTheQuestions) {
  const auto occlusion = make();
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

// Ten visible answers are left behind, some of them perhaps known already; the new view's first answer must be that of
// its own query.
TEST_P(BackendLifetime, ANewViewForgetsUnansweredQueries) {
  const auto occlusion = make();
  for (int round = 0; round < 3; ++round) {
    start(*occlusion, wall());
    for (int i = 0; i < 10; ++i) occlusion->submit(in_front());
    if (round == 2) {
      EXPECT_EQ(occlusion->collect(), 1U);
    }
    start(*occlusion, wall());
    occlusion->submit(behind());
    EXPECT_EQ(occlusion->collect(), 0U);
  }
}

// A view without an occluder after one with: the old occluder hides nothing in it.
TEST_P(BackendLifetime, ANewViewForgetsTheOccluder) {
  const auto occlusion = make();
  start(*occlusion, wall());
  const std::array<ObjectView, 1> objects{ObjectView(view_, glm::dmat4(1.0))};
  occlusion->begin_view(view_, objects);
  occlusion->submit(behind());
  EXPECT_EQ(occlusion->collect(), 1U);
}

TEST_P(BackendLifetime, TheSizeOfTheViewMayChange) {
  const auto occlusion = make(true);
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
  EXPECT_GT(2 * counts[1], 3 * counts[0]);
  EXPECT_GT(counts[2], 2 * counts[1]);
}

// Sizes that no power of two divides, down to one pixel: levels of pyramids and borders of smaller targets.
TEST_P(BackendLifetime, AnySizeOfTheViewWorks) {
  const auto occlusion = make();
  for (const auto& [width, height] : {std::pair(1, 1), {1, 7}, {5, 1}, {3, 3}, {63, 65}, {129, 31}, {1001, 17}}) {
    SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height));
    Camera camera = view_.camera();
    camera.width = width;
    camera.height = height;
    view_ = View(camera);
    Soup all;
    const float far = 100.0F;
    all.add_quad({-far, -far, 0}, {far, -far, 0}, {far, far, 0}, {-far, far, 0});
    start(*occlusion, all);
    const double pixel = 3.0 / view_.focal_length_px();
    // At the last pixels of the image's four corners: in front of the wall, and deep behind it.
    for (const double sx : {-1.0, 1.0})
      for (const double sy : {-1.0, 1.0}) {
        const glm::dvec2 corner(sx * (width / 2.0 - 0.5) * pixel, sy * (height / 2.0 - 0.5) * pixel);
        const auto placed = [&](double z) { return Sphere{glm::vec3(glm::dvec3(corner * (3.0 - z) / 3.0, z)), 1e-3F}; };
        occlusion->submit({0, placed(0.05)});
        EXPECT_EQ(occlusion->collect(), 1U) << sx << " " << sy;
        if (width < 30 || height < 30) continue;  // where a pixel is as large as the scene, proxies reach the wall
        occlusion->submit({0, placed(-3.0)});
        EXPECT_EQ(occlusion->collect(), 0U) << sx << " " << sy;
      }
  }
}

// More pixels than llvmpipe's 65,535 rounds of a loop could count on one invocation of 64: a sphere that is wider and
// higher than the image, in front of nothing, shows at each of them.
TEST_P(BackendLifetime, LargeImagesAreCountedToTheLastPixel) {
  const auto occlusion = make(true);
  Camera camera = view_.camera();
  camera.width = 4096;
  camera.height = 2304;
  view_ = View(camera);
  start(*occlusion, Soup{});
  occlusion->submit({0, Sphere{{0, 0, -3}, 5.0F}});
  EXPECT_EQ(occlusion->collect(), 4096U * 2304U);
}

TEST_P(BackendLifetime, BothKindsOfAnswerLiveInOneContext) {
  for (int round = 0; round < 4; ++round) {
    const auto any = make(false);
    const auto count = make(true);
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
    if (context_) {
      EXPECT_NO_THROW(check(context_->functions(), "answers of both kinds"));
    }
  }
}

// View after view, each backend finds what another has left of the context's state.
TEST_P(BackendContext, AnotherBackendMayUseTheContextBetweenViews) {
  const auto own = make();
  for (const TestedBackend& other : tested_backends()) {
    if (other.backend == Backend::software || other.platform != GetParam().platform) continue;
    std::string why;
    if (!other.context(why)) continue;
    const auto guest = other.make(context_);
    start(*guest, Soup{});
    guest->submit(behind());
    EXPECT_EQ(guest->collect(), 1U) << other.label();
    start(*own, wall());
    own->submit(behind());
    own->submit(in_front());
    EXPECT_EQ(own->collect(), 0U) << other.label();
    EXPECT_EQ(own->collect(), 1U) << other.label();
  }
}

TEST_P(BackendLifetime, ContextsDoNotMixTheirAnswers) {
  for (const Platform other_platform : {Platform::egl, Platform::osmesa}) {
    std::string why;
    const std::shared_ptr<Context> other_context = context_or_null(other_platform, why);
    if (!other_context) continue;
    const auto walled = make();
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
TEST_P(BackendLifetime, PartsAndQueriesUseTheirOwnObject) {
  const auto occlusion = make();
  const std::array<ObjectView, 2> objects{ObjectView(view_, glm::translate(glm::dmat4(1.0), glm::dvec3(-0.8, 0, 0))),
                                          ObjectView(view_, glm::translate(glm::dmat4(1.0), glm::dvec3(0.8, 0, -2)))};
  occlusion->begin_view(view_, objects);
  Soup small;
  small.add_quad({-0.5F, -0.5F, 0}, {0.5F, -0.5F, 0}, {0.5F, 0.5F, 0}, {-0.5F, 0.5F, 0});
  const std::array<OccluderPart, 2> parts{small.part(1), small.part(0)};
  occlusion->draw_occluder(parts);
  for (const std::uint32_t object : {0U, 1U}) {
    occlusion->submit({object, Sphere{{0, 0, -0.4F}, 0.1F}});
    occlusion->submit({object, Sphere{{0, 0, 0.4F}, 0.1F}});
    EXPECT_EQ(occlusion->collect(), 0U) << object;
    EXPECT_EQ(occlusion->collect(), 1U) << object;
  }
}

// The same memory holds another mesh of the same size in the next view: a copy kept by address would hide the bound
// still.
TEST_P(BackendLifetime, PositionsMayChangeInPlace) {
  const auto occlusion = make();
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
TEST_P(BackendContext, AThousandViewsLeaveNothing) {
  const auto counting = std::make_shared<CountingContext>(context_);
  auto occlusion = GetParam().make(counting);
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

// A hundred backends made, used and destroyed in one context.
TEST_P(BackendContext, AHundredOfThemLeaveNothing) {
  const auto counting = std::make_shared<CountingContext>(context_);
  for (int i = 0; i < 100; ++i) {
    const auto occlusion = GetParam().make(counting, i % 2 == 0);
    start(*occlusion, wall());
    occlusion->submit(behind());
    if (i % 3 != 0) {
      EXPECT_EQ(occlusion->collect(), 0U);
    }
  }
  EXPECT_EQ(CountingContext::alive, 0);
  EXPECT_NO_THROW(check(counting->functions(), "a hundred backends"));
}

// What somebody has done wrong in the context before is told when a view starts or an occluder is drawn, not passed
// over.
TEST_P(BackendContext, ErrorsOfOpenGlAreTold) {
  const auto occlusion = make();
  context_->functions().Enable(GL_TRIANGLES);  // not a capability: INVALID_ENUM
  EXPECT_THROW(start(*occlusion, wall()), Error);
}

// A context of OpenGL 3.3, as an old driver gives it.
class OldContext final : public ContextWithFunctions {
 public:
  explicit OldContext(const std::shared_ptr<Context>& inner) : ContextWithFunctions(inner) {
    functions_.version = 33;
    functions_.DrawElementsInstancedBaseInstance = nullptr;
    functions_.MemoryBarrier = nullptr;
  }
};

TEST_P(BackendContext, RefusesContextsThatAreTooOld) {
  const auto old = std::make_shared<OldContext>(context_);
  const bool runs = GetParam().backend != Backend::query_conservative;
  try {
    static_cast<void>(GetParam().make(old));
    EXPECT_TRUE(runs);
  } catch (const Error& error) {
    EXPECT_FALSE(runs);
    const std::string message = error.what();
    for (const char* part : {"4.3", "3.3", "gl-query", "software"})
      EXPECT_NE(message.find(part), std::string::npos) << part;
  }
}

TEST_P(BackendContext, RefusesWhatMakesNoSense) {
  EXPECT_THROW(static_cast<void>(GetParam().make(nullptr)), Error);
  EXPECT_THROW(static_cast<void>(make_query_occlusion(context_, {.flight = 0})), Error);
  EXPECT_THROW(static_cast<void>(make_query_occlusion(context_, {.divisor = 0})), Error);
}

}  // namespace
}  // namespace occlod::gl
