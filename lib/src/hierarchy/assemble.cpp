#include "assemble.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <span>

#include "occlod/core/error.h"
#include "parallel.h"
#include "star_mesh.h"
#include "star_record.h"

namespace occlod {
namespace {

// A face that a split removes: face `slot` of the faces that collapse `collapse` ended, or of the base.
struct DeadFace {
  SplitId born = no_id;  // the split that inserts it; none = the base mesh
  std::uint32_t slot = 0;
  friend auto operator<=>(const DeadFace&, const DeadFace&) = default;
};

// Brings faces that are one fan around v into ring order, each with v first.
StarShape order_fan(VertexId v, std::span<LevelFace> faces) {
  if (faces.empty() || faces.size() > SplitStar::most_ring) return StarShape::other;
  for (LevelFace& face : faces) {
    if (!contains(face.corners, v)) return StarShape::other;
    const OppositeEdge e = opposite_edge(face.corners, v);
    face.corners = {v, e.next, e.last};
  }
  // An open fan starts at the face that none leads to.
  const auto leads_to = [&](VertexId w) {
    return std::find_if(faces.begin(), faces.end(), [&](const LevelFace& f) { return f.corners.z == w; });
  };
  const auto start = std::find_if(faces.begin(), faces.end(),
                                  [&](const LevelFace& f) { return leads_to(f.corners.y) == faces.end(); });
  if (start != faces.end()) std::swap(faces[0], *start);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    std::size_t k = i;
    while (k < faces.size() && faces[k].corners.y != faces[i - 1].corners.z) ++k;
    if (k == faces.size()) return StarShape::other;
    std::swap(faces[i], faces[k]);
  }
  return faces.back().corners.z == faces[0].corners.y ? StarShape::closed_fan : StarShape::open_fan;
}

class Assembler {
 public:
  Assembler(const TriangleMesh& mesh, CollapseSequence sequence, unsigned threads)
      : mesh_(mesh),
        sequence_(std::move(sequence)),
        threads_(threads),
        split_count_(static_cast<SplitId>(sequence_.collapses.size() - 1)) {}

  HierarchyData run() {
    number_vertices();
    copy_vertices();
    number_collapses();
    order_stars();
    find_removed();
    write_stars();
    link_forest();
    saturate_errors();
    return std::move(data_);
  }

 private:
  // Split s undoes the s-th last collapse.
  [[nodiscard]] std::size_t collapse_index(SplitId s) const { return split_count_ - 1 - s; }
  [[nodiscard]] const Collapse& collapse_of(SplitId s) const { return sequence_.collapses[collapse_index(s)]; }
  [[nodiscard]] std::span<LevelFace> star_of(SplitId s) {
    const std::size_t begin = collapse_of(s).first_ended;
    return {sequence_.ended.data() + begin, sequence_.collapses[collapse_index(s) + 1].first_ended - begin};
  }
  [[nodiscard]] Triangle renumbered(const Triangle& t) const { return {new_id_[t.x], new_id_[t.y], new_id_[t.z]}; }

  template <typename Visit>
  void for_each_split(const Visit& visit) const {
    for_each_range(split_count_, threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) visit(static_cast<SplitId>(s));
    });
  }

  void number_vertices() {
    const std::size_t vertices = mesh_.vertex_count();
    base_vertices_ = static_cast<VertexId>(vertices - split_count_);
    new_id_.assign(vertices, no_id);
    for_each_split([&](SplitId s) { new_id_[collapse_of(s).v] = base_vertices_ + s; });
    VertexId next = 0;
    for (VertexId& id : new_id_)
      if (id == no_id) id = next++;
  }

  void copy_vertices() {
    const auto permute = [&](const auto& from, auto& to) {
      to.resize(from.size());
      for_each_range(from.size(), threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) to[new_id_[v]] = from[v];
      });
    };
    permute(mesh_.positions, data_.positions);
    permute(mesh_.normals, data_.normals);
    permute(mesh_.colors, data_.colors);
    data_.box = bounding_box(data_.positions);
    data_.input_triangle_count = mesh_.triangle_count();
    data_.face_count = sequence_.base.size() + sequence_.ended.size();
  }

  void number_collapses() {
    CollapseId end = 0;
    for (std::size_t i = 0; i < split_count_; ++i) end = std::max(end, sequence_.collapses[i].id + 1);
    split_of_.assign(end, no_id);
    for_each_split([&](SplitId s) { split_of_[collapse_of(s).id] = s; });
  }

  // The faces that the collapse of split s ended are those that it inserts; their places are their slots.
  void order_stars() {
    shapes_.resize(split_count_);
    for_each_split([&](SplitId s) { shapes_[s] = order_fan(collapse_of(s).v, star_of(s)); });
  }

  // A face dies with the split that undoes the collapse which made it. Sorts the faces by the splits that remove them,
  // then by those that insert them.
  void find_removed() {
    first_removed_.assign(split_count_ + 1, 0);
    const auto for_each_dead = [&](const auto& visit) {
      for (std::uint32_t slot = 0; slot < sequence_.base.size(); ++slot)
        if (sequence_.base[slot].made_by != no_id)
          visit(split_of_[sequence_.base[slot].made_by], DeadFace{no_id, slot});
      for_each_split([&](SplitId s) {
        const std::span<const LevelFace> star = star_of(s);
        for (std::uint32_t slot = 0; slot < star.size(); ++slot)
          if (star[slot].made_by != no_id) visit(split_of_[star[slot].made_by], DeadFace{s, slot});
      });
    };
    for_each_dead([&](SplitId s, const DeadFace&) {
      std::atomic_ref(first_removed_[s]).fetch_add(1, std::memory_order_relaxed);
    });
    std::uint32_t sum = 0;
    for (std::uint32_t& first : first_removed_) first = sum += first;  // the end of each run, moved to its start below
    removed_.resize(sum);
    for_each_dead([&](SplitId s, const DeadFace& face) {
      removed_[std::atomic_ref(first_removed_[s]).fetch_sub(1, std::memory_order_relaxed) - 1] = face;
    });
    for_each_split(
        [&](SplitId s) { std::sort(removed_.begin() + first_removed_[s], removed_.begin() + first_removed_[s + 1]); });
  }

  // Ranges of splits write their records on their own; then these are joined.
  void write_stars() {
    data_.nodes.resize(split_count_ + 1);
    std::vector<std::vector<std::uint32_t>> ranges((split_count_ + range_size - 1) / range_size);
    for_each_range(split_count_, threads_, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t>& words = ranges[begin / range_size];
      words.reserve((end - begin) * 11);
      StarWriter writer(*this);
      for (std::size_t s = begin; s < end; ++s) {
        data_.nodes[s].star = static_cast<std::uint32_t>(words.size());
        writer.write(static_cast<SplitId>(s), words);
      }
    });
    std::vector<std::size_t> starts(ranges.size() + 1, 0);
    for (std::size_t i = 0; i < ranges.size(); ++i) starts[i + 1] = starts[i] + ranges[i].size();
    if (starts.back() > std::numeric_limits<std::uint32_t>::max())
      throw Error({"mesh", "", "is too large for 32-bit places of stars", "split it into several meshes"});
    data_.stars.resize(starts.back());
    for_each_range(split_count_, threads_, [&](std::size_t begin, std::size_t end) {
      const std::size_t start = starts[begin / range_size];
      const std::vector<std::uint32_t>& words = ranges[begin / range_size];
      std::copy(words.begin(), words.end(), data_.stars.begin() + static_cast<std::ptrdiff_t>(start));
      for (std::size_t s = begin; s < end; ++s) data_.nodes[s].star += static_cast<std::uint32_t>(start);
    });
    data_.nodes[split_count_].star = static_cast<std::uint32_t>(data_.stars.size());
    for (const LevelFace& face : sequence_.base) data_.base_faces.push_back(renumbered(face.corners));
  }

  class StarWriter {
   public:
    explicit StarWriter(Assembler& assembler) : a_(assembler) {}

    void write(SplitId s, std::vector<std::uint32_t>& words) {
      inserted_.clear();
      for (const LevelFace& face : a_.star_of(s)) inserted_.push_back(a_.renumbered(face.corners));
      removed_.clear();
      for (std::uint32_t i = a_.first_removed_[s]; i < a_.first_removed_[s + 1]; ++i) {
        const DeadFace& dead = a_.removed_[i];
        const LevelFace& face = dead.born == no_id ? a_.sequence_.base[dead.slot] : a_.star_of(dead.born)[dead.slot];
        removed_.push_back({{dead.born, dead.slot}, a_.renumbered(face.corners)});
      }
      find_dependencies(s);
      append_star({a_.new_id_[a_.collapse_of(s).u], a_.shapes_[s], inserted_, removed_, dependencies_}, words);
    }

   private:
    // A split needs the faces that it removes, so the splits that inserted them; and every other corner of the faces
    // that it inserts, which matters only where no removed face brings it along: at ears of a boundary and for
    // components that vanish.
    void find_dependencies(SplitId s) {
      dependencies_.clear();
      for (const RemovedFace& face : removed_)
        if (face.ref.split != no_id) dependencies_.push_back(face.ref.split);
      corners_.clear();
      for (const RemovedFace& face : removed_)
        for (int k = 0; k < 3; ++k) corners_.push_back(face.corners[k]);
      std::sort(corners_.begin(), corners_.end());
      const VertexId base = a_.base_vertices_;
      for (const Triangle& t : inserted_)
        for (int k = 0; k < 3; ++k)
          if (t[k] >= base && t[k] != base + s && !std::binary_search(corners_.begin(), corners_.end(), t[k]))
            dependencies_.push_back(t[k] - base);
      std::sort(dependencies_.begin(), dependencies_.end());
      dependencies_.erase(std::unique(dependencies_.begin(), dependencies_.end()), dependencies_.end());
    }

    Assembler& a_;
    std::vector<Triangle> inserted_;
    std::vector<RemovedFace> removed_;
    std::vector<VertexId> corners_;  // of removed faces
    std::vector<SplitId> dependencies_;
  };

  void link_forest() {
    std::vector<SplitId> last_at(data_.positions.size(),
                                 no_id);  // the newest split that has the vertex at one of its ends
    for (SplitId s = 0; s < split_count_; ++s) {
      const VertexId u = new_id_[collapse_of(s).u];
      const SplitId parent = last_at[u];
      data_.nodes[s].parent = parent;
      if (parent == no_id) {
        data_.roots.push_back(s);
      } else {
        SplitNode& above = data_.nodes[parent];
        (base_vertices_ + parent == u ? above.child_v : above.child_u) = s;
      }
      last_at[u] = s;
      last_at[base_vertices_ + s] = s;
    }
  }

  // From fine to coarse, so that each split has its final errors before they are handed on.
  void saturate_errors() {
    struct Errors {
      float quadric, guaranteed;
    };
    std::vector<Errors> errors(split_count_);
    for_each_split([&](SplitId s) { errors[s] = {collapse_of(s).error, collapse_of(s).guaranteed_error}; });
    for (SplitId s = split_count_; s-- > 0;) {
      const auto raise = [&](SplitId coarse) {
        Errors& e = errors[coarse];
        e = {std::max(e.quadric, errors[s].quadric), std::max(e.guaranteed, errors[s].guaranteed)};
      };
      SplitNode& node = data_.nodes[s];
      node.error = errors[s].quadric;
      node.guaranteed_error = errors[s].guaranteed;
      if (node.parent != no_id) raise(node.parent);
      const SplitStar star(data_.stars.data() + node.star, base_vertices_ + s);
      for (const SplitId needed : star.dependencies()) raise(needed);
    }
    for (const SplitId root : data_.roots)
      data_.error_bound = std::max(data_.error_bound, data_.nodes[root].guaranteed_error);
  }

  const TriangleMesh& mesh_;
  CollapseSequence sequence_;
  unsigned threads_;
  SplitId split_count_ = 0;
  VertexId base_vertices_ = 0;
  std::vector<VertexId> new_id_;   // of each input vertex
  std::vector<SplitId> split_of_;  // each collapse id
  std::vector<StarShape> shapes_;
  std::vector<std::uint32_t> first_removed_;  // into removed_, for each split
  std::vector<DeadFace> removed_;
  HierarchyData data_;
};

}  // namespace

HierarchyData assemble(const TriangleMesh& mesh, CollapseSequence sequence, unsigned threads) {
  return Assembler(mesh, std::move(sequence), threads).run();
}

}  // namespace occlod
