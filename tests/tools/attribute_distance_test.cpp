// Texture slip, normals and colours, on meshes whose numbers can be worked out by hand.
#include "measure/attribute_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "measure/surface_distance.h"
#include "support/meshes.h"

namespace occlod::measure {
namespace {

constexpr double two_pi = 6.28318530717958647692;

// `texture` of each position.
template <typename Function>
TriangleMesh textured(TriangleMesh mesh, const Function& texture) {
  for (const glm::vec3& p : mesh.positions) mesh.texture_coordinates.push_back(texture(p));
  return mesh;
}

TriangleMesh plane(glm::vec2 shift = {0, 0}, int cells = 8) {
  return textured(test::grid(cells, cells), [&](const glm::vec3& p) { return glm::vec2(p) + shift; });
}

TextureSlip slip(const TriangleMesh& a, const TriangleMesh& b, const AttributeOptions& options = {20'000, 1, 0.1}) {
  return *attribute_distance(a, b, options).texture;
}

// The unit square as two halves that share no wedge: the vertices of the border have one on either side. Texture of the
// left half: the position; of the right one: `offset` beside it. The border is at column `border` of 8.
TriangleMesh two_charts(int border, glm::vec2 offset) {
  TriangleMesh mesh = plane();
  mesh.corners = mesh.triangles;
  std::vector<WedgeId> right(mesh.positions.size());
  for (VertexId v = 0; v < right.size(); ++v) right[v] = v;
  for (VertexId v = 0; v < right.size(); ++v) {
    const int column = static_cast<int>(v) % 9;
    if (column > border) mesh.texture_coordinates[v] += offset;
    if (column != border) continue;
    right[v] = static_cast<WedgeId>(mesh.positions.size());
    mesh.extra_wedges.push_back(v);
    mesh.positions.push_back(mesh.positions[v]);
    mesh.texture_coordinates.push_back(mesh.texture_coordinates[v] + offset);
  }
  for (std::size_t t = 0; t < mesh.corners.size(); ++t) {
    if (static_cast<int>(t) / 2 % 8 < border) continue;
    for (int i = 0; i < 3; ++i) mesh.corners[t][i] = right[mesh.triangles[t][i]];
  }
  return mesh;
}

TEST(TextureSlip, OfAMeshFromItselfIsRounding) {
  const TriangleMesh mesh = textured(test::noisy_sphere(4, 1), [](const glm::vec3& p) {
    return glm::vec2(std::atan2(p.y, p.x), p.z);  // jumps where p.y is 0 and p.x < 0
  });
  const TextureSlip same = slip(mesh, mesh);
  EXPECT_LT(same.max, 1e-9);
  EXPECT_EQ(same.lost, 0U);
}

// A cut-up square, two triangles instead of 128, shows every texel where it was.
TEST(TextureSlip, FollowsTheTextureNotTheTriangles) { EXPECT_LT(slip(plane(), plane({0, 0}, 1)).max, 1e-7); }

// The texel at (x, y) is now at (x - d, y), also as the texture goes on beyond the border: d for every sample.
TEST(TextureSlip, OfAShiftedTextureIsTheShift) {
  const TextureSlip shifted = slip(plane(), plane({0.03F, 0.0F}, 3));
  EXPECT_NEAR(shifted.rms, 0.03, 1e-6);
  EXPECT_NEAR(shifted.max, 0.03, 1e-6);
  EXPECT_EQ(shifted.lost, 0U);
  EXPECT_NEAR(shifted.radius, 0.1 * std::sqrt(2.0), 1e-9);
}

// Lengths are those of the surface, not of the texture: stretched 10 to 1, a shift by 0.003 along the stretch is 0.03,
// and one by 0.03 across it is that.
TEST(TextureSlip, IsALengthOnTheSurface) {
  const auto stretched = [](glm::vec2 shift) {
    return textured(test::grid(4, 4), [&](const glm::vec3& p) { return glm::vec2(p.x / 10.0F, p.y) + shift; });
  };
  EXPECT_NEAR(slip(stretched({0, 0}), stretched({0.003F, 0.0F})).rms, 0.03, 1e-5);
  EXPECT_NEAR(slip(stretched({0, 0}), stretched({0.0F, 0.03F})).rms, 0.03, 1e-5);
}

// Turned by one of n steps, a regular n-gon lies on itself: the point at radius r has moved by 2 r sin(pi / n). Over a
// triangle 0, p, q the mean of r^2 is (|p|^2 + |q|^2 + p . q) / 6 = (2 + cos(2 pi / n)) / 6 for a radius of 1.
TEST(TextureSlip, OfATurnedChart) {
  constexpr int n = 40;
  const auto turned = [](double angle) {
    return textured(test::fan(n), [=](const glm::vec3& p) {
      return glm::vec2(std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y);
    });
  };
  const TextureSlip measured = slip(turned(0.0), turned(two_pi / n));
  const double step = 2.0 * std::sin(two_pi / n / 2.0);
  EXPECT_NEAR(measured.max, step, 0.01 * step);
  EXPECT_LE(measured.max, step + 1e-6);
  EXPECT_NEAR(measured.rms, step * std::sqrt((2.0 + std::cos(two_pi / n)) / 6.0), 0.005 * step);
  EXPECT_EQ(measured.lost, 0U);
}

// The border between the charts is a column, 1/8, further left or right in B than in A. A texel at s <= 1/8 from B's
// border, in the wrong chart, is nearest at the border: s along the surface and s in the texture. Mean square over the
// square: the integral of (2 s)^2 over 0..1/8 = 4 / 3 / 8^3.
TEST(TextureSlip, JumpsAcrossASeamAreNoLengths) {
  const glm::vec2 far{100.0F, 0.0F};
  for (const int border : {3, 5}) {
    const TextureSlip measured = slip(two_charts(4, far), two_charts(border, far), {20'000, 1, 0.5});
    EXPECT_NEAR(measured.rms, std::sqrt(4.0 / 3.0 / 512.0), 1e-3) << border;
    EXPECT_NEAR(measured.max, 2.0 / 8.0, 1e-2) << border;
    EXPECT_EQ(measured.lost, 0U) << border;
  }
  EXPECT_LT(slip(two_charts(4, far), two_charts(4, far)).max, 1e-6);
}

// Both halves show the same texels, but in two materials, which change places in B: each texel is 0.5 away. Farther
// than the search goes it is lost, and counts as the radius.
TEST(TextureSlip, TexelsBelongToMaterials) {
  const auto halves = [](MaterialId left, MaterialId right) {
    TriangleMesh mesh = two_charts(4, {-0.5F, 0.0F});
    mesh.materials = {{.name = "stone"}, {.name = "wood"}};
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      mesh.triangle_materials.push_back(t / 2 % 8 < 4 ? left : right);
    return mesh;
  };
  const TriangleMesh a = halves(0, 1), b = halves(1, 0);
  EXPECT_LT(slip(a, a).max, 1e-7);
  const TextureSlip found = slip(a, b, {20'000, 1, 0.5});
  EXPECT_NEAR(found.rms, 0.5, 1e-6);
  EXPECT_NEAR(found.max, 0.5, 1e-6);
  const TextureSlip lost = slip(a, b, {20'000, 1, 0.1});
  EXPECT_EQ(lost.lost, 20'000U);
  EXPECT_NEAR(lost.rms, lost.radius, 1e-12);
  // By their names, not their numbers.
  TriangleMesh renamed = b;
  std::swap(renamed.materials[0], renamed.materials[1]);
  EXPECT_LT(slip(a, renamed).max, 1e-7);
  // A material that is not there at all.
  TriangleMesh gone = a;
  gone.materials[0].name = "stone";
  gone.triangle_materials.assign(gone.triangles.size(), 1);
  EXPECT_NEAR(static_cast<double>(slip(a, gone).lost), 10'000.0, 1.0);
}

// v counts from the bottom in one file and from the top in the other.
TEST(TextureSlip, OriginsMayDiffer) {
  TriangleMesh mirrored = plane();
  mirrored.texture_origin = TextureOrigin::top_left;
  for (glm::vec2& t : mirrored.texture_coordinates) t.y = 1.0F - t.y;
  EXPECT_LT(slip(plane(), mirrored).max, 1e-6);
}

// Where A's texture has no area there is no gradient, and every texel is the same: nothing can slip.
TEST(TextureSlip, OfOneTexelIsNone) {
  const TriangleMesh one = textured(test::grid(3, 3), [](const glm::vec3&) { return glm::vec2(0.5F); });
  EXPECT_LT(slip(one, one).max, 1e-12);
}

TEST(AttributeDistance, SameSeedSameNumbers) {
  const TriangleMesh a = textured(test::noisy_sphere(3, 1), [](const glm::vec3& p) { return glm::vec2(p); });
  const TriangleMesh b = textured(test::noisy_sphere(3, 2), [](const glm::vec3& p) { return glm::vec2(p); });
  EXPECT_EQ(slip(a, b, {1000, 7}).rms, slip(a, b, {1000, 7}).rms);
  EXPECT_NE(slip(a, b, {1000, 7}).rms, slip(a, b, {1000, 8}).rms);
}

// What a mesh does not have is not measured.
TEST(AttributeDistance, OfWhatBothHave) {
  const AttributeDistance none = attribute_distance(test::grid(2, 2), plane());
  EXPECT_FALSE(none.texture || none.normals || none.colors);
}

// Normals that lean by 0.1 radians everywhere; colours that differ by 0.2 in one of three channels.
TEST(AttributeDistance, OfNormalsAndColors) {
  TriangleMesh a = test::grid(2, 2), b = test::grid(3, 3);
  a.normals.assign(a.positions.size(), {0.0F, 0.0F, 1.0F});
  b.normals.assign(b.positions.size(), {std::sin(0.1F), 0.0F, std::cos(0.1F)});
  a.colors.assign(a.positions.size(), {51, 0, 102, 255});
  b.colors.assign(b.positions.size(), {102, 0, 102, 255});
  const AttributeDistance distance = attribute_distance(a, b, {1000, 1});
  EXPECT_NEAR(distance.normals->rms, 0.1 * 360.0 / two_pi, 1e-4);
  EXPECT_NEAR(distance.normals->max, 0.1 * 360.0 / two_pi, 1e-4);
  EXPECT_NEAR(distance.colors->rms, 0.2 / std::sqrt(3.0), 1e-12);
  EXPECT_FALSE(distance.texture);
}

// Two sheets in one place that face apart: of the points of B that are equally near, the one that fits counts.
TEST(AttributeDistance, OfEquallyNearPointsTheBestCounts) {
  TriangleMesh sheets = test::grid(1, 1);
  sheets.normals.assign(4, {0.0F, 0.0F, 1.0F});
  TriangleMesh back = test::grid(1, 1);
  for (Triangle& t : back.triangles) t = {t.x, t.z, t.y};
  test::append(sheets, back, {0, 0, 0});
  sheets.normals.resize(8, {0.0F, 0.0F, -1.0F});
  EXPECT_LT(attribute_distance(sheets, sheets, {1000, 1}).normals->max, 1e-6);
}

}  // namespace
}  // namespace occlod::measure
