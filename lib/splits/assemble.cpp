#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "base/platform.h"
#include "base/threads.h"
#include "occlod/base.h"
#include "occlod/mesh.h"
#include "splits/attribute_state.h"
#include "splits/build_steps.h"
#include "splits/hierarchy_data.h"
#include "splits/simplify.h"
#include "splits/star.h"
#include "splits/star_mesh.h"
#include "splits/star_patch.h"
#include "splits/star_record.h"

namespace occlod {
namespace {

// Numbers the wedges of a hierarchy: those of the input and those that collapses across seams add.

// Numbers pairs of a vertex and the input wedge whose attributes it has. Vertex ids are those of the hierarchy, wedge
// ids those of the mesh.
class WedgeNumbers {
 public:
  // `new_ids` maps each vertex of the mesh to its number in the hierarchy. The mesh, the sequence and new_ids must
  // outlive this object. O(n log n).
  WedgeNumbers(const TriangleMesh& mesh, const CollapseSequence& sequence, std::span<const VertexId> new_ids);

  // Returns the new number of a wedge at a corner of this vertex of the mesh. O(log n).
  [[nodiscard]] WedgeId operator()(VertexId vertex, WedgeId wedge) const;
  [[nodiscard]] Triangle operator()(const Triangle& vertices, const Triangle& wedges) const;

  // Copies the attributes and materials of all wedges into `data`.
  void copy_attributes(HierarchyData& data) const;

 private:
  struct Extra {
    VertexId vertex;  // id in the hierarchy
    WedgeId wedge;    // id in the mesh
    friend bool operator==(const Extra&, const Extra&) = default;
    friend bool operator<(const Extra& a, const Extra& b) {
      return a.vertex != b.vertex ? a.vertex < b.vertex : a.wedge < b.wedge;
    }
  };
  void add(VertexId vertex, WedgeId wedge);

  const TriangleMesh& mesh_;
  std::span<const VertexId> new_ids_;
  std::vector<Extra> extras_;  // ascending
};

WedgeNumbers::WedgeNumbers(const TriangleMesh& mesh, const CollapseSequence& sequence,
                           std::span<const VertexId> new_ids)
    : mesh_(mesh), new_ids_(new_ids) {
  for (WedgeId w = static_cast<WedgeId>(mesh.vertex_count()); w < mesh.wedge_count(); ++w) add(mesh.vertex_of(w), w);
  for (std::size_t c = 0; c < sequence.attributes.size(); ++c)
    for (const EndedCorners& face : sequence.attributes[c].corners)
      for (int i = 0; i < 3; ++i) add(sequence.collapses[c]->ended(face.slot)[i], face.wedges[i]);
  for (std::size_t f = 0; f < sequence.base_corners.size(); ++f)
    for (int i = 0; i < 3; ++i) add(sequence.base[f].corners[i], sequence.base_corners[f][i]);
  std::sort(extras_.begin(), extras_.end());
  extras_.erase(std::unique(extras_.begin(), extras_.end()), extras_.end());
}

void WedgeNumbers::add(VertexId vertex, WedgeId wedge) {
  if (vertex != wedge) extras_.push_back({new_ids_[vertex], wedge});
}

WedgeId WedgeNumbers::operator()(VertexId vertex, WedgeId wedge) const {
  const VertexId id = new_ids_[vertex];
  if (vertex == wedge) return id;
  const auto at = std::lower_bound(extras_.begin(), extras_.end(), Extra{id, wedge});
  return static_cast<WedgeId>(new_ids_.size()) + static_cast<WedgeId>(at - extras_.begin());
}

Triangle WedgeNumbers::operator()(const Triangle& vertices, const Triangle& wedges) const {
  return {(*this)(vertices.x, wedges.x), (*this)(vertices.y, wedges.y), (*this)(vertices.z, wedges.z)};
}

void WedgeNumbers::copy_attributes(HierarchyData& data) const {
  const std::size_t vertices = new_ids_.size();
  const auto copy = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.resize(vertices + extras_.size());
    for (VertexId v = 0; v < vertices; ++v) to[new_ids_[v]] = from[v];
    for (std::size_t i = 0; i < extras_.size(); ++i) to[vertices + i] = from[extras_[i].wedge];
  };
  copy(mesh_.normals, data.normals);
  copy(mesh_.colors, data.colors);
  copy(mesh_.texture_coordinates, data.texture_coordinates);
  copy(wedge_materials(mesh_), data.wedge_materials);
  data.extra_wedges.reserve(extras_.size());
  for (const Extra& extra : extras_) {
    data.extra_wedges.push_back(extra.vertex);
    data.positions.push_back(glm::vec3(data.positions[extra.vertex]));
  }
}

// Writes the wedges of all faces of a hierarchy, given the collapse sequence.

// Writes the corner records of a range of splits in order.
class CornerWriter {
 public:
  CornerWriter(const CollapseSequence& sequence, const WedgeNumbers& numbers)
      : sequence_(sequence), numbers_(numbers) {}

  void write(std::size_t place, const SplitStar& star, std::vector<std::uint32_t>& words) {
    const std::span<const EndedCorners> corners = sequence_.attributes[place].corners;
    if (corners.empty()) return;
    const Collapse& collapse = *sequence_.collapses[place];
    wedges_.clear();
    for (std::uint32_t slot = 0; slot < collapse.ended_count(); ++slot) wedges_.push_back(star.inserted(slot));
    for (const EndedCorners& face : corners) wedges_[face.slot] = numbers_(collapse.ended(face.slot), face.wedges);
    append_corners(star, wedges_, words);
  }

 private:
  const CollapseSequence& sequence_;
  const WedgeNumbers& numbers_;
  std::vector<Triangle> wedges_;
};

// Fills in corners, corner_starts and base_corners of `data`, whose star records are already written; the record of
// split s starts at star_starts[s]. The result does not depend on the number of threads. O(n).
void write_corners(const CollapseSequence& sequence, const WedgeNumbers& numbers,
                   std::span<const std::uint32_t> star_starts, unsigned threads, HierarchyData& data) {
  const std::size_t splits = sequence.collapses.size();
  const std::size_t vertices = data.positions.size() - data.extra_wedges.size();
  data.corner_starts.resize(splits + 1);
  std::vector<std::vector<std::uint32_t>> ranges((splits + range_size - 1) / range_size);
  for_each_range(splits, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t>& words = ranges[begin / range_size];
    CornerWriter writer(sequence, numbers);
    for (std::size_t s = begin; s < end; ++s) {
      data.corner_starts[s] = static_cast<std::uint32_t>(words.size());
      const SplitStar star(data.stars.data() + star_starts[s], static_cast<VertexId>(vertices - splits + s));
      writer.write(splits - 1 - s, star, words);
    }
  });
  std::size_t start = 0;
  for (std::size_t r = 0; r < ranges.size(); ++r) {
    for (std::size_t s = r * range_size; s < std::min((r + 1) * range_size, splits); ++s)
      data.corner_starts[s] += static_cast<std::uint32_t>(start);
    start += ranges[r].size();
    if (start >= std::numeric_limits<std::uint32_t>::max())
      throw Error({"mesh", "", "has too many seams for 32-bit places of wedges", "split it into several meshes"});
  }
  data.corner_starts[splits] = static_cast<std::uint32_t>(start);
  data.corners.reserve(start);
  for (const std::vector<std::uint32_t>& words : ranges)
    data.corners.insert(data.corners.end(), words.begin(), words.end());
  for (std::size_t f = 0; f < sequence.base.size(); ++f)
    data.base_corners.push_back(numbers(sequence.base[f].corners, sequence.base_corners[f]));
}

// Describes a removed face whose place the star's own faces do not imply.
struct RemovedElsewhere {
  SplitId split = no_id;
  FaceRef face;
  friend bool operator<(const RemovedElsewhere& a, const RemovedElsewhere& b) {
    return std::tuple(a.split, a.face.split, a.face.slot) < std::tuple(b.split, b.face.split, b.face.slot);
  }
};

class Assembler {
 public:
  Assembler(const TriangleMesh& mesh, CollapseSequence sequence, unsigned threads)
      : mesh_(mesh),
        sequence_(std::move(sequence)),
        threads_(threads),
        split_count_(static_cast<SplitId>(sequence_.collapses.size())) {}

  Assembly run() {
    number_vertices();
    copy_vertices();
    list_misplaced();
    write_stars();
    link_forest();
    saturate_errors();
    return std::move(result_);
  }

 private:
  // Split s undoes the s-th last collapse, so the same function converts places in both directions.
  [[nodiscard]] std::uint32_t reversed(std::uint32_t place) const { return split_count_ - 1 - place; }
  [[nodiscard]] SplitId split_of(CollapseId id) const { return reversed(sequence_.places[id]); }
  [[nodiscard]] const Collapse& collapse_of(SplitId s) const { return *sequence_.collapses[reversed(s)]; }
  [[nodiscard]] Triangle renumbered(const Triangle& t) const { return {new_id_[t.x], new_id_[t.y], new_id_[t.z]}; }

  template <typename Visit>
  void for_each_split(const Visit& visit) const {
    for_each_id(split_count_, threads_, visit);
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
      to.resize(std::min(from.size(), mesh_.vertex_count()));
      for_each_id(to.size(), threads_, [&](VertexId v) { to[new_id_[v]] = from[v]; });
    };
    permute(mesh_.positions, result_.data.positions);
    if (sequence_.has_attributes) {
      numbers_.emplace(mesh_, sequence_, new_id_);
      numbers_->copy_attributes(result_.data);
    } else {
      permute(mesh_.normals, result_.data.normals);
      permute(mesh_.colors, result_.data.colors);
      permute(wedge_materials(mesh_), result_.data.wedge_materials);
    }
    result_.data.materials = mesh_.materials;
    result_.data.textures = mesh_.textures;
    result_.data.texture_origin = mesh_.texture_origin;
    result_.data.origin = mesh_.origin;
    result_.data.up = mesh_.up;
    result_.data.box = bounding_box(result_.data.positions);
    result_.data.input_triangle_count = mesh_.triangle_count();
  }

  // A face is removed by the split that undoes the collapse which made it.
  void list_misplaced() {
    for (std::uint32_t slot = 0; slot < sequence_.base.size(); ++slot)
      if (const LevelFace& face = sequence_.base[slot]; face.made_by != no_id)
        misplaced_.push_back({split_of(face.made_by), {no_id, slot}});
    for (const MisplacedFace& face : sequence_.misplaced)
      misplaced_.push_back({split_of(face.made_by), {split_of(face.ended_by), face.slot}});
    std::sort(misplaced_.begin(), misplaced_.end());
  }

  // Each range of splits writes its records independently; the ranges are then joined.
  void write_stars() {
    result_.stars.resize(split_count_ + 1);
    // Takes as much memory as the nodes, which get it afterwards.
    result_.patches.reserve(sizeof(SplitNode) * (std::size_t{split_count_} + 1) / sizeof(BoundedPatch) + 1);
    result_.patches.resize(split_count_);
    std::vector<std::vector<std::uint32_t>> ranges((split_count_ + range_size - 1) / range_size);
    std::atomic<std::size_t> faces = sequence_.base.size();
    for_each_range(split_count_, threads_, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t>& words = ranges[begin / range_size];
      words.reserve((end - begin) * 12);
      StarWriter writer(*this);
      StarBounder bounder(*this);
      for (std::size_t s = begin; s < end; ++s) {
        result_.stars[s] = static_cast<std::uint32_t>(words.size());
        writer.write(static_cast<SplitId>(s), words);
        bounder.add(static_cast<SplitId>(s));
      }
      bounder.finish(words);
      faces += writer.face_count();
    });
    result_.data.face_count = faces;
    std::vector<std::size_t> starts(ranges.size() + 1, 0);
    for (std::size_t i = 0; i < ranges.size(); ++i) starts[i + 1] = starts[i] + ranges[i].size();
    if (starts.back() > std::numeric_limits<std::uint32_t>::max())
      throw Error({"mesh", "", "is too large for 32-bit places of stars", "split it into several meshes"});
    UninitializedVector<std::uint32_t>& stars = result_.data.stars;
    stars.resize(starts.back());
    for_each_range(split_count_, threads_, [&](std::size_t begin, std::size_t end) {
      const std::size_t start = starts[begin / range_size];
      std::vector<std::uint32_t>& words = ranges[begin / range_size];
      std::copy(words.begin(), words.end(), stars.begin() + static_cast<std::ptrdiff_t>(start));
      std::vector<std::uint32_t>().swap(words);
      for (std::size_t s = begin; s < end; ++s) result_.stars[s] += static_cast<std::uint32_t>(start);
    });
    result_.stars.back() = static_cast<std::uint32_t>(stars.size());
    for (const LevelFace& face : sequence_.base) result_.data.base_faces.push_back(renumbered(face.corners));
    if (!result_.data.extra_wedges.empty()) write_corners(sequence_, *numbers_, result_.stars, threads_, result_.data);
  }

  class StarWriter {
   public:
    explicit StarWriter(Assembler& assembler) : a_(assembler) {}

    void write(SplitId s, std::vector<std::uint32_t>& words) {
      prefetch_after(s);
      collapse_ = &a_.collapse_of(s);
      face_count_ += collapse_->ended_count();
      if (write_fan(words)) return;
      inserted_.clear();
      for (std::uint32_t slot = 0; slot < collapse_->ended_count(); ++slot)
        inserted_.push_back(a_.renumbered(collapse_->ended(slot)));
      gather_removed(s);
      find_dependencies(s);
      append_star({a_.new_id_[collapse_->u], collapse_->shape(), inserted_, removed_, dependencies_}, words);
    }
    [[nodiscard]] std::size_t face_count() const noexcept { return face_count_; }

   private:
    // Writes the common case: a closed fan all of whose removed faces have implied places.
    bool write_fan(std::vector<std::uint32_t>& words) {
      if (collapse_->shape() != StarShape::closed_fan) return false;
      const std::span<const VertexId> around = collapse_->ring();
      const std::size_t size = around.size();
      if (size < 3 || size > SplitStar::max_ring) return false;
      std::array<VertexId, SplitStar::max_ring> ring;
      std::array<FaceRef, SplitStar::max_ring> removed;
      std::size_t parent_place = size, removed_count = 0;
      for (std::size_t k = 0; k < size; ++k) {
        ring[k] = a_.new_id_[around[k]];
        if (around[k] == collapse_->u) parent_place = k;
      }
      if (parent_place == size) return false;
      for (std::uint32_t slot = 0; slot < size; ++slot) {
        if (slot == parent_place || (slot + 1 == size ? 0 : slot + 1) == parent_place) continue;
        const Collapse::EndedFace face = collapse_->successor(slot);
        if (face.ended_by == no_id) return false;
        removed[removed_count++] = {a_.split_of(face.ended_by), face.slot};
      }
      return append_fan({{ring.data(), size}, parent_place, {removed.data(), removed_count}}, words);
    }

    // Prefetches ahead because collapses lie in memory in the order in which they were recorded, not in split order.
    void prefetch_after(SplitId s) const {
      constexpr SplitId ahead = 5;
      if (s + 2 * ahead < a_.split_count_) {
        const auto* const later = reinterpret_cast<const std::byte*>(&a_.collapse_of(s + 2 * ahead));
        prefetch(later);
        prefetch(later + 64);
      }
      if (s + ahead >= a_.split_count_) return;
      const Collapse& next = a_.collapse_of(s + ahead);
      if (!next.is_fan()) return;
      for (const VertexId w : next.ring()) {
        prefetch(&a_.new_id_[w]);
        prefetch(&a_.mesh_.positions[w]);
      }
      for (std::uint32_t slot = 0; slot < next.ended_count(); ++slot)
        if (const CollapseId id = next.successor(slot).ended_by; id != no_id) prefetch(&a_.sequence_.places[id]);
    }

    void gather_removed(SplitId s) {
      removed_.clear();
      const VertexId u = a_.new_id_[collapse_->u];
      for (std::uint32_t slot = 0; collapse_->is_fan() && slot < inserted_.size(); ++slot) {
        const Collapse::EndedFace face = collapse_->successor(slot);
        if (face.ended_by == no_id) continue;
        removed_.push_back({{a_.split_of(face.ended_by), face.slot}, {u, inserted_[slot].y, inserted_[slot].z}});
      }
      const auto first =
          std::lower_bound(a_.misplaced_.begin(), a_.misplaced_.end(), s,
                           [](const RemovedElsewhere& face, SplitId split) { return face.split < split; });
      in_places_ = first == a_.misplaced_.end() || first->split != s;
      for (auto at = first; at != a_.misplaced_.end() && at->split == s; ++at) {
        const FaceRef& ref = at->face;
        const Triangle corners =
            ref.split == no_id ? a_.sequence_.base[ref.slot].corners : a_.collapse_of(ref.split).ended(ref.slot);
        removed_.push_back({ref, a_.renumbered(corners)});
      }
    }

    // A split depends on the splits that inserted the faces it removes. It also depends on the splits that bring any
    // other corner of its inserted faces, which matters only where no removed face has that corner: at ears of a
    // boundary and for components that vanish. The faces that a closed fan removes have its whole ring as corners.
    void find_dependencies(SplitId s) {
      dependencies_.clear();
      for (const RemovedFace& face : removed_)
        if (face.ref.split != no_id) dependencies_.push_back(face.ref.split);
      const bool covers_ring = collapse_->shape() == StarShape::closed_fan && inserted_.size() > 2 &&
                               removed_.size() == inserted_.size() - 2 && in_places_;
      if (!covers_ring) add_lone_corners(s);
      std::sort(dependencies_.begin(), dependencies_.end());
      dependencies_.erase(std::unique(dependencies_.begin(), dependencies_.end()), dependencies_.end());
    }

    void add_lone_corners(SplitId s) {
      corners_.clear();
      for (const RemovedFace& face : removed_)
        for (int k = 0; k < 3; ++k) corners_.push_back(face.corners[k]);
      std::sort(corners_.begin(), corners_.end());
      const VertexId base = a_.base_vertices_;
      for (const Triangle& t : inserted_)
        for (int k = 0; k < 3; ++k)
          if (t[k] >= base && t[k] != base + s && !std::binary_search(corners_.begin(), corners_.end(), t[k]))
            dependencies_.push_back(t[k] - base);
    }

    Assembler& a_;
    const Collapse* collapse_ = nullptr;
    std::size_t face_count_ = 0;
    std::vector<Triangle> inserted_;
    std::vector<RemovedFace> removed_;
    bool in_places_ = true;          // whether removed_ holds exactly the faces at the star's own places
    std::vector<VertexId> corners_;  // corners of removed faces
    std::vector<SplitId> dependencies_;
  };

  // Bounds the stars of a range of splits.
  class StarBounder {
   public:
    explicit StarBounder(Assembler& assembler) : a_(assembler) {}

    void add(SplitId s) {
      const Collapse& collapse = a_.collapse_of(s);
      const std::size_t corners = collapse.ended_count();
      if (collapse.shape() != StarShape::closed_fan || corners > FanPatches::max_corners) {
        others_.push_back(s);
        return;
      }
      Batch& batch = batches_[corners];
      batch.splits[batch.fans.size()] = s;
      batch.fans.add(collapse.v, collapse.ring(), collapse.u, a_.mesh_.positions);
      if (batch.fans.size() == FanPatches::capacity) bound(batch);
    }

    // Bounds the remaining stars. `words` holds the records of the range.
    void finish(const std::vector<std::uint32_t>& words) {
      for (Batch& batch : batches_)
        if (batch.fans.size() > 0) bound(batch);
      for (const SplitId s : others_)
        a_.result_.patches[s] =
            bound_star(SplitStar(words.data() + a_.result_.stars[s], a_.base_vertices_ + s), a_.result_.data.positions);
    }

   private:
    struct Batch {
      FanPatches fans;
      std::array<SplitId, FanPatches::capacity> splits;
    };

    void bound(Batch& batch) {
      const FanPatchBounds bounds = batch.fans.bounds();
      for (std::size_t i = 0; i < batch.fans.size(); ++i) {
        if (bounds.is_bounded[i] != 0.0F)
          a_.result_.patches[batch.splits[i]] = bounds[i];
        else
          others_.push_back(batch.splits[i]);
      }
      batch.fans.clear();
    }

    Assembler& a_;
    std::array<Batch, FanPatches::max_corners + 1> batches_;
    std::vector<SplitId> others_;
  };

  void link_forest() {
    result_.parents.resize(split_count_);
    result_.children_u.assign(split_count_, no_id);
    result_.children_v.assign(split_count_, no_id);
    // For each vertex, the newest split that has it at one of its ends.
    LargeVector<SplitId> last_at(mesh_.vertex_count(), no_id);
    for (SplitId s = 0; s < split_count_; ++s) {
      const VertexId u = new_id_[collapse_of(s).u];
      const SplitId parent = last_at[u];
      result_.parents[s] = parent;
      if (parent == no_id)
        result_.data.roots.push_back(s);
      else
        (base_vertices_ + parent == u ? result_.children_v : result_.children_u)[parent] = s;
      last_at[u] = s;
      last_at[base_vertices_ + s] = s;
    }
  }

  // Goes from fine to coarse, so that the errors of each split are final before they are propagated.
  void saturate_errors() {
    UninitializedVector<Assembly::Errors>& errors = result_.errors;
    errors.resize(split_count_);
    for_each_split([&](SplitId s) { errors[s] = {collapse_of(s).error, collapse_of(s).guaranteed_error}; });
    for (SplitId s = split_count_; s-- > 0;) {
      const Assembly::Errors own = errors[s];
      const auto raise = [&](SplitId coarse) {
        Assembly::Errors& e = errors[coarse];
        e = {std::max(e.quadric, own.quadric), std::max(e.guaranteed, own.guaranteed)};
      };
      if (const SplitId parent = result_.parents[s]; parent != no_id) raise(parent);
      const SplitStar star(result_.data.stars.data() + result_.stars[s], base_vertices_ + s);
      for (const SplitId needed : star.dependencies()) raise(needed);
    }
    if (sequence_.has_attributes) saturate_attribute_errors();
    for (const SplitId root : result_.data.roots)
      result_.data.error_bound = std::max(result_.data.error_bound, errors[root].guaranteed);
  }

  // Rounds attribute errors up to the upper half of a float's bits.
  void saturate_attribute_errors() {
    std::vector<float> errors(split_count_);
    for_each_split([&](SplitId s) { errors[s] = sequence_.attributes[reversed(s)].error; });
    for (SplitId s = split_count_; s-- > 0;) {
      const auto raise = [&](SplitId coarse) { errors[coarse] = std::max(errors[coarse], errors[s]); };
      if (const SplitId parent = result_.parents[s]; parent != no_id) raise(parent);
      const SplitStar star(result_.data.stars.data() + result_.stars[s], base_vertices_ + s);
      for (const SplitId needed : star.dependencies()) raise(needed);
    }
    result_.data.attribute_errors.resize(split_count_);
    for_each_split([&](SplitId s) {
      result_.data.attribute_errors[s] =
          static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(errors[s]) + 0xFFFFU) >> 16U);
    });
  }

  const TriangleMesh& mesh_;
  CollapseSequence sequence_;
  unsigned threads_;
  SplitId split_count_ = 0;
  VertexId base_vertices_ = 0;
  LargeVector<VertexId> new_id_;         // per input vertex
  std::optional<WedgeNumbers> numbers_;  // set only when attributes count
  std::vector<RemovedElsewhere> misplaced_;
  Assembly result_;
};

}  // namespace

Assembly assemble(const TriangleMesh& mesh, CollapseSequence sequence, unsigned threads) {
  return Assembler(mesh, std::move(sequence), threads).run();
}

}  // namespace occlod
