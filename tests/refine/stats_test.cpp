// Numbers about refinement: each is set on every path, and they fit together.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <string>
#include <utility>

#include "occlod/visibility.h"
#include "refine/refine_support.h"
#include "refine/tuning.h"

namespace occlod::test {
namespace {

enum class Way { from_scratch, frame_to_frame };

struct Case {
  Way way;
  Culling culling;
  bool occlusion;
};

std::string name_of(const testing::TestParamInfo<Case>& info) {
  return std::string(info.param.way == Way::from_scratch ? "FromScratch" : "FrameToFrame") +
         (info.param.culling == Culling::star ? "Star" : "Subtree") + (info.param.occlusion ? "Software" : "None");
}

// A small sphere that goes round a large one, and in front of and behind it, as the camera does; near enough for some
// of it to be out of the picture.
class Stats : public testing::TestWithParam<Case> {
 protected:
  Stats() {
    options_.budget = 3'000;
    tune(options_).culling = GetParam().culling;
  }

  static Camera camera(int frame) {
    Camera camera = front_camera();
    const double angle = 0.06 * frame;
    camera.eye = {2.0 * std::sin(angle), 0.3, 2.0 * std::cos(angle)};
    return camera;
  }

  const Refinement& frame(int i) {
    Visibility& visibility = GetParam().occlusion ? *software_ : static_cast<Visibility&>(none_);
    const View view(camera(i));
    return GetParam().way == Way::from_scratch ? refiner_.refine(view, options_, visibility)
                                               : refiner_.update(view, options_, visibility);
  }

  Hierarchy hierarchy_ = build_hierarchy(noisy_sphere(5, 3));
  std::vector<RefineObject> objects_ = {
      {.hierarchy = &hierarchy_},
      {.hierarchy = &hierarchy_,
       .object_to_world = {{0.4, 0, 0, 0}, {0, 0.4, 0, 0}, {0, 0, 0.4, 0}, {1.3, 0.2, 0.4, 1}}}};
  Refiner refiner_{objects_};
  std::unique_ptr<Visibility> software_ = make_software_occlusion();
  NoOcclusion none_;
  RefineOptions options_;
};

constexpr int frames = 50;

std::size_t splits_of(const Refinement& refinement) {
  std::size_t splits = 0;
  for (const RefinedObject& object : refinement.objects) splits += object.splits.size();
  return splits;
}

TEST_P(Stats, FitTogether) {
  for (int i = 0; i < frames; ++i) {
    SCOPED_TRACE(i);
    const RefineStats& stats = frame(i).stats;
    EXPECT_LE(stats.culled_frustum + stats.culled_backface + stats.culled_occlusion, stats.nodes);
    EXPECT_GT(stats.culled_frustum, 0U);
    EXPECT_GT(stats.culled_backface, 0U);
    EXPECT_LE(stats.forced_splits, stats.new_splits);
    EXPECT_LE(stats.forced_unseen_splits, stats.forced_splits);
    EXPECT_LE(stats.new_splits, stats.splits);
    EXPECT_LE(stats.queries_hidden, stats.queries);
    EXPECT_LE(stats.readmitted, stats.queries);
    if (!GetParam().occlusion) {
      EXPECT_EQ(stats.queries + stats.occluder_draws + stats.culled_occlusion + stats.readmitted, 0U);
    }
  }
}

// By comparing with the splits of the call before. What update() refines from the base meshes is new, all of it.
TEST_P(Stats, CountSplitsThatHaveComeAndGone) {
  std::vector<RefinedObject> before;
  for (int i = 0; i < frames; ++i) {
    SCOPED_TRACE(i);
    const Refinement& refinement = frame(i);
    const RefineStats& stats = refinement.stats;
    EXPECT_EQ(stats.splits, splits_of(refinement));
    if (GetParam().way == Way::from_scratch || i == 0) {
      EXPECT_EQ(stats.new_splits, stats.splits);
    } else {
      std::vector<SplitId> come, gone;
      for (std::size_t k = 0; k < before.size(); ++k) {
        const std::vector<SplitId>&was = before[k].splits, &is = refinement.objects[k].splits;
        std::set_difference(is.begin(), is.end(), was.begin(), was.end(), std::back_inserter(come));
        std::set_difference(was.begin(), was.end(), is.begin(), is.end(), std::back_inserter(gone));
      }
      EXPECT_EQ(stats.new_splits, come.size());
      EXPECT_EQ(stats.merged_splits, gone.size());
      EXPECT_GE(stats.taken_back, gone.size());
    }
    before = refinement.objects;
  }
}

// The spheres hide halves of themselves and parts of each other, so that something is hidden in every frame; and while
// the camera goes round them, some of it comes to light, takes the place of other splits, and forces others, of which
// some face away.
TEST_P(Stats, TellWhatHappensAlongThePath) {
  std::size_t readmitted = 0, taken_back = 0, forced = 0, forced_unseen = 0;
  for (int i = 0; i < frames; ++i) {
    SCOPED_TRACE(i);
    const RefineStats& stats = frame(i).stats;
    if (GetParam().occlusion) {
      EXPECT_GT(stats.culled_occlusion, 0U);
    }
    if (i == 0) continue;
    readmitted += stats.readmitted;
    taken_back += stats.taken_back;
    forced += stats.forced_splits;
    forced_unseen += stats.forced_unseen_splits;
  }
  EXPECT_GT(forced, 0U);
  EXPECT_EQ(forced_unseen > 0, GetParam().culling == Culling::star);
  const bool goes_on = GetParam().way == Way::frame_to_frame;
  if (goes_on || GetParam().occlusion) {
    EXPECT_GT(taken_back, 0U);
  }
  EXPECT_EQ(readmitted > 0, GetParam().occlusion);
}

// At rest nothing is counted as done, and what is told of the mesh stays.
TEST_P(Stats, OfACallThatChangesNothing) {
  if (GetParam().way == Way::from_scratch) GTEST_SKIP() << "refine() begins anew each time";
  RefineStats last = frame(0).stats, rest = frame(1).stats;
  for (int i = 0; i < 100 && rest.visits + rest.queries > 0; ++i) last = std::exchange(rest, frame(1).stats);
  EXPECT_EQ(rest.visits + rest.queries + rest.new_splits + rest.merged_splits + rest.forced_splits, 0U);
  EXPECT_EQ(rest.forced_unseen_splits + rest.readmitted + rest.taken_back + rest.changed_triangles, 0U);
  EXPECT_EQ(rest.nodes, last.nodes);
  EXPECT_EQ(rest.culled_frustum, last.culled_frustum);
  EXPECT_EQ(rest.culled_backface, last.culled_backface);
  EXPECT_EQ(rest.culled_occlusion, last.culled_occlusion);
  EXPECT_EQ(rest.max_error_px, last.max_error_px);
}

INSTANTIATE_TEST_SUITE_P(
    Ways, Stats,
    testing::Values(Case{Way::from_scratch, Culling::star, false}, Case{Way::from_scratch, Culling::star, true},
                    Case{Way::from_scratch, Culling::subtree, true}, Case{Way::frame_to_frame, Culling::star, false},
                    Case{Way::frame_to_frame, Culling::star, true}, Case{Way::frame_to_frame, Culling::subtree, false},
                    Case{Way::frame_to_frame, Culling::subtree, true}),
    name_of);

}  // namespace
}  // namespace occlod::test
