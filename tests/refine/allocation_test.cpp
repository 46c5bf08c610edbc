// A program of its own: it replaces operator new.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <string>

#include "occlod/occlusion/software_occlusion.h"
#include "refine/refine_support.h"

namespace {

std::size_t allocations = 0;

}  // namespace

// Not in line: GCC takes malloc and delete for a mismatch.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* const memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  const auto align = static_cast<std::size_t>(alignment);
  if (void* const memory = std::aligned_alloc(align, (size + align - 1) / align * align)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

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
  options.priority.culling = GetParam().culling;
  constexpr int frames = 20, known_ways = 14;
  const auto step = [&](int frame) {
    Camera camera = test::front_camera();
    const double angle = 0.03 * frame;
    camera.eye = {3.0 * std::sin(angle), 0.4, 3.0 * std::cos(angle)};
    const View view(camera);
    const std::size_t before = allocations;
    static_cast<void>(refiner.update(view, options, visibility));
    return allocations - before;
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
