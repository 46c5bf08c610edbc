#include "splits/star_record.h"

#include <gtest/gtest.h>

#include <tuple>
#include <vector>

#include "splits/star.h"

namespace occlod {
namespace {

using Removed = std::tuple<SplitId, std::uint32_t, VertexId, VertexId, VertexId>;

struct ReadBack {
  bool is_fan = false;
  VertexId u = no_id;
  std::vector<Triangle> inserted;
  std::vector<Removed> removed;
  std::vector<SplitId> dependencies;
};

ReadBack write_and_read(const StarContents& contents, SplitId s, VertexId v) {
  std::vector<std::uint32_t> words = {77};  // records need not start the list
  append_star(contents, words);
  const std::span<const std::uint32_t> record = std::span<const std::uint32_t>(words).subspan(1);
  EXPECT_EQ(check_star(record, s, v, 1000), std::nullopt);
  const SplitStar star(record.data(), v);
  EXPECT_EQ(star.word_count(), record.size());
  EXPECT_EQ(star.inserted_count(), contents.inserted.size());
  EXPECT_EQ(star.removed_count(), contents.removed.size());
  ReadBack result;
  result.is_fan = star.is_fan();
  result.u = star.parent_vertex();
  star.for_each_inserted([&](const Triangle& t) { result.inserted.push_back(t); });
  star.for_each_removed(
      [&](const FaceRef& f, const Triangle& t) { result.removed.emplace_back(f.split, f.slot, t.x, t.y, t.z); });
  result.dependencies.assign(star.dependencies().begin(), star.dependencies().end());
  return result;
}

// Vertex 100 in the ring 10, 11, 12, 13, 14, split from 12: the two faces at 12 have no counterpart.
const std::vector<Triangle> closed_star = {{100, 10, 11}, {100, 11, 12}, {100, 12, 13}, {100, 13, 14}, {100, 14, 10}};

TEST(StarRecord, ClosedFanComesBack) {
  // Given in another order and rotation than the slots imply.
  std::vector<RemovedFace> removed = {{{7, 3}, {14, 10, 12}}, {{7, 15}, {12, 10, 11}}, {{5, 0}, {13, 14, 12}}};
  const std::vector<SplitId> dependencies = {2, 5, 7};  // 2 brings along a corner
  const ReadBack star = write_and_read({12, StarShape::closed_fan, closed_star, removed, dependencies}, 50, 100);
  EXPECT_TRUE(star.is_fan);
  EXPECT_EQ(star.u, 12U);
  EXPECT_EQ(star.inserted, closed_star);
  EXPECT_EQ(star.removed, (std::vector<Removed>{{7, 15, 12, 10, 11}, {5, 0, 12, 13, 14}, {7, 3, 12, 14, 10}}));
  EXPECT_EQ(star.dependencies, dependencies);
}

TEST(StarRecord, UFirstInTheRingMeetsTheLastFace) {
  std::vector<RemovedFace> removed = {{{1, 0}, {10, 11, 12}}, {{1, 1}, {10, 12, 13}}, {{1, 2}, {10, 13, 14}}};
  const std::vector<SplitId> dependencies = {1};
  const ReadBack star = write_and_read({10, StarShape::closed_fan, closed_star, removed, dependencies}, 50, 100);
  EXPECT_TRUE(star.is_fan);
  EXPECT_EQ(star.removed, (std::vector<Removed>{{1, 0, 10, 11, 12}, {1, 1, 10, 12, 13}, {1, 2, 10, 13, 14}}));
}

TEST(StarRecord, AFanWhoseRemovedFacesAreKnownIsWrittenAlike) {
  std::vector<RemovedFace> removed = {{{7, 15}, {12, 10, 11}}, {{5, 0}, {12, 13, 14}}, {{7, 3}, {12, 14, 10}}};
  const std::vector<SplitId> dependencies = {5, 7};
  std::vector<std::uint32_t> expected = {3}, words = {3};
  append_star({12, StarShape::closed_fan, closed_star, removed, dependencies}, expected);
  const std::vector<VertexId> ring = {10, 11, 12, 13, 14};
  std::vector<FaceRef> refs = {{7, 15}, {5, 0}, {7, 3}};
  EXPECT_TRUE(append_fan({ring, 2, refs}, words));
  EXPECT_EQ(words, expected);
  for (const FaceRef& listed : {FaceRef{no_id, 3}, FaceRef{7, 16}}) {
    refs[1] = listed;
    EXPECT_FALSE(append_fan({ring, 2, refs}, words));
    EXPECT_EQ(words, expected);
  }
}

TEST(StarRecord, OpenFanHasOneFaceLessThanItsRing) {
  const std::vector<Triangle> inserted = {{100, 10, 11}, {100, 11, 12}, {100, 12, 13}};
  std::vector<RemovedFace> removed = {{{3, 1}, {13, 10, 11}}, {{4, 2}, {13, 11, 12}}};
  const std::vector<SplitId> dependencies = {3, 4};
  const ReadBack star = write_and_read({13, StarShape::open_fan, inserted, removed, dependencies}, 50, 100);
  EXPECT_TRUE(star.is_fan);
  EXPECT_EQ(star.inserted, inserted);
  EXPECT_EQ(star.removed, (std::vector<Removed>{{3, 1, 13, 10, 11}, {4, 2, 13, 11, 12}}));
}

// What a fan cannot say is listed: faces of the base mesh, late slots, faces that no place in the ring implies.
TEST(StarRecord, AnythingElseComesBackAsItIs) {
  const std::vector<SplitId> dependencies = {5};
  const auto expect_listed = [&](RemovedFace changed) {
    std::vector<RemovedFace> removed = {{{5, 3}, {12, 10, 11}}, {{5, 4}, {12, 13, 14}}, changed};
    const ReadBack star = write_and_read({12, StarShape::closed_fan, closed_star, removed, dependencies}, 50, 100);
    EXPECT_FALSE(star.is_fan);
    EXPECT_EQ(star.u, 12U);
    EXPECT_EQ(star.inserted, closed_star);
    const Triangle& t = changed.corners;
    EXPECT_EQ(star.removed.back(), Removed(changed.ref.split, changed.ref.slot, t.x, t.y, t.z));
    EXPECT_EQ(star.dependencies, dependencies);
  };
  expect_listed({{no_id, 3}, {12, 14, 10}});
  expect_listed({{5, 16}, {12, 14, 10}});
  expect_listed({{5, 5}, {12, 10, 14}});  // turned over
  expect_listed({{5, 5}, {20, 21, 22}});
}

TEST(StarRecord, AComponentThatComesBackRemovesNothing) {
  const std::vector<Triangle> inserted = {{100, 10, 11}};
  const ReadBack star = write_and_read({10, StarShape::open_fan, inserted, {}, {}}, 50, 100);
  EXPECT_EQ(star.inserted, inserted);
  EXPECT_TRUE(star.removed.empty());
}

}  // namespace
}  // namespace occlod
