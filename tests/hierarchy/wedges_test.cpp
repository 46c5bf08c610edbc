// Hierarchies of meshes with seams: texture coordinates, hard normals, colours, materials.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>

#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "support/meshes.h"
#include "support/wedge_meshes.h"

namespace occlod {
namespace {

using test::sorted_corners_of;

Hierarchy build(const TriangleMesh& mesh, std::size_t base_triangles, double attribute_weight = 1.0) {
  BuildOptions options;
  options.base_triangles = base_triangles;
  options.attribute_weight = attribute_weight;
  return build_hierarchy(mesh, options);
}

TriangleMesh with_triangles(const Hierarchy& hierarchy, std::size_t triangles) {
  return cut_mesh(hierarchy, cut_to_triangles(hierarchy, triangles));
}

// The length of edges at which the wedges of the two faces differ, each edge once.
double seam_length(const TriangleMesh& mesh) {
  std::map<std::pair<VertexId, VertexId>, std::pair<WedgeId, WedgeId>> sides;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k)
      sides[{mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]}] = {mesh.wedge_triangles()[t][k],
                                                                       mesh.wedge_triangles()[t][(k + 1) % 3]};
  double length = 0.0;
  for (const auto& [edge, wedges] : sides) {
    const auto other = sides.find({edge.second, edge.first});
    if (edge.first > edge.second || other == sides.end()) continue;
    if (other->second != std::pair(wedges.second, wedges.first))
      length += static_cast<double>(glm::distance(mesh.positions[edge.first], mesh.positions[edge.second]));
  }
  return length;
}

TEST(Wedges, FullRefinementGivesBackEveryCornerOfRandomSoups) {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const TriangleMesh mesh = test::random_soup_with_wedges(seed);
    const Hierarchy hierarchy = build(mesh, seed % 3 == 0 ? 0 : 8);
    ASSERT_EQ(validate(hierarchy), std::vector<std::string>{}) << "seed " << seed;
    ASSERT_TRUE(sorted_corners_of(cut_mesh(hierarchy, full_cut(hierarchy))) == sorted_corners_of(mesh))
        << "seed " << seed;
  }
}

TEST(Wedges, CutsOfRandomSoupsAreMeshesThatCanBeBuilt) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const TriangleMesh mesh = test::random_soup_with_wedges(seed);
    const Hierarchy hierarchy = build(mesh, 0);
    for (const std::size_t triangles : {mesh.triangle_count() / 4, mesh.triangle_count() / 2}) {
      const TriangleMesh cut = with_triangles(hierarchy, triangles);
      if (cut.triangle_count() == 0) continue;
      const Hierarchy again = build(cut, 0);
      ASSERT_TRUE(sorted_corners_of(cut_mesh(again, full_cut(again))) == sorted_corners_of(cut)) << "seed " << seed;
    }
  }
}

TEST(Wedges, NothingDependsOnThreads) {
  const TriangleMesh mesh = test::grid_of_charts(
      120, [](int i, int j) { return (i / 10) * 12 + j / 10; }, [](int i, int) { return i / 40; });
  BuildOptions options;
  options.threads = 1;
  const Hierarchy one = build_hierarchy(mesh, options);
  options.threads = 4;
  const Hierarchy four = build_hierarchy(mesh, options);
  EXPECT_TRUE(std::ranges::equal(one.data().corners, four.data().corners));
  EXPECT_TRUE(std::ranges::equal(one.data().extra_wedges, four.data().extra_wedges));
  EXPECT_TRUE(std::ranges::equal(one.data().texture_coordinates, four.data().texture_coordinates));
  EXPECT_TRUE(std::ranges::equal(one.data().attribute_errors, four.data().attribute_errors));
  EXPECT_EQ(validate(one), std::vector<std::string>{});
}

TEST(Wedges, ASeamOfACylinderStaysStraight) {
  const TriangleMesh mesh = test::cylinder_with_seam(64, 64);
  ASSERT_EQ(mesh.extra_wedges.size(), 65U);
  EXPECT_NEAR(seam_length(mesh), 4.0, 1e-5);
  const Hierarchy hierarchy = build(mesh, 64);
  EXPECT_NEAR(seam_length(with_triangles(hierarchy, 400)), 4.0, 1e-5);
  // Only the input's wedges: no chart had to be stretched.
  EXPECT_EQ(hierarchy.data().extra_wedges.size() + hierarchy.vertex_count(), mesh.wedge_count());
}

TEST(Wedges, ACubeKeepsItsEdgesAndChartsDownToTwelveTriangles) {
  const TriangleMesh mesh = test::cube_of_charts(16);
  const Hierarchy hierarchy = build(mesh, 12);
  const TriangleMesh coarse = with_triangles(hierarchy, 12);
  ASSERT_EQ(coarse.triangle_count(), 12U);
  EXPECT_NEAR(seam_length(coarse), 12.0, 1e-5);
  for (std::size_t t = 0; t < 12; ++t)
    for (int k = 0; k < 3; ++k) {
      const WedgeId w = coarse.wedge_triangles()[t][k];
      EXPECT_EQ(coarse.normals[w], coarse.normals[coarse.wedge_triangles()[t].x]);
    }
  EXPECT_LT(hierarchy.attribute_error(0), 1e-5F);
}

// V - E + F of each chart: faces that share wedges.
std::vector<int> euler_characteristics(const TriangleMesh& mesh) {
  std::vector<WedgeId> chart(mesh.wedge_count());
  for (WedgeId w = 0; w < chart.size(); ++w) chart[w] = w;
  const auto root = [&](WedgeId w) {
    while (chart[w] != w) w = chart[w];
    return w;
  };
  for (const Triangle& t : mesh.wedge_triangles()) chart[root(t.y)] = chart[root(t.z)] = root(t.x);
  std::map<WedgeId, int> characteristics;
  for (WedgeId w = 0; w < chart.size(); ++w) ++characteristics[root(w)];
  std::map<std::pair<WedgeId, WedgeId>, int> edges;
  for (const Triangle& t : mesh.wedge_triangles()) {
    ++characteristics[root(t.x)];
    for (int k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
  }
  for (const auto& [edge, count] : edges) --characteristics[root(edge.first)];
  std::vector<int> result;
  for (const auto& [w, characteristic] : characteristics) result.push_back(characteristic);
  return result;
}

TEST(Wedges, ChartsStayDiscs) {
  const Hierarchy cube = build(test::cube_of_charts(16), 12);
  for (const std::size_t triangles : {12U, 30U, 100U, 700U, 3072U})
    EXPECT_EQ(euler_characteristics(with_triangles(cube, triangles)), std::vector<int>(6, 1)) << triangles;
  // Sixteen squares in a plane, where only textures ask for their outlines.
  const Hierarchy grid = build(test::grid_of_charts(
                                   32, [](int i, int j) { return (i / 8) * 4 + j / 8; }, [](int, int) { return 0; }),
                               8);
  for (const std::size_t triangles : {60U, 200U, 2048U})
    EXPECT_EQ(euler_characteristics(with_triangles(grid, triangles)), std::vector<int>(16, 1)) << triangles;
}

TEST(Wedges, AttributesAreWorthTrianglesWhereTheSurfaceIsFlat) {
  // Any triangle of a plane can go, but the texture is stretched more and more to the right.
  TriangleMesh mesh = test::grid_of_charts(
      40, [](int, int) { return 0; }, [](int, int) { return 0; });
  for (glm::vec2& t : mesh.texture_coordinates) t.x = t.x * t.x * t.x;
  const auto worst = [&](double weight) {
    const Hierarchy hierarchy = build(mesh, 0, weight);
    const TriangleMesh cut = with_triangles(hierarchy, 60);
    double largest = 0.0;  // between the texture and what the middle of an edge should have
    for (const Triangle& t : cut.triangles)
      for (int k = 0; k < 3; ++k) {
        const VertexId a = t[k], b = t[(k + 1) % 3];
        const double x = 0.5 * (static_cast<double>(cut.positions[a].x) + static_cast<double>(cut.positions[b].x));
        const double found = 0.5 * (static_cast<double>(cut.texture_coordinates[a].x) +
                                    static_cast<double>(cut.texture_coordinates[b].x));
        largest = std::max(largest, std::abs(found - x * x * x));
      }
    return largest;
  };
  EXPECT_LT(worst(1.0), 0.1 * worst(0.0));
}

// Returns the value that a flat mesh interpolates at p, from one value per vertex.
template <typename T>
T value_at(const TriangleMesh& mesh, const std::vector<T>& values, const glm::vec2& p) {
  T nearest{};
  float most_inside = -std::numeric_limits<float>::infinity();
  for (const Triangle& t : mesh.triangles) {
    const glm::vec2 o(mesh.positions[t.x]), a = glm::vec2(mesh.positions[t.y]) - o,
                                            b = glm::vec2(mesh.positions[t.z]) - o, q = p - o;
    const float area = a.x * b.y - a.y * b.x;
    if (!(area > 0.0F)) continue;
    const float y = (q.x * b.y - q.y * b.x) / area, z = (a.x * q.y - a.y * q.x) / area, x = 1.0F - y - z;
    if (const float inside = std::min({x, y, z}); inside > most_inside) {
      most_inside = inside;
      nearest = x * values[t.x] + y * values[t.y] + z * values[t.z];
    }
  }
  return nearest;
}

// A flat sheet of 45 x 45 cells; `paint(vertex, distance from the middle)` sets its attributes.
template <typename Paint>
TriangleMesh painted_sheet(const Paint& paint) {
  TriangleMesh mesh = test::grid(45, 45);
  for (VertexId v = 0; v < mesh.vertex_count(); ++v)
    paint(mesh, v, glm::distance(glm::vec2(mesh.positions[v]), glm::vec2(0.5F)));
  return mesh;
}

// The root of the mean squared difference between two meshes over the middles of the triangles of `mesh`.
template <typename T>
double rms_difference(const TriangleMesh& mesh, const std::vector<T>& values, const TriangleMesh& other,
                      const std::vector<T>& other_values) {
  double sum = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const glm::vec3 middle = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0F;
    const T change =
        (values[t.x] + values[t.y] + values[t.z]) / 3.0F - value_at(other, other_values, glm::vec2(middle));
    sum += static_cast<double>(glm::dot(change, change));
  }
  return std::sqrt(sum / static_cast<double>(mesh.triangle_count()));
}

std::vector<glm::vec3> colors_of(const TriangleMesh& mesh) {
  std::vector<glm::vec3> colors;
  for (const glm::u8vec4& c : mesh.colors) colors.push_back(glm::vec3(c) / 255.0F);
  return colors;
}

TEST(Wedges, ColorsWeighWithoutTextureCoordinates) {
  const TriangleMesh mesh = painted_sheet([](TriangleMesh& sheet, VertexId, float distance) {
    sheet.colors.push_back(distance < 0.1F   ? glm::u8vec4(255, 0, 0, 255)
                           : distance < 0.3F ? glm::u8vec4(255, 255, 255, 255)
                                             : glm::u8vec4(51, 153, 51, 255));
  });
  const Hierarchy hierarchy = build(mesh, 64);
  const FixedCut cut = cut_to_triangles(hierarchy, 500);
  const TriangleMesh coarse = cut_mesh(hierarchy, cut);
  EXPECT_LT(rms_difference(mesh, colors_of(mesh), coarse, colors_of(coarse)), 0.04);
  const FixedCut coarsest = cut_to_triangles(hierarchy, 64);
  EXPECT_GT(coarsest.error, 0.001F) << "the surface is flat, but the discs are not there";
  EXPECT_GT(cut_to_error(hierarchy, 1e-4).triangles, 64U);
}

TEST(Wedges, NormalsWeighWithoutTextureCoordinates) {
  const TriangleMesh mesh = painted_sheet([](TriangleMesh& sheet, VertexId, float distance) {
    const float slope = distance < 0.3F ? 1.0F : 0.0F;
    sheet.normals.push_back(glm::normalize(glm::vec3(slope, 0.0F, 1.0F)));
  });
  const Hierarchy hierarchy = build(mesh, 64);
  const TriangleMesh coarse = cut_mesh(hierarchy, cut_to_triangles(hierarchy, 500));
  EXPECT_LT(rms_difference(mesh, mesh.normals, coarse, coarse.normals), 0.06);
  EXPECT_GT(cut_to_triangles(hierarchy, 64).error, 0.001F);
}

TEST(Wedges, ALineOfTheTextureHasNoLengthToSlip) {
  // The texture of the right half is a line, but for rounding: its area there says nothing of lengths.
  TriangleMesh mesh = test::grid_of_charts(
      24, [](int i, int) { return i < 12 ? 0 : 1; }, [](int, int) { return 0; });
  for (std::size_t w = 0; w < mesh.wedge_count(); ++w)
    if (glm::vec2& at = mesh.texture_coordinates[w]; at.x > 2.0F) at.x = w % 2 == 0 ? 1e-6F : 0.0F;
  const Hierarchy hierarchy = build(mesh, 4);
  EXPECT_EQ(with_triangles(hierarchy, 4).triangle_count(), 4U);
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) ASSERT_LT(hierarchy.attribute_error(s), 1e-5F) << s;
}

TEST(Wedges, EveryTriangleItsOwnChartIsNeverStuck) {
  TriangleMesh sphere = test::noisy_sphere(3, 7);
  std::vector<std::array<test::CornerAttributes, 3>> corners;
  for (std::size_t t = 0; t < sphere.triangle_count(); ++t) {
    const auto x = static_cast<float>(t);
    corners.push_back({{{.texture = {x, 0.0F}}, {.texture = {x + 0.5F, 0.0F}}, {.texture = {x, 0.5F}}}});
  }
  const TriangleMesh mesh = test::with_wedges(sphere.positions, sphere.triangles, corners);
  const Hierarchy hierarchy = build(mesh, 64);
  EXPECT_LE(hierarchy.base_triangle_count(), 64U);
  EXPECT_EQ(validate(hierarchy), std::vector<std::string>{});
  EXPECT_TRUE(sorted_corners_of(cut_mesh(hierarchy, full_cut(hierarchy))) == sorted_corners_of(mesh));
}

TEST(Wedges, FacesKeepTheirMaterials) {
  const TriangleMesh mesh = test::grid_of_charts(
      32, [](int, int) { return 0; }, [](int i, int j) { return (i < 16 ? 0 : 1) + (j < 16 ? 0 : 2); });
  const Hierarchy hierarchy = build(mesh, 8);
  for (const std::size_t triangles : {8U, 50U, 500U}) {
    const TriangleMesh cut = with_triangles(hierarchy, triangles);
    std::array<double, 4> area{};
    for (std::size_t t = 0; t < cut.triangle_count(); ++t) {
      const glm::vec3 a = cut.positions[cut.triangles[t].x];
      area[cut.material_of(t)] +=
          0.5 * static_cast<double>(glm::length(
                    glm::cross(cut.positions[cut.triangles[t].y] - a, cut.positions[cut.triangles[t].z] - a)));
    }
    for (const double share : area) EXPECT_NEAR(share, 0.25, 1e-6) << triangles;
  }
}

TEST(Wedges, ASeamThatEndsInsideTheSurface) {
  // A slit of the texture from the left side to the middle: above it another chart than below it.
  std::vector<std::array<test::CornerAttributes, 3>> corners;
  TriangleMesh grid = test::grid_of_charts(
      16, [](int, int) { return 0; }, [](int, int) { return 0; });
  for (const Triangle& t : grid.triangles) {
    std::array<test::CornerAttributes, 3> attributes;
    const float middle = (grid.positions[t.x].y + grid.positions[t.y].y + grid.positions[t.z].y) / 3.0F;
    for (int k = 0; k < 3; ++k) {
      const glm::vec3 p = grid.positions[t[k]];
      const float gap = p.x < 0.5F ? (0.5F - p.x) * (middle > 0.5F ? 0.2F : -0.2F) : 0.0F;
      attributes[static_cast<std::size_t>(k)].texture = {p.x, p.y + gap};
    }
    corners.push_back(attributes);
  }
  const TriangleMesh mesh = test::with_wedges(
      {grid.positions.begin(), grid.positions.begin() + static_cast<std::ptrdiff_t>(grid.vertex_count())},
      grid.triangles, corners);
  ASSERT_EQ(mesh.extra_wedges.size(), 8U);
  EXPECT_NEAR(seam_length(mesh), 0.5, 1e-6);
  const Hierarchy hierarchy = build(mesh, 4);
  EXPECT_EQ(validate(hierarchy), std::vector<std::string>{});
  EXPECT_TRUE(sorted_corners_of(cut_mesh(hierarchy, full_cut(hierarchy))) == sorted_corners_of(mesh));
  EXPECT_NEAR(seam_length(with_triangles(hierarchy, 60)), 0.5, 1e-6);
}

TEST(Wedges, AVertexWithThreeHundredWedges) {
  // A cone whose faces are charts of their own, and whose apex has as many wedges.
  constexpr int around = 300;
  std::vector<glm::vec3> positions{{0.0F, 0.0F, 1.0F}};
  std::vector<Triangle> triangles;
  std::vector<std::array<test::CornerAttributes, 3>> corners;
  for (int i = 0; i < around; ++i) {
    const float angle = 6.2831853F * static_cast<float>(i) / static_cast<float>(around);
    positions.emplace_back(std::cos(angle), std::sin(angle), 0.0F);
    triangles.emplace_back(0, 1 + i, 1 + (i + 1) % around);
    const auto x = static_cast<float>(i);
    corners.push_back({{{.texture = {x, 0.0F}}, {.texture = {x, 1.0F}}, {.texture = {x + 1.0F, 1.0F}}}});
  }
  const TriangleMesh mesh = test::with_wedges(positions, triangles, corners);
  ASSERT_EQ(mesh.extra_wedges.size(), 300U);  // 299 at the apex, one where the texture ends
  const Hierarchy hierarchy = build(mesh, 4);
  EXPECT_EQ(validate(hierarchy), std::vector<std::string>{});
  EXPECT_TRUE(sorted_corners_of(cut_mesh(hierarchy, full_cut(hierarchy))) == sorted_corners_of(mesh));
  EXPECT_LE(hierarchy.base_triangle_count(), 4U);
}

TEST(Wedges, AMoebiusStripWithATexture) {
  constexpr int around = 60;
  std::vector<glm::vec3> positions;
  for (int i = 0; i < around; ++i)
    for (const float side : {-0.3F, 0.3F}) {
      const float angle = 6.2831853F * static_cast<float>(i) / around;
      const float r = 1.0F + side * std::cos(angle / 2.0F);
      positions.emplace_back(r * std::cos(angle), r * std::sin(angle), side * std::sin(angle / 2.0F));
    }
  std::vector<Triangle> triangles;
  std::vector<std::array<test::CornerAttributes, 3>> corners;
  const auto vertex = [&](int i, int side) { return static_cast<VertexId>(i < around ? 2 * i + side : 1 - side); };
  const auto texture = [&](int i, int side) {
    return test::CornerAttributes{.texture = {static_cast<float>(i) / around, static_cast<float>(side)}};
  };
  for (int i = 0; i < around; ++i) {
    triangles.emplace_back(vertex(i, 0), vertex(i + 1, 0), vertex(i + 1, 1));
    corners.push_back({texture(i, 0), texture(i + 1, 0), texture(i + 1, 1)});
    triangles.emplace_back(vertex(i, 0), vertex(i + 1, 1), vertex(i, 1));
    corners.push_back({texture(i, 0), texture(i + 1, 1), texture(i, 1)});
  }
  const TriangleMesh mesh = test::with_wedges(positions, triangles, corners);
  ASSERT_EQ(mesh.extra_wedges.size(), 2U);
  const Hierarchy hierarchy = build(mesh, 8);
  EXPECT_EQ(validate(hierarchy), std::vector<std::string>{});
  EXPECT_TRUE(sorted_corners_of(cut_mesh(hierarchy, full_cut(hierarchy))) == sorted_corners_of(mesh));
}

TEST(Wedges, AnEdgeWithThreeFacesAndThreeCharts) {
  std::vector<glm::vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<std::array<test::CornerAttributes, 3>> corners;
  constexpr int along = 20;
  for (int j = 0; j <= along; ++j) {
    const float z = static_cast<float>(j);
    positions.emplace_back(0.0F, 0.0F, z);
    for (int fin = 0; fin < 3; ++fin)
      positions.emplace_back(9.0F * std::cos(2.0F * static_cast<float>(fin)),
                             9.0F * std::sin(2.0F * static_cast<float>(fin)), z);
  }
  for (int j = 0; j < along; ++j)
    for (int fin = 0; fin < 3; ++fin) {
      const auto a = static_cast<VertexId>(4 * j), b = a + 1 + static_cast<VertexId>(fin);
      const auto t = [&](VertexId v, float x) {
        return test::CornerAttributes{.texture = {x + 2.0F * static_cast<float>(fin), positions[v].z / along}};
      };
      triangles.emplace_back(a, b, b + 4);
      corners.push_back({t(a, 0.0F), t(b, 1.0F), t(b + 4, 1.0F)});
      triangles.emplace_back(a, b + 4, a + 4);
      corners.push_back({t(a, 0.0F), t(b + 4, 1.0F), t(a + 4, 0.0F)});
    }
  const TriangleMesh mesh = test::with_wedges(positions, triangles, corners);
  ASSERT_EQ(mesh.extra_wedges.size(), 2U * (along + 1));
  const Hierarchy hierarchy = build(mesh, 6);
  EXPECT_EQ(validate(hierarchy), std::vector<std::string>{});
  EXPECT_TRUE(sorted_corners_of(cut_mesh(hierarchy, full_cut(hierarchy))) == sorted_corners_of(mesh));
  const TriangleMesh coarse = with_triangles(hierarchy, 6);
  EXPECT_EQ(coarse.triangle_count(), 6U);
  EXPECT_EQ(coarse.extra_wedges.size(), 4U);  // two at each end of the edge
}

TEST(Wedges, AMirroredChart) {
  // Two charts with the same texture, one of them turned over, as artists save space.
  TriangleMesh mesh = test::grid_of_charts(
      24, [](int i, int) { return i < 12 ? 0 : 1; }, [](int, int) { return 0; });
  for (glm::vec2& t : mesh.texture_coordinates) t.x = t.x >= 2.0F ? 1.0F - (t.x - 2.0F) : t.x;
  const Hierarchy hierarchy = build(mesh, 4);
  EXPECT_EQ(validate(hierarchy), std::vector<std::string>{});
  const TriangleMesh coarse = with_triangles(hierarchy, 4);
  for (std::size_t w = 0; w < coarse.wedge_count(); ++w) {
    const float x = coarse.positions[w].x;
    EXPECT_NEAR(coarse.texture_coordinates[w].x, x <= 0.5F ? x : 1.0F - x, 1e-6F);
  }
}

TEST(Wedges, RestoresLooksAtEveryCorner) {
  const TriangleMesh mesh = test::random_soup_with_wedges(7);
  const Hierarchy hierarchy = build(mesh, 0);
  EXPECT_TRUE(restores(hierarchy, mesh));
  TriangleMesh changed = mesh;
  changed.texture_coordinates.back().x += 1e-3F;
  EXPECT_FALSE(restores(hierarchy, changed));
  changed = mesh;
  changed.normals.back().z = -changed.normals.back().z;
  EXPECT_FALSE(restores(hierarchy, changed));
  changed = mesh;
  changed.colors.back().g ^= 1U;
  EXPECT_FALSE(restores(hierarchy, changed));
  changed = mesh;
  changed.triangle_materials.back() ^= 1U;
  EXPECT_FALSE(restores(hierarchy, changed));
  // What the mesh does not have does not count.
  changed = mesh;
  changed.colors.clear();
  EXPECT_TRUE(restores(hierarchy, changed));
}

TEST(Wedges, MeshesWithoutAttributesHaveNone) {
  TriangleMesh mesh = test::noisy_sphere(3, 1);
  mesh.colors.assign(mesh.vertex_count(), glm::u8vec4(200, 100, 50, 255));  // one colour everywhere is none
  const Hierarchy hierarchy = build(mesh, 20);
  EXPECT_FALSE(hierarchy.has_seams());
  EXPECT_TRUE(hierarchy.data().corner_starts.empty());
  EXPECT_TRUE(hierarchy.data().attribute_errors.empty());
  EXPECT_EQ(hierarchy.wedge_count(), hierarchy.vertex_count());
}

TEST(Wedges, BrokenMeshesAreRefused) {
  const TriangleMesh good = test::cylinder_with_seam(8, 2);
  const auto expect_refused = [](const TriangleMesh& mesh) { EXPECT_THROW(build_hierarchy(mesh), Error); };
  TriangleMesh mesh = good;
  mesh.corners[0].x = static_cast<WedgeId>(mesh.wedge_count());
  expect_refused(mesh);
  mesh = good;
  std::swap(mesh.corners[0].x, mesh.corners[0].y);
  expect_refused(mesh);
  mesh = good;
  mesh.texture_coordinates.pop_back();
  expect_refused(mesh);
  mesh = good;
  mesh.texture_coordinates[3].y = std::nanf("");
  expect_refused(mesh);
  mesh = good;
  mesh.positions.back().x += 1.0F;
  expect_refused(mesh);
  mesh = good;
  mesh.triangle_materials.assign(mesh.triangle_count(), 1);
  mesh.materials.resize(1);
  expect_refused(mesh);
  mesh = good;
  mesh.triangle_materials.assign(mesh.triangle_count(), 0);
  mesh.triangle_materials[0] = 1;
  mesh.materials.resize(2);
  expect_refused(mesh);
}

}  // namespace
}  // namespace occlod
