// Every lie about sizes and indices is found before anything is traversed.
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>

#include "hlod/good_hlod.h"
#include "hlod/store/hlod_data.h"
#include "occlod/hlod.h"

namespace occlod::hlod {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

using test::good;
using test::inner_node;

void expect_problem(const std::string& text, const std::function<void(HlodData&)>& change) {
  HlodData data = copy_data(good());
  change(data);
  const auto problem = check_structure(view_of(data));
  ASSERT_TRUE(problem) << "nothing says '" << text << "'";
  EXPECT_NE(problem->find(text), std::string::npos) << *problem;
}

TEST(Structure, AcceptsAGoodHlod) { EXPECT_EQ(check_structure(good().data()), std::nullopt); }

TEST(Structure, FindsLevelsThatAreNone) {
  expect_problem("there are no nodes", [](HlodData& d) { d = {}; });
  expect_problem("does not begin where", [](HlodData& d) { d.levels[1].first_node += 1; });
  expect_problem("does not begin where", [](HlodData& d) { d.levels.push_back({0, 0}); });
  expect_problem("are not all nodes", [](HlodData& d) { d.levels[0].node_count -= 1; });
  expect_problem("is not in its level", [](HlodData& d) { d.nodes[inner_node()].level = 0; });
  expect_problem("is not in its level", [](HlodData& d) { d.nodes[inner_node()].level = 60'000; });
  expect_problem("level 0 has", [](HlodData& d) { d.input_triangle_count += 1; });
  expect_problem("grouping or borders", [](HlodData& d) { d.grouping = static_cast<Grouping>(2); });
  expect_problem("grouping or borders", [](HlodData& d) { d.borders = static_cast<Borders>(2); });
}

TEST(Structure, FindsNumbersThatAreNone) {
  expect_problem("the box is none", [](HlodData& d) { d.box.max.x = d.box.min.x - 1.0F; });
  expect_problem("a box that is none", [](HlodData& d) { d.nodes[3].box.min.y = nan; });
  expect_problem("a box that is none", [](HlodData& d) { d.nodes[3].lod_box.max.z = -1e9F; });
  expect_problem("a sphere that is none", [](HlodData& d) { d.nodes[3].sphere.radius = -1.0F; });
  for (float Node::*field : {&Node::error, &Node::child_error, &Node::guaranteed_error, &Node::area})
    for (const float bad : {nan, -1.0F, std::numeric_limits<float>::infinity()})
      expect_problem("an error or area", [&](HlodData& d) { d.nodes[3].*field = bad; });
}

TEST(Structure, FindsPatchesThatDoNotFit) {
  expect_problem("do not follow", [](HlodData& d) { d.nodes[inner_node()].first_patch += 1; });
  expect_problem("do not follow", [](HlodData& d) { d.nodes.back().patches = 65'535; });
  expect_problem("do not divide", [](HlodData& d) { d.patches[d.nodes[inner_node()].first_patch].index_count = 0; });
  expect_problem("do not divide", [](HlodData& d) { d.patches[d.nodes[inner_node()].first_patch].index_count -= 1; });
  expect_problem("do not divide", [](HlodData& d) { d.patches[d.nodes[inner_node()].first_patch].first_index = 3; });
  expect_problem("triangles in no patch", [](HlodData& d) { d.nodes[inner_node()].triangles += 1; });
  expect_problem("not one level up", [](HlodData& d) { d.patches.back().parent = inner_node() - 1; });
  expect_problem("not one level up", [](HlodData& d) { d.patches.back().parent = no_id - 1; });
  expect_problem("patches of no node", [](HlodData& d) { d.patches.push_back(d.patches.back()); });
}

TEST(Structure, FindsChildrenThatDoNotFit) {
  const std::uint32_t first = good().node(inner_node()).first_child;
  expect_problem("do not follow", [](HlodData& d) { d.nodes[inner_node()].first_child += 1; });
  expect_problem("do not follow", [](HlodData& d) { d.nodes.back().children = 1; });
  expect_problem("on level 0, or none above", [](HlodData& d) { d.nodes[inner_node()].children = 0; });
  expect_problem("not one level down", [&](HlodData& d) { d.children[first] = 0; });
  expect_problem("not one level down", [&](HlodData& d) { d.children[first] = no_id; });
  expect_problem("not ascending", [&](HlodData& d) { d.children[first + 1] = d.children[first]; });
  expect_problem("which does not name it",
                 [&](HlodData& d) { d.children[first] = static_cast<NodeId>(d.nodes.size() - 1); });
  expect_problem("", [](HlodData& d) { d.children.pop_back(); });
}

TEST(Structure, FindsRootsThatAreNone) {
  expect_problem("roots that have parents", [](HlodData& d) { d.roots.push_back(5); });
  expect_problem("not among the roots", [](HlodData& d) { d.roots.clear(); });
}

TEST(Structure, FindsMeshesOutsideTheirArray) {
  expect_problem("outside the meshes", [](HlodData& d) { d.nodes[2].mesh += 4; });
  expect_problem("outside the meshes", [](HlodData& d) { d.nodes[2].mesh = d.meshes.size() + 16; });
  expect_problem("outside the meshes", [](HlodData& d) { d.nodes[2].mesh = ~std::uint64_t{15}; });
  expect_problem("outside the meshes", [](HlodData& d) { d.meshes.resize(d.meshes.size() - 64); });
  expect_problem("outside the meshes", [](HlodData& d) { d.nodes.back().vertices = 60'000; });
  expect_problem("is too large", [](HlodData& d) { d.nodes.back().vertices = 65'536; });
  expect_problem("is too large", [](HlodData& d) { d.nodes.back().triangles = no_id; });
  expect_problem("outside the meshes", [](HlodData& d) { d.has_normals = true; });
}

TEST(Structure, FindsSplitsThatDoNotFit) {
  expect_problem("splits of no node", [](HlodData& d) { d.within.clear(); });
  expect_problem("splits of some nodes only", [](HlodData& d) { d.within.pop_back(); });
  expect_problem("but has splits", [](HlodData& d) { d.within.back() = d.within[0]; });
  expect_problem("but no splits", [](HlodData& d) { d.within[2].splits = 0; });
  expect_problem("too many splits", [](HlodData& d) { d.within[2].splits = 65'535; });
  expect_problem("too many splits", [](HlodData& d) { d.within[2].bare = no_id; });
  expect_problem("too many splits", [](HlodData& d) { d.within[2].triangles = no_id; });
  expect_problem("outside the splits", [](HlodData& d) { d.within[2].place += 4; });
  expect_problem("outside the splits", [](HlodData& d) { d.within[2].place = ~std::uint64_t{15}; });
  expect_problem("outside the splits", [](HlodData& d) { d.within.back().place = d.splits.size() + 16; });  // of none
  expect_problem("outside the splits", [](HlodData& d) { d.within[2].triangles = 1'000'000; });
  expect_problem("outside the splits", [](HlodData& d) { d.splits.resize(d.splits.size() / 2); });
}

// One value of the mesh of a node of level 0.
void expect_mesh_problem(const std::string& text,
                         const std::function<void(std::byte* mesh, const MeshLayout& layout)>& change) {
  HlodData data = copy_data(good());
  const auto last = static_cast<NodeId>(data.nodes.size() - 1);
  change(data.meshes.data() + data.nodes[last].mesh, MeshLayout(data.nodes[last], {}));
  const auto problem = check_mesh(view_of(data), last);
  ASSERT_TRUE(problem) << "nothing says '" << text << "'";
  EXPECT_NE(problem->find(text), std::string::npos) << *problem;
}

template <typename T>
void put(std::byte* at, T value) {
  std::memcpy(at, &value, sizeof(value));
}

TEST(Structure, FindsMeshesThatCannotBeDrawn) {
  const Node& last = good().data().nodes.back();
  EXPECT_EQ(check_mesh(good().data(), static_cast<NodeId>(good().node_count() - 1)), std::nullopt);
  expect_mesh_problem("not finite", [](std::byte* mesh, const MeshLayout&) { put(mesh + 4, nan); });
  expect_mesh_problem("out of range", [&](std::byte* mesh, const MeshLayout& layout) {
    put(mesh + layout.indices + 2, static_cast<std::uint16_t>(last.vertices));
  });
  expect_mesh_problem("repeats a corner", [](std::byte* mesh, const MeshLayout& layout) {
    std::memcpy(mesh + layout.indices, mesh + layout.indices + 2, 2);
  });
  expect_mesh_problem("into one that is not there", [](std::byte* mesh, const MeshLayout& layout) {
    for (std::size_t at = layout.merged_into; at < layout.bytes; at += 2)
      if (std::uint16_t old = 0; std::memcpy(&old, mesh + at, 2), old != stays)
        return put(mesh + at, std::uint16_t{65'000});
  });
  // A vertex that two patches use.
  HlodData data = copy_data(good());
  for (NodeId n = 0; n < data.nodes.size(); ++n) {
    if (data.nodes[n].patches < 2) continue;
    const MeshLayout layout(data.nodes[n], {});
    for (std::size_t at = layout.merged_into; at < layout.bytes; at += 2)
      put(data.meshes.data() + data.nodes[n].mesh + at, std::uint16_t{0});
    EXPECT_NE(check_mesh(view_of(data), n).value_or("").find("not by one parent"), std::string::npos);
    return;
  }
  FAIL() << "no node has two patches";
}

}  // namespace
}  // namespace occlod::hlod
