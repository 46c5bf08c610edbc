// A program of its own, with an operator new of its own.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <string>

#include "occlod/visibility.h"
#include "refine/refine_support.h"
#include "refine/tuning.h"
#include "support/counted_allocations.h"

namespace occlod {
namespace {

struct Way {
  Culling culling;
  bool occlusion;
};

class Allocations : public testing::TestWithParam<Way> {};

// Everything is kept from frame to frame and grows only to new largest sizes: once a path has been gone along
// forth and back a few times, so that nothing jumps, a closed mesh needs no memory that it has not had. A few times, as
// what is kept depends on where it comes from.
TEST_P(Allocations, NoFrameOfAPathThatIsKnownAllocates) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(5, 3));
  const std::vector<RefineObject> objects = {{&hierarchy, glm::dmat4(1.0), false}};
  const std::unique_ptr<Visibility> software = make_software_occlusion();
  NoOcclusion none;
  Visibility& visibility = GetParam().occlusion ? *software : static_cast<Visibility&>(none);
  Refiner refiner(objects);
  RefineOptions options;
  options.budget = 3000;
  tune(options).culling = GetParam().culling;
  constexpr int frames = 20, known_ways = 14;
  const auto step = [&](int frame) {
    Camera camera = test::front_camera();
    const double angle = 0.03 * frame;
    camera.eye = {3.0 * std::sin(angle), 0.4, 3.0 * std::cos(angle)};
    const View view(camera);
    const std::size_t before = test::allocation_count();
    static_cast<void>(refiner.update(view, options, visibility));
    return test::allocation_count() - before;
  };
  const auto go = [&](bool forth) {
    std::size_t made = 0;
    for (int k = 0; k < frames; ++k) made += step(forth ? k : frames - 1 - k);
    return made;
  };
  EXPECT_GT(go(true), 0U);  // else nothing is counted
  for (int way = 1; way < known_ways; ++way) static_cast<void>(go(way % 2 == 0));
  EXPECT_EQ(go(true), 0U);
}

INSTANTIATE_TEST_SUITE_P(Ways, Allocations,
                         testing::Values(Way{Culling::subtree, false}, Way{Culling::subtree, true},
                                         Way{Culling::star, false}, Way{Culling::star, true}),
                         [](const auto& way) {
                           return std::string(way.param.culling == Culling::star ? "star" : "subtree") +
                                  (way.param.occlusion ? "_software" : "_none");
                         });

}  // namespace
}  // namespace occlod
