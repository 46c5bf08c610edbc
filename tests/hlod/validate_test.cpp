// A validator that finds nothing is worth something only if it finds what is wrong: every invariant is broken once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "hlod/good_hlod.h"
#include "hlod/store/hlod_data.h"
#include "occlod/hlod.h"

namespace occlod::hlod {
namespace {

using test::good;
using test::inner_node;

NodeId last_node() { return static_cast<NodeId>(good().node_count() - 1); }

// Changes one thing and expects a violation that says so.
void expect_violation(const std::string& text, const std::function<void(HlodData&)>& change) {
  HlodData data = copy_data(good());
  change(data);
  const std::vector<std::string> violations = validate(make_hlod(std::move(data)));
  const bool found = std::any_of(violations.begin(), violations.end(),
                                 [&](const std::string& v) { return v.find(text) != std::string::npos; });
  EXPECT_TRUE(found) << "nothing says '" << text << "'" << (violations.empty() ? "" : "; but: " + violations[0]);
}

std::span<std::uint16_t> merged_into(HlodData& data, NodeId n) {
  const MeshLayout layout(data.nodes[n], {});
  return {reinterpret_cast<std::uint16_t*>(data.meshes.data() + data.nodes[n].mesh + layout.merged_into),
          data.nodes[n].vertices};
}
std::span<glm::vec3> positions(HlodData& data, NodeId n) {
  return {reinterpret_cast<glm::vec3*>(data.meshes.data() + data.nodes[n].mesh), data.nodes[n].vertices};
}
std::span<std::uint16_t> indices(HlodData& data, NodeId n) {
  const MeshLayout layout(data.nodes[n], {});
  return {reinterpret_cast<std::uint16_t*>(data.meshes.data() + data.nodes[n].mesh + layout.indices),
          3 * std::size_t{data.nodes[n].triangles}};
}

TEST(ValidateHlod, AcceptsAGoodHlod) {
  EXPECT_TRUE(validate(good()).empty());
  EXPECT_TRUE(restores(good(), test::good_mesh()));
}

TEST(ValidateHlod, TellsWhetherTheInputComesBack) {
  TriangleMesh mesh = test::good_mesh();
  mesh.positions[7].x = std::nextafter(mesh.positions[7].x, 9.0F);
  EXPECT_FALSE(restores(good(), mesh));
  mesh = test::good_mesh();
  std::swap(mesh.triangles[3].x, mesh.triangles[3].y);
  EXPECT_FALSE(restores(good(), mesh)) << "turned over";
  mesh = test::good_mesh();
  mesh.triangles.pop_back();
  EXPECT_FALSE(restores(good(), mesh));
}

TEST(ValidateHlod, FindsWhatTheStructureCheckFinds) {
  expect_violation("not among the roots", [](HlodData& d) { d.roots.clear(); });
  expect_violation("a position is not finite",
                   [](HlodData& d) { positions(d, 4)[0].x = std::numeric_limits<float>::infinity(); });
}

TEST(ValidateHlod, FindsErrorsThatAreNotSaturated) {
  expect_violation("smaller error than its child", [](HlodData& d) { d.nodes[0].error *= 0.1F; });
  expect_violation("smaller error than its child", [](HlodData& d) { d.nodes[0].guaranteed_error *= 0.1F; });
  expect_violation("is not that of a child", [](HlodData& d) { d.nodes[0].child_error *= 0.5F; });
  expect_violation("but has an error", [](HlodData& d) { d.nodes.back().error = 0.1F; });
}

TEST(ValidateHlod, FindsBoundsThatAreTooSmall) {
  expect_violation("lod_box of node 0 does not hold that of", [](HlodData& d) { d.nodes[0].lod_box.max.x -= 0.1F; });
  expect_violation("does not hold its box", [](HlodData& d) { d.nodes.back().lod_box.min.x += 1e-4F; });
  expect_violation("sphere of node", [](HlodData& d) { d.nodes[0].sphere.radius *= 0.98F; });
  expect_violation("sphere of node", [](HlodData& d) { d.nodes.back().sphere.center.x += 0.5F; });
  expect_violation("does not hold all that it stands for", [](HlodData& d) {
    Box& box = d.nodes[inner_node()].box;
    box.min.x += 0.05F * (box.max.x - box.min.x);
  });
}

TEST(ValidateHlod, FindsForeignVertices) {
  expect_violation("does not hold all that it stands for", [](HlodData& d) { positions(d, 0)[0].y += 10.0F; });
  expect_violation("that none of its children has",
                   [](HlodData& d) { positions(d, inner_node())[0] = positions(d, last_node())[0]; });
  expect_violation("has a vertex twice", [](HlodData& d) { positions(d, 0)[0] = positions(d, 0)[1]; });
}

TEST(ValidateHlod, FindsTrianglesAndMergesThatContradictEachOther) {
  expect_violation("is not what it replaces", [](HlodData& d) {
    const auto triangle = indices(d, 0);  // turned over
    std::swap(triangle[0], triangle[1]);
  });
  // One merge alone may be told by nothing: all triangles at the vertex may have vanished in any case.
  expect_violation("is not what it replaces", [](HlodData& d) {
    for (std::uint16_t& target : merged_into(d, last_node())) target = stays;
  });
  expect_violation("is not what it replaces", [](HlodData& d) {
    for (std::uint16_t& target : merged_into(d, last_node()))
      if (target != stays) target = target == 0 ? 1 : 0;
  });
}

template <typename T>
std::span<T> array_of(HlodData& data, NodeId n, std::size_t SplitsLayout::*offset, std::size_t count) {
  const SplitsLayout layout(data.within[n], {});
  return {reinterpret_cast<T*>(data.splits.data() + data.within[n].place + layout.*offset), count};
}
std::span<float> split_errors(HlodData& data, NodeId n) {
  return array_of<float>(data, n, &SplitsLayout::errors, data.within[n].splits);
}
std::span<std::uint16_t> split_parents(HlodData& data, NodeId n) {
  return array_of<std::uint16_t>(data, n, &SplitsLayout::parents, data.within[n].splits);
}
std::span<std::uint16_t> split_indices(HlodData& data, NodeId n) {
  return array_of<std::uint16_t>(data, n, &SplitsLayout::indices, 3 * std::size_t{data.within[n].triangles});
}
NodeId node_with_splits() {
  NodeId n = inner_node();
  while (good().data().within[n].splits < 10) ++n;
  return n;
}
glm::vec3& split_position(HlodData& data, NodeId n, std::size_t split) {
  return reinterpret_cast<glm::vec3*>(data.splits.data() + data.within[n].place)[data.within[n].bare + split];
}

TEST(ValidateHlod, FindsSplitsThatCannotBeUsed) {
  expect_violation("errors of splits do not descend", [](HlodData& d) {
    const auto errors = split_errors(d, 0);
    std::swap(errors.front(), errors.back());
  });
  expect_violation("errors of splits do not descend", [](HlodData& d) { split_errors(d, 0).back() = -1.0F; });
  expect_violation("before one that it needs",
                   [](HlodData& d) { split_parents(d, 0)[5] = static_cast<std::uint16_t>(d.nodes[0].vertices + 5); });
  expect_violation("splits of node 0: an index is out of range", [](HlodData& d) { split_indices(d, 0)[7] = stays; });
  expect_violation("splits of node 0: a triangle repeats",
                   [](HlodData& d) { split_indices(d, 0)[0] = split_indices(d, 0)[1]; });
  expect_violation("splits of node 0: a position is not finite",
                   [](HlodData& d) { split_position(d, 0, 3).z = std::numeric_limits<float>::quiet_NaN(); });
}

TEST(ValidateHlod, FindsSplitsThatLeadElsewhere) {
  expect_violation("have a vertex that is none of the input",
                   [](HlodData& d) { split_position(d, node_with_splits(), 3).x += 0.01F; });
  expect_violation("have a vertex twice", [](HlodData& d) {
    split_position(d, node_with_splits(), 3) = split_position(d, node_with_splits(), 4);
  });
  expect_violation("do not lead back to the triangles", [](HlodData& d) {
    const auto indices = split_indices(d, node_with_splits());  // turned over
    std::swap(indices[0], indices[1]);
  });
  expect_violation("do not lead back to the triangles", [](HlodData& d) {
    std::swap(split_position(d, node_with_splits(), 0),
              split_position(d, node_with_splits(), d.within[node_with_splits()].splits - 1U));
  });
  expect_violation("have a larger error than it", [](HlodData& d) {
    split_errors(d, node_with_splits())[0] = 1.01F * d.nodes[node_with_splits()].error;
  });
  // All splits together do not use their parents, but none of them do.
  expect_violation("do not begin with its mesh", [](HlodData& d) {
    for (std::uint16_t& parent : split_parents(d, node_with_splits())) parent = 0;
  });
}

TEST(ValidateHlod, FindsSplitsThatContradictMerges) {
  // Two splits at the end of the sequence swap their vertices, and triangles with them: both ends of the sequence are
  // right, but vertices go where no child says that they do.
  const NodeId n = node_with_splits();
  HlodData probe = copy_data(good());
  const auto parents = split_parents(probe, n);
  const std::size_t last = parents.size() - 1;
  const auto root_of = [&](std::size_t split) {
    const std::size_t first = probe.nodes[n].vertices + std::size_t{probe.within[n].bare};
    std::size_t v = first + split;
    while (v >= first) v = parents[v - first];
    return v;
  };
  std::size_t other = last;
  while (root_of(other) == root_of(last)) --other;
  expect_violation("the splits of node", [&](HlodData& d) { split_parents(d, n)[last] = split_parents(d, n)[other]; });
}

TEST(ValidateHlod, FindsFrontsThatGape) {
  // A vertex on the border of two parents is merged in one of them: each node is sound, the front between is not. Shown
  // by nested groups with free borders, which do that everywhere.
  HlodBuildOptions options;
  options.node_triangles = 64;
  options.grouping = Grouping::nested;
  options.borders = Borders::free;
  HlodData data = copy_data(build_hlod(test::good_mesh(), options));
  EXPECT_TRUE(validate(make_hlod(copy_data(make_hlod(data)))).empty());
  data.borders = Borders::locked;
  const std::vector<std::string> violations = validate(make_hlod(std::move(data)));
  ASSERT_FALSE(violations.empty());
  EXPECT_LE(violations.size(), 20U);
}

}  // namespace
}  // namespace occlod::hlod
