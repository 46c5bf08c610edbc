#include "occlod/viewcells/cell_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "occlod/core/error.h"
#include "cells/cell_geometry.h"

namespace occlod {
namespace {

// 32 below root cells, 22 above; no more, so that programs may go down by recursion.
constexpr std::uint32_t most_levels = 64;

[[noreturn]] void refuse(const std::string& subject, CellId cell, const char* problem) {
  throw Error({subject, fmt::format("cell {}", cell), problem, "build the cells again with 'occlod cells build'"});
}

bool holds(const CellBox& box, const glm::dvec3& p) { return overlap(box, {p, p}); }

bool is_box(const CellBox& box) {
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(box.min[axis]) || !std::isfinite(box.max[axis]) || box.min[axis] > box.max[axis]) return false;
  return true;
}

// Whether a box that meets the other does so in more than an edge: in a piece of a face, where a face has a size.
bool share_face(const CellBox& a, const CellBox& b) {
  int touching = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double common = std::min(a.max[axis], b.max[axis]) - std::max(a.min[axis], b.min[axis]);
    const bool is_flat = a.min[axis] == a.max[axis] || b.min[axis] == b.max[axis];
    if (common < 0.0) return false;
    touching += common == 0.0 && !is_flat ? 1 : 0;
  }
  return touching <= 1;
}

}  // namespace

CellTree::CellTree(std::vector<CellNode> nodes, const std::string& subject) : nodes_(std::move(nodes)) {
  if (nodes_.empty() || nodes_.size() >= no_id) throw Error({subject, "", "has no cells, or too many", ""});
  std::vector<CellId> open;  // from the root to the last node
  for (CellId n = 0; n < nodes_.size(); ++n) {
    const CellNode& node = nodes_[n];
    while (!open.empty() && nodes_[open.back()].end == n) open.pop_back();
    if (node.parent != (open.empty() ? no_id : open.back()) || open.empty() != (n == 0) || node.level != open.size())
      refuse(subject, n, "is not in its place in the tree");
    if (node.level > most_levels) refuse(subject, n, "is too deep in the tree");
    if (node.end <= n || node.end > (open.empty() ? nodes_.size() : nodes_[open.back()].end))
      refuse(subject, n, "ends outside the cell above it");
    if (!is_box(node.box)) refuse(subject, n, "has a box that is not finite, or inverted");
    if (!open.empty() && unite(nodes_[open.back()].box, node.box) != nodes_[open.back()].box)
      refuse(subject, n, "reaches out of the cell above it");
    open.push_back(n);
    if (is_leaf(n)) ++leaf_count_;
  }
  if (nodes_.front().end != nodes_.size()) refuse(subject, 0, "does not hold all others");
}

CellId CellTree::leaf_of(const glm::dvec3& eye) const {
  CellId n = 0;
  while (n < nodes_.size() && (!holds(nodes_[n].box, eye) || !is_leaf(n)))
    n = holds(nodes_[n].box, eye) ? n + 1 : nodes_[n].end;
  return n < nodes_.size() ? n : no_id;
}

CellId CellTree::nearest_leaf(const glm::dvec3& eye) const {
  CellId best = no_id;
  double best_distance = std::numeric_limits<double>::infinity();
  for (CellId n = 0; n < nodes_.size();) {
    const double distance = smallest_distance(nodes_[n].box, {eye, eye});
    if (!(distance < best_distance)) {
      n = nodes_[n].end;
      continue;
    }
    if (is_leaf(n)) {
      best = n;
      best_distance = distance;
    }
    ++n;
  }
  return best;
}

void CellTree::leaves_in(const CellBox& box, std::vector<CellId>& out) const {
  out.clear();
  for (CellId n = 0; n < nodes_.size();) {
    if (!overlap(nodes_[n].box, box)) {
      n = nodes_[n].end;
      continue;
    }
    if (is_leaf(n)) out.push_back(n);
    ++n;
  }
}

void CellTree::neighbours(CellId leaf, std::vector<CellId>& out) const {
  leaves_in(nodes_[leaf].box, out);
  std::erase_if(out, [&](CellId n) { return n == leaf || !share_face(nodes_[leaf].box, nodes_[n].box); });
}

void CellTree::path_to(CellId cell, std::vector<CellId>& out) const {
  out.clear();
  for (CellId n = cell; n != no_id; n = nodes_[n].parent) out.push_back(n);
  std::reverse(out.begin(), out.end());
}

CellId CellTree::common_ancestor(CellId a, CellId b) const noexcept {
  while (!(a <= b && b < nodes_[a].end)) a = nodes_[a].parent;
  return a;
}

}  // namespace occlod
