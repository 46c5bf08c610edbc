#include "hlod/build/finish_level.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "base/arithmetic.h"
#include "base/threads.h"

namespace occlod::hlod {
namespace {

// Returns a key of the triangle's corners that ignores its winding.
std::uint64_t key_of(const Triangle& t) {
  const std::uint64_t low = std::min({t.x, t.y, t.z}), high = std::max({t.x, t.y, t.z});
  const std::uint64_t middle = std::uint64_t{t.x} + t.y + t.z - low - high;
  return low << 42U | middle << 21U | high;
}

// Returns whether the corners ascend when read round from the smallest.
bool is_even(const Triangle& t) { return ((t.x > t.y) + (t.y > t.z) + (t.z > t.x)) == 1; }

// Returns whether any two triangles may have the same corners.
bool has_repeated(const std::vector<Triangle>& triangles) {
  constexpr std::uint64_t empty = ~std::uint64_t{0};  // never a key, because corners differ
  const std::size_t mask = std::bit_ceil(2 * triangles.size() + 2) - 1;
  thread_local std::vector<std::uint64_t> slots;
  slots.assign(mask + 1, empty);
  for (const Triangle& t : triangles) {
    const std::uint64_t key = key_of(t);
    std::size_t slot = (key * 0x9e3779b97f4a7c15ULL >> 24U) & mask;
    for (; slots[slot] != empty; slot = (slot + 1) & mask)
      if (slots[slot] == key) return true;
    slots[slot] = key;
  }
  return false;
}

}  // namespace

void cancel_folded(std::vector<Triangle>& triangles, std::vector<Triangle>& corners, std::span<const Triangle> before) {
  if (!has_repeated(triangles)) return;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) sorted.emplace_back(key_of(triangles[i]), i);
  std::sort(sorted.begin(), sorted.end());
  std::vector<bool> goes(triangles.size(), false);
  for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
    std::vector<std::uint32_t> same[2];
    for (end = begin; end < sorted.size() && sorted[end].first == sorted[begin].first; ++end)
      same[is_even(triangles[sorted[end].second]) ? 1 : 0].push_back(sorted[end].second);
    for (const std::uint32_t i : same[0]) {
      const auto folded = std::find_if(same[1].begin(), same[1].end(), [&](std::uint32_t k) {
        return !goes[k] && key_of(before[k]) != key_of(before[i]);
      });
      if (folded != same[1].end()) goes[i] = goes[*folded] = true;
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (goes[i]) continue;
    triangles[kept] = triangles[i];
    if (!corners.empty()) corners[kept] = corners[i];
    ++kept;
  }
  triangles.resize(kept);
  if (!corners.empty()) corners.resize(kept);
}

namespace {

// Keeps rounding of doubles from making a sphere too small for one that it should contain.
constexpr double slack = 1.0 + 1e-6;

float rounded_up(double x) {
  constexpr float most = std::numeric_limits<float>::max();
  if (!(x < static_cast<double>(most))) return most;
  const auto y = static_cast<float>(x);
  return static_cast<double>(y) < x ? std::nextafter(y, most) : y;
}

Box box_of(const WedgeMesh& mesh, std::span<const Triangle> triangles) {
  Box box{mesh.positions[triangles[0].x], mesh.positions[triangles[0].x]};
  for_each_id(triangles.size(), 1, [&](std::uint32_t i) {
    for (int k = 0; k < 3; ++k) box = unite(box, {mesh.positions[triangles[i][k]], mesh.positions[triangles[i][k]]});
  });
  return box;
}

float area_of(const WedgeMesh& mesh, std::span<const Triangle> triangles) {
  double area = 0.0;
  for_each_id(triangles.size(), 1, [&](std::uint32_t i) {
    const Triangle& t = triangles[i];
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    area += 0.5 * glm::length(glm::cross(b - a, c - a));
  });
  return static_cast<float>(std::min(area, static_cast<double>(std::numeric_limits<float>::max())));
}

// Returns a sphere around the middle of `box` that contains the box and the children's spheres.
Sphere sphere_around(const Box& box, const std::vector<NodeDraft>& nodes, std::span<const std::uint32_t> children) {
  const glm::vec3 center(0.5 * (glm::dvec3(box.min) + glm::dvec3(box.max)));
  double radius = 0.0;
  for (int i = 0; i < 8; ++i) radius = std::max(radius, glm::distance(glm::dvec3(corner(box, i)), glm::dvec3(center)));
  for (const std::uint32_t child : children) {
    const Sphere& s = nodes[child].sphere;
    radius = std::max(radius, glm::distance(glm::dvec3(s.center), glm::dvec3(center)) + static_cast<double>(s.radius));
  }
  return {center, rounded_up(radius * slack)};
}

// Returns, for each group, the nodes with triangles in it.
std::vector<std::vector<std::uint32_t>> children_of_groups(const LevelDraft& below, std::size_t groups) {
  std::vector<std::vector<std::uint32_t>> children(groups);
  for (std::uint32_t n = 0; n < below.nodes.size(); ++n) {
    make_room();
    const NodeDraft& node = below.nodes[n];
    for (std::uint32_t t = node.first_triangle; t < node.first_triangle + node.triangle_count; ++t) {
      std::vector<std::uint32_t>& list = children[below.parent_of[t]];
      if (list.empty() || list.back() != n) list.push_back(n);
    }
  }
  return children;
}

// Sets bounds and errors from the node's children, box and own errors. Errors of levels are added as if they were
// independent: their sum would drift upwards with every level, whereas measured errors do not.
//
// What has vanished without a trace below has no triangle that would say which parent stands for it: all do.
void bound(NodeDraft& node, const std::vector<NodeDraft>& below) {
  for (const std::uint32_t child : node.children)
    for (const Box& gone : below[child].vanished) {
      node.box = unite(node.box, gone);
      grow(node.vanished, gone);
    }
  node.lod_box = node.box;
  float guaranteed = 0.0F;
  for (const std::uint32_t child : node.children) {
    node.lod_box = unite(node.lod_box, below[child].lod_box);
    node.child_error = std::max(node.child_error, below[child].error);
    guaranteed = std::max(guaranteed, below[child].guaranteed_error);
  }
  const double own = node.error, inherited = node.child_error;
  node.error = rounded_up(std::sqrt(inherited * inherited + own * own));
  node.guaranteed_error = rounded_up(static_cast<double>(guaranteed) + static_cast<double>(node.guaranteed_error));
  node.sphere = sphere_around(node.lod_box, below, node.children);
}

}  // namespace

LevelDraft input_level(const WedgeMesh& mesh, const TriangleGroups& groups, unsigned threads) {
  LevelDraft level;
  level.nodes.resize(groups.count);
  level.triangles.resize(mesh.triangles.size());
  level.corners.resize(mesh.corners.size());
  // Each part of the triangles counts those of each node, and then writes them behind those of the parts before it.
  std::vector<std::vector<std::uint32_t>> next(threads, std::vector<std::uint32_t>(groups.count, 0));
  const auto for_each_triangle = [&](const auto& visit) {
    for_each_part(mesh.triangles.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t part) {
      for_each_short_range(begin, end, [&](std::size_t first, std::size_t last) {
        for (std::size_t t = first; t < last; ++t) visit(t, next[part][groups.group_of[t]]);
      });
    });
  };
  for_each_triangle([](std::size_t, std::uint32_t& count) { ++count; });
  std::uint32_t place = 0;
  for (std::size_t n = 0; n < level.nodes.size(); ++n) {
    level.nodes[n].first_triangle = place;
    for (std::vector<std::uint32_t>& of_part : next) place += std::exchange(of_part[n], place);
    level.nodes[n].triangle_count = place - level.nodes[n].first_triangle;
  }
  for_each_triangle([&](std::size_t t, std::uint32_t& to) {
    level.triangles[to] = mesh.triangles[t];
    if (!mesh.corners.empty()) level.corners[to] = mesh.corners[t];
    ++to;
  });
  for_each_task(
      level.nodes.size(), threads, [] { return 0; },
      [&](int, std::size_t n) {
        NodeDraft& node = level.nodes[n];
        const std::span<const Triangle> triangles = level.triangles_of(node);
        node.box = box_of(mesh, triangles);
        node.area = area_of(mesh, triangles);
        bound(node, {});
      },
      [] {});
  return level;
}

LevelBuilder::LevelBuilder(const WedgeMesh& mesh, const LevelDraft& below, std::size_t nodes, unsigned threads)
    : mesh_(mesh), below_(below), threads_(threads) {
  level_.nodes.reserve(nodes);
  const std::size_t expected = below.triangles.size() / 3;
  level_.triangles.reserve(expected);
  level_.corners.reserve(below.corners.empty() ? 0 : expected);
}

void LevelBuilder::append(SimplifiedNode& from) {
  NodeDraft& node = level_.nodes.emplace_back();
  node.first_triangle = static_cast<std::uint32_t>(level_.triangles.size());
  node.triangle_count = static_cast<std::uint32_t>(from.triangles.size());
  node.first_merge = level_.merges.size();
  node.merge_count = from.merges.size();
  level_.triangles.insert(level_.triangles.end(), from.triangles.begin(), from.triangles.end());
  level_.corners.insert(level_.corners.end(), from.corners.begin(), from.corners.end());
  level_.merges.insert(level_.merges.end(), from.merges.begin(), from.merges.end());
  node.bare_targets = std::move(from.bare_targets);
  node.within = std::move(from.within);
  node.box = from.box;
  node.vanished = std::move(from.vanished);
  node.error = from.error;
  node.guaranteed_error = from.guaranteed_error;
  from = {};
}

LevelDraft LevelBuilder::finish() {
  std::vector<std::vector<std::uint32_t>> children = children_of_groups(below_, level_.nodes.size());
  for_each_task(
      level_.nodes.size(), threads_, [] { return 0; },
      [&](int, std::size_t n) {
        NodeDraft& node = level_.nodes[n];
        node.children = std::move(children[n]);
        node.area = area_of(mesh_, level_.wedge_triangles_of(node));
        bound(node, below_.nodes);
      },
      [] {});
  return std::move(level_);
}

}  // namespace occlod::hlod
