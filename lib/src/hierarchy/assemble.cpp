#include "assemble.h"

#include <algorithm>
#include <limits>
#include <mutex>
#include <span>
#include <tuple>

#include "core/platform.h"
#include "occlod/core/error.h"
#include "parallel.h"
#include "star_mesh.h"
#include "star_record.h"

namespace occlod {
namespace {

// No vertex of the ring twice: then no two faces have the same outer edge.
bool is_simple(std::span<const LevelFace> fan) {
  const VertexId last = fan.back().corners.z;
  for (std::size_t i = 0; i < fan.size(); ++i) {
    const VertexId w = fan[i].corners.y;
    if (i > 0 && w == last) return false;
    for (std::size_t k = 0; k < i; ++k)
      if (fan[k].corners.y == w) return false;
  }
  return true;
}

bool is_closed_fan(std::span<const LevelFace> faces) {
  VertexId from = faces.back().corners.z;
  for (const LevelFace& face : faces) {
    if (face.corners.y != from) return false;
    from = face.corners.z;
  }
  return true;
}

// Brings faces at v that are one open fan into ring order.
bool order_open_fan(std::span<LevelFace> faces) {
  // It starts at the face that none leads to.
  const auto follows_another = [&](const LevelFace& f) {
    return std::any_of(faces.begin(), faces.end(), [&](const LevelFace& g) { return g.corners.z == f.corners.y; });
  };
  const auto start = std::find_if_not(faces.begin(), faces.end(), follows_another);
  if (start == faces.end()) return false;
  std::swap(faces[0], *start);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    std::size_t k = i;
    while (k < faces.size() && faces[k].corners.y != faces[i - 1].corners.z) ++k;
    if (k == faces.size()) return false;
    std::swap(faces[i], faces[k]);
  }
  return true;
}

// The shape of the faces that one collapse of v ended, brought into ring order if they are one fan.
StarShape shape_of(VertexId v, std::span<LevelFace> faces) {
  if (faces.empty() || faces.size() > SplitStar::most_ring) return StarShape::other;
  for (const LevelFace& face : faces)
    if (face.corners.x != v) return StarShape::other;
  const bool closed = is_closed_fan(faces);
  if (!closed && !order_open_fan(faces)) return StarShape::other;
  if (!is_simple(faces)) return StarShape::other;
  return closed ? StarShape::closed_fan : StarShape::open_fan;
}

// A split removes the faces that its collapse made. Those of a fan lie where the star's own faces will be: the one in
// place of slot j has the outer edge of slot j. Others are kept in a list.
struct MisplacedFace {
  SplitId split = no_id;  // that removes it
  FaceRef face;
  friend bool operator<(const MisplacedFace& a, const MisplacedFace& b) {
    return std::tuple(a.split, a.face.split, a.face.slot) < std::tuple(b.split, b.face.split, b.face.slot);
  }
};

class Assembler {
 public:
  Assembler(const TriangleMesh& mesh, CollapseSequence sequence, unsigned threads)
      : mesh_(mesh),
        sequence_(std::move(sequence)),
        threads_(threads),
        split_count_(static_cast<SplitId>(sequence_.collapses.size() - 1)) {}

  Assembly run() {
    number_vertices();
    copy_vertices();
    order_stars();
    find_removed();
    write_stars();
    link_forest();
    saturate_errors();
    return std::move(result_);
  }

 private:
  // Split s undoes the s-th last collapse; ids of collapses are their places. Either from the other.
  [[nodiscard]] std::uint32_t reversed(std::uint32_t id) const { return split_count_ - 1 - id; }
  [[nodiscard]] const Collapse& collapse_of(SplitId s) const { return sequence_.collapses[reversed(s)]; }
  [[nodiscard]] std::span<LevelFace> star_of(SplitId s) {
    const std::size_t begin = collapse_of(s).first_ended;
    return {sequence_.ended.data() + begin, sequence_.collapses[reversed(s) + 1].first_ended - begin};
  }
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
      to.resize(from.size());
      for_each_id(from.size(), threads_, [&](VertexId v) { to[new_id_[v]] = from[v]; });
    };
    permute(mesh_.positions, result_.data.positions);
    permute(mesh_.normals, result_.data.normals);
    permute(mesh_.colors, result_.data.colors);
    result_.data.box = bounding_box(result_.data.positions);
    result_.data.input_triangle_count = mesh_.triangle_count();
    result_.data.face_count = sequence_.base.size() + sequence_.ended.size();
  }

  // The faces that the collapse of split s ended are those that it inserts; their places are their slots.
  void order_stars() {
    shapes_.resize(split_count_);
    for_each_split([&](SplitId s) { shapes_[s] = shape_of(collapse_of(s).v, star_of(s)); });
  }

  // A face dies with the split that undoes the collapse which made it.
  void find_removed() {
    removed_.resize(sequence_.ended.size());
    for (std::uint32_t slot = 0; slot < sequence_.base.size(); ++slot)
      if (const LevelFace& face = sequence_.base[slot]; face.made_by != no_id)
        misplaced_.push_back({reversed(face.made_by), {no_id, slot}});
    std::mutex mutex;
    for_each_range(split_count_, threads_, [&](std::size_t begin, std::size_t end) {
      const std::vector<MisplacedFace> misplaced =
          place_removed_of(static_cast<SplitId>(begin), static_cast<SplitId>(end));
      const std::lock_guard lock(mutex);
      misplaced_.insert(misplaced_.end(), misplaced.begin(), misplaced.end());
    });
    std::sort(misplaced_.begin(), misplaced_.end());
  }

  // Of faces inserted by splits [begin, end). Removers are anywhere in memory, so what is known of them is fetched
  // ahead.
  std::vector<MisplacedFace> place_removed_of(SplitId begin, SplitId end) {
    constexpr std::size_t ahead = 12;
    std::vector<MisplacedFace> faces, misplaced;
    for (SplitId s = begin; s < end; ++s) {
      const std::span<const LevelFace> star = star_of(s);
      for (std::uint32_t slot = 0; slot < star.size(); ++slot)
        if (star[slot].made_by != no_id) faces.push_back({reversed(star[slot].made_by), {s, slot}});
    }
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (i + 2 * ahead < faces.size()) prefetch(&collapse_of(faces[i + 2 * ahead].split));
      if (i + ahead < faces.size()) prefetch(star_of(faces[i + ahead].split).data());
      const auto& [remover, face] = faces[i];
      if (!place_removed(remover, star_of(face.split)[face.slot].corners, face)) misplaced.push_back(faces[i]);
    }
    return misplaced;
  }

  // Each face of a manifold fan has its own place, so threads do not meet; elsewhere two faces may ask for one place,
  // and those stars are lists.
  bool place_removed(SplitId s, const Triangle& corners, const FaceRef& face) {
    if (shapes_[s] == StarShape::other) return false;
    const VertexId u = collapse_of(s).u;
    if (!contains(corners, u)) return false;
    const Triangle at_u = rotated(corners, u);
    const std::span<const LevelFace> star = star_of(s);
    for (std::size_t slot = 0; slot < star.size(); ++slot)
      if (star[slot].corners.y == at_u.y && star[slot].corners.z == at_u.z) {
        removed_[collapse_of(s).first_ended + slot] = face;
        return true;
      }
    return false;
  }

  // Ranges of splits write their records on their own; then these are joined.
  void write_stars() {
    result_.stars.resize(split_count_ + 1);
    std::vector<std::vector<std::uint32_t>> ranges((split_count_ + range_size - 1) / range_size);
    for_each_range(split_count_, threads_, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t>& words = ranges[begin / range_size];
      words.reserve((end - begin) * 12);
      StarWriter writer(*this);
      for (std::size_t s = begin; s < end; ++s) {
        result_.stars[s] = static_cast<std::uint32_t>(words.size());
        writer.write(static_cast<SplitId>(s), words);
      }
    });
    std::vector<std::size_t> starts(ranges.size() + 1, 0);
    for (std::size_t i = 0; i < ranges.size(); ++i) starts[i + 1] = starts[i] + ranges[i].size();
    if (starts.back() > std::numeric_limits<std::uint32_t>::max())
      throw Error({"mesh", "", "is too large for 32-bit places of stars", "split it into several meshes"});
    LargeVector<std::uint32_t>& stars = result_.data.stars;
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
  }

  class StarWriter {
   public:
    explicit StarWriter(Assembler& assembler) : a_(assembler) {}

    void write(SplitId s, std::vector<std::uint32_t>& words) {
      star_ = a_.star_of(s);
      inserted_.clear();
      for (const LevelFace& face : star_) inserted_.push_back(a_.renumbered(face.corners));
      gather_removed(s);
      find_dependencies(s);
      append_star({a_.new_id_[a_.collapse_of(s).u], a_.shapes_[s], inserted_, removed_, dependencies_}, words);
    }

   private:
    void gather_removed(SplitId s) {
      removed_.clear();
      const VertexId u = a_.new_id_[a_.collapse_of(s).u];
      const std::span<const FaceRef> places(a_.removed_.data() + a_.collapse_of(s).first_ended, star_.size());
      for (std::size_t slot = 0; slot < places.size(); ++slot)
        if (places[slot].split != no_id) removed_.push_back({places[slot], {u, inserted_[slot].y, inserted_[slot].z}});
      const auto first = std::lower_bound(a_.misplaced_.begin(), a_.misplaced_.end(), s,
                                          [](const MisplacedFace& face, SplitId split) { return face.split < split; });
      in_places_ = first == a_.misplaced_.end() || first->split != s;
      for (auto at = first; at != a_.misplaced_.end() && at->split == s; ++at) {
        const FaceRef& ref = at->face;
        const LevelFace& face = ref.split == no_id ? a_.sequence_.base[ref.slot] : a_.star_of(ref.split)[ref.slot];
        removed_.push_back({ref, a_.renumbered(face.corners)});
      }
    }

    // A split needs the faces that it removes, so the splits that inserted them; and every other corner of the faces
    // that it inserts, which matters only where no removed face brings it along: at ears of a boundary and for
    // components that vanish. The faces that a closed fan removes have all of its ring as corners.
    void find_dependencies(SplitId s) {
      dependencies_.clear();
      for (const RemovedFace& face : removed_)
        if (face.ref.split != no_id) dependencies_.push_back(face.ref.split);
      const bool covers_ring = a_.shapes_[s] == StarShape::closed_fan && inserted_.size() > 2 &&
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
    std::span<const LevelFace> star_;
    std::vector<Triangle> inserted_;
    std::vector<RemovedFace> removed_;
    bool in_places_ = true;          // of the star's own faces, all of removed_
    std::vector<VertexId> corners_;  // of removed faces
    std::vector<SplitId> dependencies_;
  };

  void link_forest() {
    result_.parents.resize(split_count_);
    result_.children_u.assign(split_count_, no_id);
    result_.children_v.assign(split_count_, no_id);
    // The newest split that has the vertex at one of its ends.
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

  // From fine to coarse, so that each split has its final errors before they are handed on.
  void saturate_errors() {
    LargeVector<Assembly::Errors>& errors = result_.errors;
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
    for (const SplitId root : result_.data.roots)
      result_.data.error_bound = std::max(result_.data.error_bound, errors[root].guaranteed);
  }

  const TriangleMesh& mesh_;
  CollapseSequence sequence_;
  unsigned threads_;
  SplitId split_count_ = 0;
  VertexId base_vertices_ = 0;
  LargeVector<VertexId> new_id_;  // of each input vertex
  LargeVector<StarShape> shapes_;
  LargeVector<FaceRef> removed_;  // for each ended face the face that its split removes in its place, or none
  std::vector<MisplacedFace> misplaced_;
  Assembly result_;
};

}  // namespace

Assembly assemble(const TriangleMesh& mesh, CollapseSequence sequence, unsigned threads) {
  return Assembler(mesh, std::move(sequence), threads).run();
}

}  // namespace occlod
