#include "refine/occluder.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace occlod {
namespace {

// What shows its back is not drawn, and so hides nothing; of a closed surface it lies behind what shows its front.
// Faces that are no numbers or too small to tell stay.
void drop_back_faces(std::span<const glm::vec3> positions, const glm::vec3& eye, std::vector<Triangle>& triangles) {
  std::size_t kept = 0;
  for (const Triangle& t : triangles) {
    const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
    const bool is_back = glm::dot(glm::cross(b - a, c - a), eye - a) < 0.0F;
    triangles[kept] = t;
    kept += is_back ? 0 : 1;
  }
  triangles.resize(kept);
}

}  // namespace

std::span<const OccluderPart> Occluder::build(std::span<const RefineObject> objects, CutSet& cuts, const View& view,
                                              std::span<const ObjectView> views, OccluderMode mode) {
  parts_.resize(cuts.size());
  result_.clear();
  const bool is_paper = mode == OccluderMode::paper;
  if (!is_paper) build_conservative(objects, cuts, view, views);
  for (std::uint32_t i = 0; i < cuts.size(); ++i) {
    Part& part = parts_[i];
    const std::span<const glm::vec3> positions = cuts[i].hierarchy().positions();
    if (is_paper) {
      cuts.active_triangles(i, part.triangles, false);
      if (!objects[i].two_sided) drop_back_faces(positions, views[i].eye(), part.triangles);
    }
    result_.push_back({i, is_paper ? positions : std::span<const glm::vec3>(part.positions), part.triangles});
  }
  return result_;
}

void Occluder::build_conservative(std::span<const RefineObject> objects, CutSet& cuts, const View& view,
                                  std::span<const ObjectView> views) {
  hold_motions(cuts);
  tiles_.begin(view, without_.tiles);
  for (std::uint32_t i = 0; i < cuts.size(); ++i) {
    cuts.active_triangles(i, parts_[i].triangles, true);  // sorts its splits
    find_vertices(cuts[i], *motions_[i]);
    find_faces(cuts[i], *motions_[i]);
    tiles_.add(i, faces_, cuts[i].hierarchy().positions(), views[i], objects[i].two_sided);
  }
  for (std::uint32_t i = 0; i < cuts.size(); ++i) {
    parts_[i].positions.clear();
    parts_[i].triangles.clear();
    tiles_.write(i, views[i], parts_[i].positions, parts_[i].triangles);
  }
}

// Those of a Refiner stay the same.
void Occluder::hold_motions(const CutSet& cuts) {
  motions_.resize(cuts.size());
  held_.resize(cuts.size(), nullptr);
  for (std::uint32_t i = 0; i < cuts.size(); ++i) {
    const Hierarchy& hierarchy = cuts.hierarchy(i);
    if (held_[i] == hierarchy.positions().data()) continue;
    motions_[i] = motion_of(hierarchy);
    held_[i] = hierarchy.positions().data();
  }
}

void Occluder::find_vertices(const Cut& cut, const SurfaceMotion& motion) {
  const Hierarchy& hierarchy = cut.hierarchy();
  base_roots_.assign(hierarchy.base_vertex_count(), no_id);
  for (const SplitId root : hierarchy.data().roots) {
    const VertexId u = hierarchy.star(root).parent_vertex();
    if (u < base_roots_.size()) base_roots_[u] = root;
  }
  vertices_.clear();
  for (VertexId v = 0; v < base_roots_.size(); ++v) add_vertex(cut, motion, v, base_roots_[v]);
  for (const SplitId s : cut.applied_splits())
    add_vertex(cut, motion, hierarchy.vertex_of(s), hierarchy.node(s).child_v);
}

void Occluder::add_vertex(const Cut& cut, const SurfaceMotion& motion, VertexId v, SplitId first) {
  while (first != no_id && cut.applied(first)) first = cut.hierarchy().node(first).child_u;
  vertices_.push_back({first, motion.is_marked(v, first)});
}

const Occluder::CutVertex& Occluder::vertex(const Cut& cut, VertexId v) const {
  const std::size_t base = cut.hierarchy().base_vertex_count();
  if (v < base) return vertices_[v];
  const std::span<const SplitId> applied = cut.applied_splits();
  const auto place = std::lower_bound(applied.begin(), applied.end(), static_cast<SplitId>(v - base));
  return vertices_[base + static_cast<std::size_t>(place - applied.begin())];
}

void Occluder::find_faces(const Cut& cut, const SurfaceMotion& motion) {
  faces_.clear();
  cut.for_each_active([&](const FaceRef& ref, const Triangle& t) {
    MovedFace face{t, without_.motion ? 0.0F : motion.moved(ref)};
    for (int k = 0; k < 3; ++k) {
      const CutVertex& corner = vertex(cut, t[k]);
      if (without_.motion && corner.first_left != no_id)
        face.moved = std::max(face.moved, cut.hierarchy().node(corner.first_left).guaranteed_error);
      face.marked = static_cast<std::uint8_t>(face.marked | (corner.is_marked ? 1U << static_cast<unsigned>(k) : 0U));
    }
    faces_.push_back(face);
  });
}

}  // namespace occlod
