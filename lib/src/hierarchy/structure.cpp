#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "occlod/hierarchy/validate.h"

namespace occlod {
namespace {

using Problem = std::optional<std::string>;

Problem check_sizes(const HierarchyData& d) {
  if (d.nodes.empty()) return "there is no sentinel split";
  const std::size_t splits = d.nodes.size() - 1;
  const auto expect = [](const char* what, std::size_t is, std::size_t should) -> Problem {
    if (is == should) return std::nullopt;
    return fmt::format("there are {} {}, not {}", is, what, should);
  };
  if (d.positions.size() <= splits) return "there are more splits than vertices to split";
  if (d.positions.size() >= no_id || d.faces.size() >= no_id) return "there are more than 2^32 - 2 vertices or faces";
  if (!d.normals.empty())
    if (Problem p = expect("normals", d.normals.size(), d.positions.size())) return p;
  if (!d.colors.empty())
    if (Problem p = expect("colors", d.colors.size(), d.positions.size())) return p;
  if (Problem p = expect("deaths of faces", d.died.size(), d.faces.size())) return p;
  if (Problem p = expect("boxes", d.boxes.size(), splits)) return p;
  if (Problem p = expect("cylinders", d.cylinders.size(), splits)) return p;
  if (Problem p = expect("dependency ranges", d.first_dependency.size(), splits + 1)) return p;
  if (d.nodes[splits].first_inserted != d.faces.size()) return "the inserted faces do not end with the faces";
  if (d.nodes[splits].first_removed != d.removed_faces.size()) return "the removed faces do not end with their list";
  if (d.first_dependency[splits] != d.dependencies.size()) return "the dependencies do not end with their list";
  if (d.nodes[0].first_removed != 0 || d.first_dependency[0] != 0) return "the first split's ranges do not start at 0";
  return std::nullopt;
}

Problem check_split(const HierarchyData& d, SplitId s) {
  const SplitNode& node = d.nodes[s];
  const SplitNode& next = d.nodes[s + 1];
  const std::size_t splits = d.nodes.size() - 1;
  const std::size_t base_vertices = d.positions.size() - splits;
  if (next.first_inserted < node.first_inserted || next.first_removed < node.first_removed ||
      d.first_dependency[s + 1] < d.first_dependency[s])
    return fmt::format("a range of split {} runs backwards", s);
  if (next.first_inserted > d.faces.size() || next.first_removed > d.removed_faces.size() ||
      d.first_dependency[s + 1] > d.dependencies.size())
    return fmt::format("a range of split {} leaves its list", s);
  if (node.parent_vertex >= base_vertices + s) return fmt::format("split {} splits a vertex that comes later", s);
  for (const SplitId child : {node.child_u, node.child_v})
    if (child != no_id && (child <= s || child >= splits))
      return fmt::format("split {} has child {} out of order", s, child);
  for (std::uint32_t i = d.first_dependency[s]; i < d.first_dependency[s + 1]; ++i)
    if (d.dependencies[i] >= s)
      return fmt::format("split {} depends on split {}, which comes later", s, d.dependencies[i]);
  for (FaceId f = node.first_inserted; f < next.first_inserted; ++f)
    for (int k = 0; k < 3; ++k)
      if (d.faces[f][k] > base_vertices + s)
        return fmt::format("face {} of split {} has a corner that comes later", f, s);
  for (std::uint32_t i = node.first_removed; i < next.first_removed; ++i) {
    const FaceId f = d.removed_faces[i];
    if (f >= node.first_inserted) return fmt::format("split {} removes face {}, which comes later", s, f);
    if (d.died[f] != s) return fmt::format("split {} removes face {}, which dies at another", s, f);
  }
  return std::nullopt;
}

Problem check_positions(const HierarchyData& d) {
  const auto finite = [](const glm::vec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); };
  const auto bad = std::find_if_not(d.positions.begin(), d.positions.end(), finite);
  if (bad == d.positions.end()) return std::nullopt;
  return fmt::format("vertex {} is not finite", bad - d.positions.begin());
}

Problem check_base_faces(const HierarchyData& d) {
  const std::size_t base_vertices = d.positions.size() - (d.nodes.size() - 1);
  const FaceId base_faces = d.nodes[0].first_inserted;
  if (base_faces > d.faces.size()) return "the base mesh has more faces than there are";
  for (FaceId f = 0; f < base_faces; ++f)
    for (int k = 0; k < 3; ++k)
      if (d.faces[f][k] >= base_vertices)
        return fmt::format("base face {} has a corner that is not in the base mesh", f);
  return std::nullopt;
}

// Every split is a root or the child of exactly one split, one level above it.
Problem check_forest(const HierarchyData& d) {
  const std::size_t splits = d.nodes.size() - 1;
  std::vector<std::uint8_t> parents(splits, 0);
  for (const SplitId root : d.roots) {
    if (root >= splits) return fmt::format("root {} is not a split", root);
    if (d.nodes[root].level != 0) return fmt::format("root {} is not at level 0", root);
    if (parents[root]++ != 0) return fmt::format("root {} is named twice", root);
  }
  for (SplitId s = 0; s < splits; ++s)
    for (const SplitId child : {d.nodes[s].child_u, d.nodes[s].child_v}) {
      if (child == no_id) continue;
      if (parents[child]++ != 0) return fmt::format("split {} has two parents in the forest", child);
      if (d.nodes[child].level != d.nodes[s].level + 1)
        return fmt::format("split {} is not one level below its parent", child);
    }
  const auto orphan = std::find(parents.begin(), parents.end(), 0);
  if (orphan != parents.end()) return fmt::format("split {} is not in the forest", orphan - parents.begin());
  return std::nullopt;
}

}  // namespace

std::optional<std::string> check_structure(const HierarchyData& data) {
  if (Problem p = check_sizes(data)) return p;
  if (Problem p = check_positions(data)) return p;
  if (Problem p = check_base_faces(data)) return p;
  const auto splits = static_cast<SplitId>(data.nodes.size() - 1);
  for (SplitId s = 0; s < splits; ++s)
    if (Problem p = check_split(data, s)) return p;
  // Deaths and removals agree both ways: each removal names its face's death, so equal counts leave no death without a
  // removal.
  const auto deaths =
      static_cast<std::size_t>(std::count_if(data.died.begin(), data.died.end(), [](SplitId s) { return s != no_id; }));
  if (deaths != data.removed_faces.size()) return "some face dies without being removed, or is removed twice";
  return check_forest(data);
}

}  // namespace occlod
