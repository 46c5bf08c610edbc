#include "assemble.h"

#include <algorithm>
#include <span>

#include "star_mesh.h"

namespace occlod {
namespace {

class Assembler {
 public:
  Assembler(const TriangleMesh& mesh, const CollapseSequence& sequence)
      : mesh_(mesh), sequence_(sequence), split_count_(static_cast<SplitId>(sequence.collapses.size() - 1)) {}

  HierarchyData run() {
    number_vertices();
    copy_vertices();
    make_faces();
    link_forest();
    find_dependencies();
    saturate_errors();
    return std::move(data_);
  }

 private:
  // Split s undoes the s-th last collapse.
  [[nodiscard]] std::size_t collapse_index(SplitId s) const { return split_count_ - 1 - s; }
  [[nodiscard]] const Collapse& collapse_of(SplitId s) const { return sequence_.collapses[collapse_index(s)]; }

  void number_vertices() {
    const std::size_t vertices = mesh_.vertex_count();
    base_vertices_ = static_cast<VertexId>(vertices - split_count_);
    new_id_.assign(vertices, no_id);
    for (SplitId s = 0; s < split_count_; ++s) new_id_[collapse_of(s).v] = base_vertices_ + s;
    VertexId next = 0;
    for (VertexId& id : new_id_)
      if (id == no_id) id = next++;
  }

  void copy_vertices() {
    const auto permute = [&](const auto& from, auto& to) {
      to.resize(from.size());
      for (std::size_t v = 0; v < from.size(); ++v) to[new_id_[v]] = from[v];
    };
    permute(mesh_.positions, data_.positions);
    permute(mesh_.normals, data_.normals);
    permute(mesh_.colors, data_.colors);
  }

  // Base faces first, then those that each split inserts: the faces that its collapse ended. A face dies with the split
  // that undoes the collapse which made it.
  void make_faces() {
    const std::vector<SplitId> split_of = number_collapses();
    const std::size_t faces = sequence_.base.size() + sequence_.ended.size();
    data_.faces.reserve(faces);
    data_.died.reserve(faces);
    data_.nodes.resize(split_count_ + 1);
    const auto add = [&](const LevelFace& face) {
      data_.faces.emplace_back(new_id_[face.corners.x], new_id_[face.corners.y], new_id_[face.corners.z]);
      data_.died.push_back(face.made_by == no_id ? no_id : split_of[face.made_by]);
    };
    for (const LevelFace& face : sequence_.base) add(face);
    for (SplitId s = 0; s < split_count_; ++s) {
      SplitNode& node = data_.nodes[s];
      const Collapse& collapse = collapse_of(s);
      node.parent_vertex = new_id_[collapse.u];
      node.error = collapse.error;
      node.guaranteed_error = collapse.guaranteed_error;
      node.first_inserted = static_cast<FaceId>(data_.faces.size());
      const std::size_t end = sequence_.collapses[collapse_index(s) + 1].first_ended;
      for (std::size_t i = collapse.first_ended; i < end; ++i) add(sequence_.ended[i]);
    }
    data_.nodes[split_count_].first_inserted = static_cast<FaceId>(data_.faces.size());
    remove_faces();
  }

  [[nodiscard]] std::vector<SplitId> number_collapses() const {
    CollapseId end = 0;
    for (std::size_t i = 0; i < split_count_; ++i) end = std::max(end, sequence_.collapses[i].id + 1);
    std::vector<SplitId> split_of(end, no_id);
    for (SplitId s = 0; s < split_count_; ++s) split_of[collapse_of(s).id] = s;
    return split_of;
  }

  // Sorts the faces by the split that removes them.
  void remove_faces() {
    std::vector<std::uint32_t> next(split_count_ + 1, 0);
    for (const SplitId s : data_.died)
      if (s != no_id) ++next[s + 1];
    for (SplitId s = 0; s < split_count_; ++s) {
      next[s + 1] += next[s];
      data_.nodes[s].first_removed = next[s];
    }
    data_.nodes[split_count_].first_removed = next[split_count_];
    data_.removed_faces.resize(next[split_count_]);
    for (FaceId f = 0; f < data_.faces.size(); ++f)
      if (data_.died[f] != no_id) data_.removed_faces[next[data_.died[f]]++] = f;
  }

  void link_forest() {
    std::vector<SplitId> last_at(data_.positions.size(),
                                 no_id);  // the newest split that has the vertex at one of its ends
    for (SplitId s = 0; s < split_count_; ++s) {
      SplitNode& node = data_.nodes[s];
      const VertexId u = node.parent_vertex;
      const SplitId parent = last_at[u];
      if (parent == no_id) {
        data_.roots.push_back(s);
      } else {
        SplitNode& above = data_.nodes[parent];
        node.level = above.level + 1;
        (base_vertices_ + parent == u ? above.child_v : above.child_u) = s;
      }
      last_at[u] = s;
      last_at[base_vertices_ + s] = s;
    }
  }

  // A split needs the faces that it removes, so the splits that inserted them; and every other corner of the faces that
  // it inserts, which matters only where no removed face brings it along: at ears of a boundary and for components that
  // vanish.
  void find_dependencies() {
    const std::vector<SplitId> born = births();
    data_.first_dependency.reserve(split_count_ + 1);
    data_.dependencies.reserve(data_.removed_faces.size());
    std::vector<SplitId> needs;
    for (SplitId s = 0; s < split_count_; ++s) {
      data_.first_dependency.push_back(static_cast<std::uint32_t>(data_.dependencies.size()));
      needs.clear();
      const std::span<const FaceId> removed(data_.removed_faces.data() + data_.nodes[s].first_removed,
                                            data_.nodes[s + 1].first_removed - data_.nodes[s].first_removed);
      for (const FaceId f : removed)
        if (born[f] != no_id) needs.push_back(born[f]);
      for (FaceId f = data_.nodes[s].first_inserted; f < data_.nodes[s + 1].first_inserted; ++f)
        for (int k = 0; k < 3; ++k) {
          const VertexId w = data_.faces[f][k];
          if (w >= base_vertices_ && w != base_vertices_ + s && !is_corner(w, removed))
            needs.push_back(w - base_vertices_);
        }
      std::sort(needs.begin(), needs.end());
      needs.erase(std::unique(needs.begin(), needs.end()), needs.end());
      data_.dependencies.insert(data_.dependencies.end(), needs.begin(), needs.end());
    }
    data_.first_dependency.push_back(static_cast<std::uint32_t>(data_.dependencies.size()));
  }

  [[nodiscard]] bool is_corner(VertexId w, std::span<const FaceId> faces) const {
    return std::any_of(faces.begin(), faces.end(), [&](FaceId f) { return contains(data_.faces[f], w); });
  }

  // The split that inserts each face.
  [[nodiscard]] std::vector<SplitId> births() const {
    std::vector<SplitId> born(data_.faces.size(), no_id);
    for (SplitId s = 0; s < split_count_; ++s)
      std::fill(born.begin() + data_.nodes[s].first_inserted, born.begin() + data_.nodes[s + 1].first_inserted, s);
    return born;
  }

  // From fine to coarse, so that each split has its final errors before they are handed on.
  void saturate_errors() {
    const auto raise = [&](SplitId coarse, const SplitNode& fine) {
      SplitNode& node = data_.nodes[coarse];
      node.error = std::max(node.error, fine.error);
      node.guaranteed_error = std::max(node.guaranteed_error, fine.guaranteed_error);
    };
    for (SplitId s = split_count_; s-- > 0;) {
      const SplitNode& node = data_.nodes[s];
      for (const SplitId child : {node.child_u, node.child_v})
        if (child != no_id) raise(s, data_.nodes[child]);
      for (std::uint32_t i = data_.first_dependency[s]; i < data_.first_dependency[s + 1]; ++i)
        raise(data_.dependencies[i], node);
    }
  }

  const TriangleMesh& mesh_;
  const CollapseSequence& sequence_;
  SplitId split_count_ = 0;
  VertexId base_vertices_ = 0;
  std::vector<VertexId> new_id_;  // of each input vertex
  HierarchyData data_;
};

}  // namespace

HierarchyData assemble(const TriangleMesh& mesh, const CollapseSequence& sequence) {
  return Assembler(mesh, sequence).run();
}

}  // namespace occlod
