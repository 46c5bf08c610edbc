// Which options of refinement are refused, and by whom.
#include <gtest/gtest.h>

#include "occlod/build_hierarchy.h"
#include "occlod/refiner.h"
#include "refine/tuning.h"
#include "support/bad_options.h"
#include "support/meshes.h"

namespace occlod::test {
namespace {

TEST(CheckOptions, NamesTheFieldThatIsOutOfRange) {
  expect_all_refused([](const RefineOptions& options) { check_options(options); });
}

TEST(CheckOptions, AcceptsTheEndsOfTheRanges) {
  RefineOptions options;
  EXPECT_NO_THROW(check_options(options));
  options.tolerance_px = 0.0;
  tune(options) = {.visible_exponent = 0.0, .grazing_exponent = 8.0, .forced_exponent = 0.0};
  tune(options).occluder_splits = {0, 1};
  tune(options).level_step = 1;
  tune(options).hysteresis = 0.0;
  options.time_limit_ms = 1e9;
  EXPECT_NO_THROW(check_options(options));
}

TEST(CheckOptions, SaysTheRange) {
  RefineOptions options;
  tune(options).hysteresis = 2.0;
  try {
    check_options(options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "refinement: option tuning.hysteresis: 2 is out of range; choose a value from 0 to below 1");
  }
}

// Both ways to refine refuse, and what was refined before goes on as if nothing had been asked.
TEST(Refiner, RefusesOptionsOutOfRange) {
  const Hierarchy hierarchy = build_hierarchy(noisy_sphere(3, 1));
  const RefineObject objects[] = {{.hierarchy = &hierarchy}};
  Refiner refiner(objects);
  NoOcclusion none;
  const View view{Camera{}};
  expect_all_refused([&](const RefineOptions& options) { (void)refiner.refine(view, options, none); });

  const std::uint64_t before = refiner.update(view, {.budget = 300}, none).hash();
  expect_all_refused([&](const RefineOptions& options) { (void)refiner.update(view, options, none); });
  const Refinement& after = refiner.update(view, {.budget = 300}, none);
  EXPECT_EQ(after.hash(), before);
  EXPECT_EQ(after.stats.new_splits, 0U);  // it has gone on
}

}  // namespace
}  // namespace occlod::test
