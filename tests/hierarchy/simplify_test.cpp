// What simplify() promises of its sequence.
#include "splits/simplify.h"

#include <gtest/gtest.h>

#include <vector>

#include "splits/face_distance.h"
#include "support/meshes.h"

namespace occlod {
namespace {

TEST(Simplify, SequenceIsOneInWhichItsCollapsesCanBeMade) {
  // A face is ended once, after it was made; a vertex that has gone is a corner of nothing that comes later.
  const TriangleMesh mesh = test::noisy_sphere(7, 4);  // several blocks, several passes
  const CollapseSequence sequence = simplify(mesh, {});
  const std::size_t collapses = sequence.collapses.size();
  std::vector<std::size_t> gone(mesh.vertex_count(), collapses);
  for (std::size_t i = 0; i < collapses; ++i) {
    EXPECT_EQ(gone[sequence.collapses[i]->v], collapses) << "a vertex goes twice";
    gone[sequence.collapses[i]->v] = i;
  }
  const LevelFaces levels(sequence);
  const auto expect_there = [&](const LevelFace& face, std::size_t i) {
    EXPECT_TRUE(face.made_by == no_id || face.made_by < i);
    for (int k = 0; k < 3; ++k) EXPECT_GE(gone[face.corners[k]], i);
  };
  for (CollapseIndex i = 0; i < collapses; ++i) {
    EXPECT_GT(gone[sequence.collapses[i]->u], i);
    for (FaceId f = levels.first_ended(i); f < levels.first_ended(i + 1); ++f)
      expect_there({levels.corners(f), levels.maker(f)}, i);
  }
  for (const LevelFace& face : sequence.base) expect_there({face.corners, sequence.place(face.made_by)}, collapses);
}

TEST(Simplify, StarsEndInRingOrder) {
  // Every star of a closed surface is one closed fan while the topology is kept, which is as long as no face without v
  // ends along.
  const TriangleMesh mesh = test::noisy_sphere(5, 4);
  const CollapseSequence sequence = simplify(mesh, {});
  for (const Collapse* collapse : sequence.collapses) {
    EXPECT_EQ(collapse->shape(), StarShape::closed_fan);
    for (std::uint32_t f = 0; f < collapse->ended_count(); ++f) {
      EXPECT_EQ(collapse->ended(f).x, collapse->v);
      EXPECT_EQ(collapse->ended(f).z, collapse->ended((f + 1) % collapse->ended_count()).y);
    }
  }
}

}  // namespace
}  // namespace occlod
