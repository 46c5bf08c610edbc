#include <gtest/gtest.h>

#include "splits/fan.h"

namespace occlod {
namespace {

TEST(VertexQuadric, IsTheWeightedMeanSquareDistance) {
  // Planes x = 0 with weight 3 and z = 0 with weight 1: at (2, 9, 4) the mean of the squares is (3 * 4 + 1 * 16) / 4.
  VertexQuadric q;
  q.add_plane({1, 0, 0}, 3.0F);
  q.add_plane({0, 0, 1}, 1.0F);
  q.weight = 4.0F;
  EXPECT_FLOAT_EQ(q.mean_square({2, 9, 4}), 7.0F);
  EXPECT_EQ(q.mean_square({0, 5, 0}), 0.0F);
  EXPECT_EQ(VertexQuadric{}.mean_square({1, 1, 1}), 0.0F);
}

TEST(VertexQuadric, KeepsItsPlanesWhenAddedElsewhere) {
  // The other vertex is at (0, 0, 5), so this one is at (1, 0, 7) when the offset from the other to it is (1, 0, 2).
  // The other's plane is z = 5: at this vertex + (0, 0, 1) it is 3 away.
  VertexQuadric other;
  other.add_plane({0, 0, 1}, 2.0F);
  other.weight = 2.0F;
  VertexQuadric q;
  q.add(other, {1, 0, 2});
  EXPECT_FLOAT_EQ(q.mean_square({0, 0, 1}), 9.0F);
  EXPECT_FLOAT_EQ(q.mean_square({7, 7, -2}), 0.0F);
  // And once more, to a third vertex 1 higher: there the plane is 3 away.
  VertexQuadric third;
  third.add(q, {0, 0, 1});
  EXPECT_FLOAT_EQ(third.mean_square({0, 0, 0}), 9.0F);
}

}  // namespace
}  // namespace occlod
