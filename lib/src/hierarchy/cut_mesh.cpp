#include "occlod/hierarchy/cut_mesh.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "active_faces.h"

namespace occlod {
namespace {

// How many triangles there are after split s when there were `triangles` before it.
std::size_t grown(const Hierarchy& hierarchy, std::size_t triangles, SplitId s) {
  const SplitStar star = hierarchy.star(s);
  return triangles + star.inserted_count() - star.removed_count();
}

template <class IsApplied>
FixedCut make_cut(const Hierarchy& hierarchy, const IsApplied& is_applied) {
  hierarchy.require_all();
  FixedCut cut;
  cut.applied.resize(hierarchy.split_count());
  cut.triangles = hierarchy.base_triangle_count();
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    const SplitNode& node = hierarchy.node(s);
    if (is_applied(s)) {
      cut.applied[s] = true;
      ++cut.splits;
      cut.triangles = grown(hierarchy, cut.triangles, s);
    } else {
      cut.guaranteed_error = std::max(cut.guaranteed_error, node.guaranteed_error);
      cut.error = std::max(cut.error, node.error);
    }
  }
  return cut;
}

class Compaction {
 public:
  explicit Compaction(const HierarchyView& data) : data_(data), new_ids_(data.positions.size(), no_id) {}

  void add(Triangle triangle) {
    for (int corner = 0; corner < 3; ++corner) triangle[corner] = new_id(triangle[corner]);
    mesh_.triangles.push_back(triangle);
  }
  [[nodiscard]] TriangleMesh take() { return std::move(mesh_); }

 private:
  VertexId new_id(VertexId v) {
    if (new_ids_[v] == no_id) {
      new_ids_[v] = static_cast<VertexId>(mesh_.positions.size());
      mesh_.positions.push_back(data_.positions[v]);
      if (!data_.normals.empty()) mesh_.normals.push_back(data_.normals[v]);
      if (!data_.colors.empty()) mesh_.colors.push_back(data_.colors[v]);
    }
    return new_ids_[v];
  }

  const HierarchyView& data_;
  std::vector<VertexId> new_ids_;
  TriangleMesh mesh_;
};

}  // namespace

FixedCut full_cut(const Hierarchy& hierarchy) {
  return make_cut(hierarchy, [](SplitId) { return true; });
}

FixedCut cut_to_triangles(const Hierarchy& hierarchy, std::size_t max_triangles) {
  hierarchy.require_all();
  SplitId end = 0;
  std::size_t triangles = hierarchy.base_triangle_count();
  for (; end < hierarchy.split_count(); ++end) {
    triangles = grown(hierarchy, triangles, end);
    if (triangles > max_triangles) break;
  }
  return make_cut(hierarchy, [&](SplitId s) { return s < end; });
}

FixedCut cut_to_error(const Hierarchy& hierarchy, double max_error) {
  return make_cut(hierarchy, [&](SplitId s) { return hierarchy.node(s).guaranteed_error > max_error; });
}

std::vector<Triangle> triangles_of(const Hierarchy& hierarchy, const FixedCut& cut) {
  assert(cut.applied.size() == hierarchy.split_count());
  return active_triangles(hierarchy, cut.applied);
}

TriangleMesh cut_mesh(const Hierarchy& hierarchy, const FixedCut& cut) {
  Compaction compaction(hierarchy.data());
  for (const Triangle& triangle : triangles_of(hierarchy, cut)) compaction.add(triangle);
  return compaction.take();
}

}  // namespace occlod
