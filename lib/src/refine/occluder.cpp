#include "occluder.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace occlod {
namespace {

constexpr float round_up = 1.0F + 1e-5F;

// How far the surface around a vertex may be from the input, given the first split of its chain in the forest: what the
// first that is not applied promises, since errors are saturated along the chain.
float chain_error(const Cut& cut, SplitId first) {
  const Hierarchy& hierarchy = cut.hierarchy();
  for (SplitId s = first; s != no_id; s = hierarchy.node(s).child_u) {
    hierarchy.require(s);
    if (!cut.applied(s)) return hierarchy.node(s).guaranteed_error;
  }
  return 0.0F;
}

// How a front face is moved inwards so that it is inside the true surface, which is no farther away than `error`. False
// for faces that are no use then: those that face away, and those that would be moved by more than half of their
// smallest height. A face may be long and its solid thin all the same: the flattest closed section over a face of width
// w that is not a sheet, a regular triangle, is 0.87 w deep, and moved farther a face comes out at the back and hides
// what is seen beside the solid.
bool find_push(const Triangle& t, float error, std::span<const glm::vec3> positions, const glm::vec3& eye,
               glm::vec3& push) {
  const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
  const glm::vec3 normal = glm::cross(b - a, c - a);
  const float twice_area = glm::length(normal);
  if (!(glm::dot(normal, eye - a) > 0.0F)) return false;
  const float longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
  if (!(2.0F * error * longest < twice_area)) return false;
  push = normal * (-error * round_up / twice_area);
  return true;
}

}  // namespace

std::span<const OccluderPart> Occluder::build(std::span<Cut> cuts, std::span<const ObjectView> views,
                                              OccluderMode mode) {
  parts_.resize(cuts.size());
  result_.clear();
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    Part& part = parts_[i];
    cuts[i].active_triangles(part.cut, true);
    part.positions.clear();
    if (mode == OccluderMode::conservative) find_errors(cuts[i]);
    const std::span<const glm::vec3> positions = cuts[i].hierarchy().positions();
    for (const Triangle& t : part.cut) {
      const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
      glm::vec3 back(0.0F);
      if (mode == OccluderMode::conservative && !find_push(t, error_of(cuts[i], t), positions, views[i].eye(), back))
        continue;
      part.positions.insert(part.positions.end(), {a + back, b + back, c + back});
    }
    for (auto v = static_cast<VertexId>(3 * part.triangles.size()); v < part.positions.size(); v += 3)
      part.triangles.emplace_back(v, v + 1, v + 2);
    part.triangles.resize(part.positions.size() / 3);
    result_.push_back({static_cast<std::uint32_t>(i), part.positions, part.triangles});
  }
  return result_;
}

void Occluder::find_errors(const Cut& cut) {
  const Hierarchy& hierarchy = cut.hierarchy();
  base_roots_.assign(hierarchy.base_vertex_count(), no_id);
  for (const SplitId root : hierarchy.data().roots) {
    hierarchy.require(root);
    const VertexId u = hierarchy.star(root).parent_vertex();
    if (u < base_roots_.size()) base_roots_[u] = root;
  }
  errors_.clear();
  for (const SplitId root : base_roots_) errors_.push_back(chain_error(cut, root));
  for (const SplitId s : cut.applied_splits()) errors_.push_back(chain_error(cut, hierarchy.node(s).child_v));
}

// A face that is not of the input was made by a collapse into one of its corners, and is no farther from the input than
// that collapse promises.
float Occluder::error_of(const Cut& cut, const Triangle& t) const {
  const std::size_t base = cut.hierarchy().base_vertex_count();
  const std::span<const SplitId> applied = cut.applied_splits();
  float error = 0.0F;
  for (int k = 0; k < 3; ++k) {
    const VertexId v = t[k];
    const std::size_t place =
        v < base ? v
                 : base + static_cast<std::size_t>(std::lower_bound(applied.begin(), applied.end(), v - base) -
                                                   applied.begin());
    error = std::max(error, errors_[place]);
  }
  return error;
}

}  // namespace occlod
