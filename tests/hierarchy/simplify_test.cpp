// What simplify() promises of its sequence.
#include "hierarchy/simplify.h"

#include <gtest/gtest.h>

#include <vector>

#include "support/meshes.h"

namespace occlod {
namespace {

TEST(Simplify, SequenceIsOneInWhichItsCollapsesCanBeMade) {
  // A face is ended once, after it was made; a vertex that has gone is a corner of nothing that comes later.
  const TriangleMesh mesh = test::noisy_sphere(7, 4);  // several blocks, several passes
  const CollapseSequence sequence = simplify(mesh, {});
  const std::size_t collapses = sequence.collapses.size() - 1;
  std::vector<std::size_t> gone(mesh.vertex_count(), collapses);
  for (std::size_t i = 0; i < collapses; ++i) {
    EXPECT_EQ(sequence.collapses[i].id, i);
    EXPECT_EQ(gone[sequence.collapses[i].v], collapses) << "a vertex goes twice";
    gone[sequence.collapses[i].v] = i;
  }
  const auto expect_there = [&](const LevelFace& face, std::size_t i) {
    EXPECT_TRUE(face.made_by == no_id || face.made_by < i);
    for (int k = 0; k < 3; ++k) EXPECT_GE(gone[face.corners[k]], i);
  };
  for (std::size_t i = 0; i < collapses; ++i) {
    EXPECT_GT(gone[sequence.collapses[i].u], i);
    for (std::size_t f = sequence.collapses[i].first_ended; f < sequence.collapses[i + 1].first_ended; ++f)
      expect_there(sequence.ended[f], i);
  }
  for (const LevelFace& face : sequence.base) expect_there(face, collapses);
}

TEST(Simplify, StarsEndInRingOrder) {
  // Every star of a closed surface is one closed fan while the topology is kept, which is as long as no face without v
  // ends along.
  const TriangleMesh mesh = test::noisy_sphere(5, 4);
  const CollapseSequence sequence = simplify(mesh, {});
  for (std::size_t i = 0; i + 1 < sequence.collapses.size(); ++i) {
    const std::size_t begin = sequence.collapses[i].first_ended, end = sequence.collapses[i + 1].first_ended;
    for (std::size_t f = begin; f < end; ++f) {
      EXPECT_EQ(sequence.ended[f].corners.x, sequence.collapses[i].v);
      const std::size_t next = f + 1 == end ? begin : f + 1;
      EXPECT_EQ(sequence.ended[f].corners.z, sequence.ended[next].corners.y);
    }
  }
}

}  // namespace
}  // namespace occlod
