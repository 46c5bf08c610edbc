// A program of its own: it replaces operator new.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <new>

#include "occlod/device/device_costs.h"
#include "occlod/device/software_device.h"
#include "traverse/small_scenes.h"

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

namespace occlod::hlod {
namespace {

// Everything is kept from frame to frame and grows only to new largest sizes: a path that has been gone along needs no
// memory that it has not had. Not so with batch and automatic, which choose how to ask by what they asked before.
TEST(Allocations, NoFrameOfAPathThatIsKnownAllocates) {
  const Hlod& hlod = test::city(Grouping::shifted);
  const PlacedHlod placed[] = {
      {&hlod}, {&hlod, glm::dmat4(2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0)}};
  for (const Strategy strategy :
       {Strategy::vfc, Strategy::sw, Strategy::sw_b, Strategy::boolean, Strategy::simp, Strategy::coh, Strategy::ideal,
        Strategy::nohc, Strategy::optimum, Strategy::chc_plus, Strategy::two_pass, Strategy::cesium}) {
    SoftwareDevice device, oracle;
    Traverser traverser(placed);
    TraverseOptions options;
    options.strategy = strategy;
    options.oracle = &oracle;
    options.costs = device_preset("modern");
    options.geomorph = true;
    constexpr int frames = 12;
    std::size_t allocated = 0;
    for (int way = 0; way < 3; ++way) {
      allocated = 0;
      for (int i = 0; i < frames; ++i) {
        const View view(test::walk(hlod.data().box, i, 100));
        const std::size_t before = allocations;
        traverser.draw_frame(view, device, options);
        allocated += allocations - before;
      }
      EXPECT_TRUE(way > 0 || allocated > 0U);
    }
    EXPECT_EQ(allocated, 0U) << static_cast<int>(strategy);
  }
}

}  // namespace
}  // namespace occlod::hlod
