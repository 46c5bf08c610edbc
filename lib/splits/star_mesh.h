// The mesh while it is being simplified: around every vertex the edges opposite to it, any topology.
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

// The same face with v as its first corner; v is a corner.
[[nodiscard]] constexpr Triangle rotated(const Triangle& t, VertexId v) noexcept {
  if (t.x == v) return t;
  return t.y == v ? Triangle(t.y, t.z, t.x) : Triangle(t.z, t.x, t.y);
}

// A face as one of its vertices sees it: its other corners, in winding order, and the collapse that made it.
struct StarFace {
  VertexId next;
  VertexId last;
  CollapseId made_by;
  friend bool operator==(const StarFace&, const StarFace&) = default;
};
[[nodiscard]] constexpr bool contains(const StarFace& f, VertexId w) noexcept { return f.next == w || f.last == w; }

// The faces at one vertex. A star that is one closed fan of at least three faces, all wound alike, is kept as a ring:
// its neighbours in order, face i being that between neighbour i and the next; any other as a list of faces. Views stay
// valid until the star changes.
class Star {
 public:
  Star(const VertexId* ids, const CollapseId* made_by, std::size_t size, bool is_ring) noexcept
      : ids_(ids), made_by_(made_by), size_(size), is_ring_(is_ring) {}

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] bool is_ring() const noexcept { return is_ring_; }
  [[nodiscard]] std::span<const VertexId> ring() const noexcept { return {ids_, size_}; }  // of a ring only
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

// Memory for stars that outgrow their first place. Given back all at once, so it outlives the mesh; one for each thread
// that collapses.
class StarArena {
 public:
  [[nodiscard]] std::uint32_t* allocate(std::size_t count);
  std::vector<StarFace> scratch;  // for whoever works on a star
  std::vector<VertexId> ring;     // or on its neighbours
  // Where in the long ring of a vertex with this remainder something was last found: the next is most likely near.
  std::array<std::uint32_t, 64> hints{};

 private:
  static constexpr std::size_t chunk_size = 1U << 16;
  std::vector<std::unique_ptr<std::uint32_t[]>> chunks_;
  std::size_t left_ = 0;
};

// Collapses whose stars, rings included, are disjoint may run in parallel, each with an arena of its own.
class StarMesh {
 public:
  StarMesh(std::span<const Triangle> faces, std::size_t vertex_count, unsigned threads = 1);

  [[nodiscard]] std::size_t vertex_count() const noexcept { return places_.size(); }
  [[nodiscard]] Star star(VertexId v) const noexcept { return view(places_[v]); }
  // A hint that the star of v will soon be asked for.
  void prefetch(VertexId v) const noexcept { occlod::prefetch(places_[v].ids); }
  // Earlier still: that v will soon be given to prefetch().
  void prefetch_place(VertexId v) const noexcept { occlod::prefetch(&places_[v]); }
  // The number of faces at edge ab.
  [[nodiscard]] int edge_degree(VertexId a, VertexId b) const noexcept;
  // The vertices that share a face with v, each once, ascending. `out` is cleared first.
  void neighbours(VertexId v, std::vector<VertexId>& out) const;
  // All faces, by their smallest corners.
  [[nodiscard]] std::vector<LevelFace> faces() const;

  // Merges v into u: faces with both end, the others at v get u in its place and are made by `id`. `may_fold`: a moved
  // face may meet an old one turned over; then both end, so that the oriented boundary (as a chain) stays that of the
  // merged input. Without it, the collapse keeps the topology (see collapse_rules.h). Appends every face that ends or
  // moves to `ended`: those at v in the order of its star, with v first; then those that others were folded onto.
  // Returns how many faces there are fewer.
  std::size_t collapse(VertexId v, VertexId u, CollapseId id, bool may_fold, StarArena& arena,
                       std::vector<LevelFace>& ended);
  // The same where it may fold, but of the older faces only these end, which have u as their first corner. A collapse
  // that is repeated in another order may meet faces that were not there, or not yet turned over, the first time.
  std::size_t collapse_again(VertexId v, VertexId u, CollapseId id, std::span<const Triangle> folded, StarArena& arena,
                             std::vector<LevelFace>& ended);

 private:
  // Where a star is: `capacity` ids, then as many CollapseIds. Rings use one of each for a face, lists two.
  struct Place {
    std::uint32_t* ids = nullptr;
    std::uint32_t size = 0;  // faces
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
  std::unique_ptr<std::uint32_t, Delete> pool_;  // the first places of all stars
  StarArena arena_;                              // for those that are longer from the start
};

}  // namespace occlod
