// Stores the mesh during simplification: for every vertex, the edges opposite to it. Any topology is allowed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/memory.h"
#include "base/platform.h"
#include "occlod/mesh.h"
#include "splits/simplify.h"

namespace occlod {

[[nodiscard]] constexpr bool contains(const Triangle& t, VertexId v) noexcept {
  return t.x == v || t.y == v || t.z == v;
}

// Returns the same face with v, one of its corners, as its first corner.
[[nodiscard]] constexpr Triangle rotated(const Triangle& t, VertexId v) noexcept {
  if (t.x == v) return t;
  return t.y == v ? Triangle(t.y, t.z, t.x) : Triangle(t.z, t.x, t.y);
}

// Describes a face as seen from one of its vertices: its other corners, in winding order, and the collapse that made
// it.
struct StarFace {
  VertexId next;
  VertexId last;
  CollapseId made_by;
  friend bool operator==(const StarFace&, const StarFace&) = default;
};
[[nodiscard]] constexpr bool contains(const StarFace& f, VertexId w) noexcept { return f.next == w || f.last == w; }

// Views the faces at one vertex. A star that is one closed fan of at least three faces, all wound alike, is stored as a
// ring: its neighbours in order, where face i lies between neighbour i and the next. Any other star is stored as a list
// of faces. Views stay valid until the star changes.
class Star {
 public:
  Star(const VertexId* ids, const CollapseId* made_by, std::size_t size, bool is_ring) noexcept
      : ids_(ids), made_by_(made_by), size_(size), is_ring_(is_ring) {}

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] bool is_ring() const noexcept { return is_ring_; }
  [[nodiscard]] std::span<const VertexId> ring() const noexcept { return {ids_, size_}; }  // only for a ring
  [[nodiscard]] StarFace operator[](std::size_t i) const noexcept {
    if (is_ring_) return {ids_[i], ids_[i + 1 == size_ ? 0 : i + 1], made_by_[i]};
    return {ids_[2 * i], ids_[2 * i + 1], made_by_[2 * i]};
  }

  class Iterator {
   public:
    Iterator(const Star& star, std::size_t i) noexcept : star_(&star), i_(i) {}
    StarFace operator*() const noexcept { return (*star_)[i_]; }
    Iterator& operator++() noexcept { return ++i_, *this; }
    bool operator!=(const Iterator& o) const noexcept { return i_ != o.i_; }

   private:
    const Star* star_;
    std::size_t i_;
  };
  [[nodiscard]] Iterator begin() const noexcept { return {*this, 0}; }
  [[nodiscard]] Iterator end() const noexcept { return {*this, size_}; }

 private:
  const VertexId* ids_;
  const CollapseId* made_by_;
  std::size_t size_;
  bool is_ring_;
};

// Provides memory for stars that outgrow their first place. It is freed all at once, so the arena must outlive the
// mesh; each thread that collapses needs its own.
class StarArena {
 public:
  [[nodiscard]] std::uint32_t* allocate(std::size_t count);
  std::vector<StarFace> scratch;  // for operations on a star
  std::vector<VertexId> ring;     // for operations on its neighbours
  // Where something was last found in the long ring of a vertex with this remainder; the next search will probably end
  // nearby.
  std::array<std::uint32_t, 64> hints{};

 private:
  static constexpr std::size_t chunk_size = 1U << 16;
  std::vector<std::unique_ptr<std::uint32_t[]>> chunks_;
  std::size_t left_ = 0;
};

// Stores all stars. Collapses whose stars, rings included, are disjoint may run in parallel, each with its own arena.
class StarMesh {
 public:
  StarMesh(std::span<const Triangle> faces, std::size_t vertex_count, unsigned threads = 1);

  [[nodiscard]] std::size_t vertex_count() const noexcept { return places_.size(); }
  [[nodiscard]] Star star(VertexId v) const noexcept { return view(places_[v]); }
  // Prefetches the star of v.
  void prefetch(VertexId v) const noexcept { occlod::prefetch(places_[v].ids); }
  // Prefetches the data that prefetch(v) will read.
  void prefetch_place(VertexId v) const noexcept { occlod::prefetch(&places_[v]); }
  // Returns the number of different faces at edge ab: faces with the same corners count once, however they are wound.
  [[nodiscard]] int edge_degree(VertexId a, VertexId b) const noexcept;
  // Lists the different faces at v in the order of its star: of faces with the same corners, however they are wound,
  // only the first. `out` is cleared first.
  void distinct_faces(VertexId v, std::vector<StarFace>& out) const;
  // Lists the vertices that share a face with v, each once, ascending. `out` is cleared first.
  void neighbours(VertexId v, std::vector<VertexId>& out) const;
  // Returns all faces, sorted by their smallest corners.
  [[nodiscard]] std::vector<LevelFace> faces() const;

  // Merges v into u: faces that contain both end; in the others at v, u replaces v, and their maker becomes `id`. With
  // `may_fold`, a moved face may coincide with an older one of opposite winding; then both end, so that the oriented
  // boundary (as a chain) stays that of the merged input. Without it, the collapse must keep the topology (see
  // collapse_rules.h). Appends every face that ends or moves to `ended`: those at v in the order of its star, with v
  // first; then those onto which others were folded. Returns by how much the number of faces decreases.
  std::size_t collapse(VertexId v, VertexId u, CollapseId id, bool may_fold, StarArena& arena,
                       std::vector<LevelFace>& ended);
  // Repeats a collapse that may fold, but ends only those older faces that are in `folded`, which have u as their first
  // corner. A collapse repeated in another order may meet faces that did not exist, or had not yet flipped, the first
  // time.
  std::size_t collapse_again(VertexId v, VertexId u, CollapseId id, std::span<const Triangle> folded, StarArena& arena,
                             std::vector<LevelFace>& ended);

 private:
  // Locates a star: `capacity` ids, then as many CollapseIds. Rings use one of each per face, lists two.
  struct Place {
    std::uint32_t* ids = nullptr;
    std::uint32_t size = 0;  // number of faces
    std::uint32_t capacity : 31 = 0;
    std::uint32_t is_ring : 1 = 0;
  };

  [[nodiscard]] static Star view(const Place& p) noexcept {
    return {p.ids, p.ids + p.capacity, p.size, p.is_ring != 0};
  }
  static void reserve(Place& place, std::size_t slots, StarArena& arena);
  static void store(Place& place, std::span<const StarFace> faces, bool is_ring, StarArena& arena);
  static void make_list(Place& place, StarArena& arena);
  static void remove(Place& place, const StarFace& face) noexcept;
  static void replace_in_list(Place& place, VertexId v, VertexId u, CollapseId id) noexcept;
  [[nodiscard]] std::uint32_t find_in_ring(VertexId w, VertexId v, StarArena& arena) const noexcept;
  static void replace_in_ring(Place& place, std::uint32_t at, VertexId u, CollapseId id) noexcept;
  static void remove_from_ring(Place& place, std::uint32_t at, CollapseId id) noexcept;
  void replace(VertexId w, VertexId v, VertexId u, CollapseId id, StarArena& arena) noexcept;
  void splice(VertexId u, std::span<const VertexId> ring, std::size_t i, VertexId v, CollapseId id, StarArena& arena);
  std::size_t collapse_ring(VertexId v, VertexId u, CollapseId id, StarArena& arena, std::vector<LevelFace>& ended);
  void take_over(VertexId v, VertexId u, CollapseId id, StarArena& arena);
  void settle(VertexId v, StarArena& arena);
  template <typename MayEnd>
  std::size_t collapse_list(VertexId v, VertexId u, CollapseId id, const MayEnd& may_end, StarArena& arena,
                            std::vector<LevelFace>& ended);
  template <typename MayEnd>
  std::size_t cancel_folds(VertexId v, VertexId u, CollapseId id, const MayEnd& may_end, std::vector<LevelFace>& ended);

  struct Delete {
    std::size_t bytes;
    void operator()(std::uint32_t* pool) const noexcept { free_large(pool, bytes); }
  };

  LargeVector<Place> places_;
  std::unique_ptr<std::uint32_t, Delete> pool_;  // the initial places of all stars
  StarArena arena_;                              // for stars that are longer from the start
};

}  // namespace occlod
