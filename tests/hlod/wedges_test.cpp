// HLODs of meshes with seams: texture coordinates, hard normals, colours, materials.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>
#include <vector>

#include "occlod/build_hlod.h"
#include "occlod/hlod.h"
#include "splits/triangle_keys.h"
#include "support/wedge_meshes.h"

namespace occlod::hlod {
namespace {

constexpr int grid_size = 48;

const std::vector<std::pair<Grouping, Borders>> all_kinds = {
    {Grouping::shifted, Borders::locked}, {Grouping::nested, Borders::locked}, {Grouping::nested, Borders::free}};

HlodBuildOptions small_nodes(Grouping grouping = Grouping::shifted, Borders borders = Borders::locked) {
  HlodBuildOptions options;
  options.node_triangles = 64;
  options.grouping = grouping;
  options.borders = borders;
  options.within = Within::splits;
  options.threads = 1;
  return options;
}

// Three charts beside each other, of two materials.
TriangleMesh striped_grid() {
  TriangleMesh mesh = test::grid_of_charts(
      grid_size, [](int i, int) { return 3 * i / grid_size; }, [](int i, int) { return 3 * i / grid_size == 1; });
  mesh.materials.resize(2);
  mesh.materials[1].name = "middle";
  return mesh;
}

int chart_of(const glm::vec2& texture) { return static_cast<int>(std::floor(0.5F * texture.x + 0.001F)); }

// The corners of triangles of a node, sorted.
std::vector<CornerKey> corners_of_node(const Hlod& hlod, NodeId n, std::span<const std::uint16_t> indices) {
  const NodeMesh mesh = hlod.mesh(n);
  const NodeSplits within = hlod.has_within(n) ? hlod.within(n) : NodeSplits{};
  const auto joined = [](const auto& own, const auto& more) {
    std::vector<std::remove_cvref_t<decltype(own[0])>> all(own.begin(), own.end());
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const auto positions = joined(mesh.positions, within.positions), normals = joined(mesh.normals, within.normals);
  const auto colors = joined(mesh.colors, within.colors);
  const auto texture = joined(mesh.texture_coordinates, within.texture_coordinates);
  const auto materials = joined(mesh.materials, within.materials);
  std::vector<CornerKey> corners;
  for (std::size_t i = 0; i < indices.size(); i += 3)
    corners.push_back(corners_of({indices[i], indices[i + 1], indices[i + 2]}, {positions, normals, colors, texture},
                                 materials.empty() ? MaterialId{0} : materials[indices[i]]));
  std::sort(corners.begin(), corners.end());
  return corners;
}

// Of the triangles that a node was made from.
std::vector<CornerKey> corners_of_children(const Hlod& hlod, NodeId n) {
  std::vector<CornerKey> corners;
  for (const NodeId child : hlod.children(n))
    for (const Patch& patch : hlod.patches(child)) {
      if (patch.parent != n) continue;
      const auto part = hlod.mesh(child).indices.subspan(patch.first_index, patch.index_count);
      const auto more = corners_of_node(hlod, child, part);
      corners.insert(corners.end(), more.begin(), more.end());
    }
  std::sort(corners.begin(), corners.end());
  return corners;
}

TEST(HlodWedges, SoupsWithSeamsBuildValidateAndComeBack) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const TriangleMesh mesh = test::random_soup_with_wedges(seed);
    for (const auto& [grouping, borders] : all_kinds) {
      HlodBuildOptions options = small_nodes(grouping, borders);
      options.node_triangles = 16;
      const Hlod hlod = build_hlod(mesh, options);
      ASSERT_EQ(validate(hlod), std::vector<std::string>{}) << "seed " << seed;
      ASSERT_TRUE(restores(hlod, mesh)) << "seed " << seed;
    }
  }
}

TEST(HlodWedges, OneCornerThatDiffersIsFound) {
  const TriangleMesh mesh = striped_grid();
  const Hlod hlod = build_hlod(mesh, small_nodes());
  EXPECT_TRUE(restores(hlod, mesh));
  TriangleMesh other = mesh;
  other.texture_coordinates.back().y += 0.001F;
  EXPECT_FALSE(restores(hlod, other));
  other = mesh;
  other.triangle_materials[7] = 1;
  EXPECT_FALSE(restores(hlod, other));
}

TEST(HlodWedges, EveryTriangleOfEveryNodeStaysInItsChartAndMaterial) {
  const TriangleMesh mesh = striped_grid();
  for (const auto& [grouping, borders] : all_kinds) {
    const Hlod hlod = build_hlod(mesh, small_nodes(grouping, borders));
    ASSERT_GT(hlod.level_count(), 3U);
    for (NodeId n = 0; n < hlod.node_count(); ++n) {
      const NodeMesh node = hlod.mesh(n);
      for (std::size_t i = 0; i < node.indices.size(); ++i) {
        const std::size_t first = i - i % 3;
        const int chart = chart_of(node.texture_coordinates[node.indices[i]]);
        ASSERT_EQ(chart, chart_of(node.texture_coordinates[node.indices[first]]));
        ASSERT_EQ(node.materials[node.indices[i]], chart == 1 ? 1 : 0);
      }
    }
  }
}

TEST(HlodWedges, CoarseNodesKeepTextureWhereItWas) {
  // Texture coordinates are positions: a collapse within a flat chart does not move them.
  const Hlod hlod = build_hlod(striped_grid(), small_nodes());
  const NodeMesh root = hlod.mesh(hlod.data().roots[0]);
  ASSERT_LE(root.indices.size() / 3, 256U);
  for (const std::uint16_t v : root.indices) {
    const glm::vec2 texture =
        root.texture_coordinates[v] - glm::vec2(2.0F * static_cast<float>(chart_of(root.texture_coordinates[v])), 0.0F);
    EXPECT_NEAR(texture.x, root.positions[v].x, 1e-5F);
    EXPECT_NEAR(texture.y, root.positions[v].y, 1e-5F);
  }
}

TEST(HlodWedges, HardNormalsStayHard) {
  const TriangleMesh mesh = test::cube_of_charts(16);
  const Hlod hlod = build_hlod(mesh, small_nodes());
  std::size_t flat = 0;
  for (NodeId n = 0; n < hlod.node_count(); ++n) {
    const NodeMesh node = hlod.mesh(n);
    for (std::size_t i = 0; i < node.indices.size(); i += 3) {
      const glm::vec3 hard = node.normals[node.indices[i]];
      EXPECT_EQ(std::max({std::abs(hard.x), std::abs(hard.y), std::abs(hard.z)}), 1.0F);
      EXPECT_EQ(hard, node.normals[node.indices[i + 1]]);
      EXPECT_EQ(hard, node.normals[node.indices[i + 2]]);
      if (hlod.node(n).error > 1e-3F) continue;  // the cube has lost corners
      ++flat;
      const glm::vec3 a = node.positions[node.indices[i]];
      const glm::vec3 across =
          glm::cross(node.positions[node.indices[i + 1]] - a, node.positions[node.indices[i + 2]] - a);
      EXPECT_GT(glm::dot(glm::normalize(across), hard), 0.999F);
    }
  }
  EXPECT_GT(flat, 2000U);
}

TEST(HlodWedges, SplitsLeadFromTheMeshOfANodeToWhatItWasMadeFrom) {
  for (const TriangleMesh& mesh : {striped_grid(), test::cylinder_with_seam(96, 48), test::cube_of_charts(16)}) {
    const Hlod hlod = build_hlod(mesh, small_nodes());
    std::size_t nodes = 0;
    for (NodeId n = 0; n < hlod.node_count(); ++n) {
      if (!hlod.has_within(n)) continue;
      ++nodes;
      const std::uint32_t all = hlod.data().within[n].splits;
      EXPECT_TRUE(corners_of_node(hlod, n, cut_with_splits(hlod, n, 0).indices) ==
                  corners_of_node(hlod, n, hlod.mesh(n).indices));
      EXPECT_TRUE(corners_of_node(hlod, n, cut_with_splits(hlod, n, all).indices) == corners_of_children(hlod, n));
    }
    EXPECT_GT(nodes, 5U);
  }
}

TEST(HlodWedges, CutsWithinNodesApplyAllSplitsOfAPlaceTogether) {
  const Hlod hlod = build_hlod(test::cylinder_with_seam(96, 48), small_nodes());
  std::size_t rounded = 0;
  for (NodeId n = 0; n < hlod.node_count(); ++n) {
    if (!hlod.has_within(n)) continue;
    const std::span<const glm::vec3> places = hlod.within(n).positions.subspan(hlod.data().within[n].bare);
    for (std::uint32_t splits = 1; splits < places.size(); ++splits) {
      const std::uint32_t applied = cut_with_splits(hlod, n, splits).splits;
      if (places[splits] == places[splits - 1]) {
        EXPECT_EQ(applied, splits + 1);
        ++rounded;
      } else {
        EXPECT_EQ(applied, splits);
      }
    }
  }
  EXPECT_GT(rounded, 0U);
}

TEST(HlodWedges, VerticesSlideWithinTheirChart) {
  const Hlod hlod = build_hlod(striped_grid(), small_nodes());
  std::size_t slides = 0;
  for (NodeId n = 0; n < hlod.node_count(); ++n) {
    const NodeMesh mesh = hlod.mesh(n);
    for (const Patch& patch : hlod.patches(n))
      for (std::uint32_t i = patch.first_index; i < patch.first_index + patch.index_count; ++i) {
        const std::uint16_t v = mesh.indices[i];
        if (patch.parent == no_id || mesh.merged_into[v] == stays) continue;
        const NodeMesh parent = hlod.mesh(patch.parent);
        EXPECT_EQ(chart_of(parent.texture_coordinates[mesh.merged_into[v]]), chart_of(mesh.texture_coordinates[v]));
        ++slides;
      }
  }
  EXPECT_GT(slides, 1000U);
}

TEST(HlodWedges, ErrorsAreOfTheTextureToo) {
  // Flat, with a texture that is bent.
  TriangleMesh mesh = test::grid_of_charts(
      grid_size, [](int, int) { return 0; }, [](int, int) { return 0; });
  for (glm::vec2& texture : mesh.texture_coordinates) texture.x = texture.x * texture.x;
  const Hlod with = build_hlod(mesh, small_nodes());
  EXPECT_GT(with.node(with.data().roots[0]).error, 1e-4F);
  EXPECT_LT(with.node(with.data().roots[0]).guaranteed_error, 1e-5F);
}

TEST(HlodWedges, ThreadsChangeNothing) {
  const TriangleMesh mesh = striped_grid();
  HlodBuildOptions options = small_nodes();
  const Hlod one = build_hlod(mesh, options);
  options.threads = 2;
  const Hlod two = build_hlod(mesh, options);
  EXPECT_TRUE(std::ranges::equal(one.data().meshes, two.data().meshes));
  EXPECT_TRUE(std::ranges::equal(one.data().splits, two.data().splits));
}

TEST(HlodWedges, AMaterialThatIsNotThereIsFound) {
  const Hlod hlod = build_hlod(striped_grid(), small_nodes());
  HlodView view = hlod.data();
  view.materials = view.materials.subspan(0, 1);
  EXPECT_FALSE(check_structure(view).has_value());
  bool found = false;
  for (NodeId n = 0; n < hlod.node_count(); ++n)
    found = found || check_mesh(view, n).value_or("") == "a material is not there";
  EXPECT_TRUE(found);
  view.materials = {};
  EXPECT_EQ(check_structure(view).value_or(""), "there are no materials, but vertices name some");
}

}  // namespace
}  // namespace occlod::hlod
