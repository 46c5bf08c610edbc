#include "splits/star_mesh.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/threads.h"
#include "occlod/base.h"

namespace occlod {
namespace {

// Searches in stars of any size, from three faces to a hundred thousand.

// Chains faces when there are too many for a linear search for each next one.
bool chain_by_sorting(std::span<StarFace> faces) {
  // In a ring each vertex is the next of exactly one face and the last of exactly one face.
  std::uint32_t difference = 0;
  for (const StarFace& f : faces) difference += f.next - f.last;
  if (difference != 0) return false;
  std::vector<StarFace> sorted(faces.begin(), faces.end());
  std::sort(sorted.begin(), sorted.end(), [](const StarFace& a, const StarFace& b) { return a.next < b.next; });
  const auto same_next = [](const StarFace& a, const StarFace& b) { return a.next == b.next; };
  if (std::adjacent_find(sorted.begin(), sorted.end(), same_next) != sorted.end()) return false;
  std::vector<StarFace> ring = {faces[0]};
  while (ring.size() < faces.size()) {
    const VertexId from = ring.back().last;
    const auto found = std::lower_bound(sorted.begin(), sorted.end(), from,
                                        [](const StarFace& f, VertexId next) { return f.next < next; });
    if (from == ring[0].next || found == sorted.end() || found->next != from) return false;
    ring.push_back(*found);
  }
  if (ring.back().last != ring[0].next) return false;
  std::copy(ring.begin(), ring.end(), faces.begin());
  return true;
}

// Puts faces into ring order, starting with the first. Returns false, and leaves them in any order, when they are not
// one closed fan.
[[nodiscard]] bool chain(std::span<StarFace> faces) {
  constexpr std::size_t max_by_search = 64;
  const std::size_t n = faces.size();
  if (n < 3) return false;
  if (n > max_by_search) return chain_by_sorting(faces);
  for (std::size_t i = 1; i < n; ++i) {
    const VertexId from = faces[i - 1].last;
    // The chain closed too early: there is another fan, or the ring passes a neighbour twice.
    for (std::size_t k = 0; k < i; ++k)
      if (faces[k].next == from) return false;
    std::size_t k = i;
    while (k < n && faces[k].next != from) ++k;
    if (k == n) return false;
    std::swap(faces[i], faces[k]);
  }
  return faces[n - 1].last == faces[0].next;
}

// Returns the index of v in a ring, or the ring's size. Avoids a branch per vertex.
[[nodiscard]] std::uint32_t position_of(std::span<const VertexId> ring, VertexId v) {
  constexpr std::size_t step = 32;
  std::size_t at = 0;
  for (; at + step <= ring.size(); at += step) {
    std::uint32_t found = 0;
    for (std::size_t k = 0; k < step; ++k) found |= ring[at + k] == v ? 1U : 0U;
    if (found != 0) break;
  }
  while (at < ring.size() && ring[at] != v) ++at;
  return static_cast<std::uint32_t>(at);
}

// Returns the index of a vertex that is in the ring, searching from `hint`.
[[nodiscard]] std::uint32_t position_near(std::span<const VertexId> ring, VertexId v, std::size_t hint) {
  for (std::size_t reach = 64;; reach *= 8) {
    const std::size_t begin = hint > reach ? std::min(hint - reach, ring.size()) : 0;
    const std::size_t end = std::min(hint + reach, ring.size());
    const std::uint32_t at = position_of(ring.subspan(begin, end - begin), v);
    if (begin + at < end || (begin == 0 && end == ring.size())) return static_cast<std::uint32_t>(begin + at);
  }
}

constexpr std::uint32_t first_capacity = 8;  // with as many CollapseIds this fills one cache line

// Calls visit with `capacity` as a constant, if it is one of the two usual ones, whose loops compilers can unroll and
// vectorize. Returns whether it is.
template <typename Visit>
bool with_usual_capacity(std::uint32_t capacity, const Visit& visit) {
  if (capacity == first_capacity) return visit(std::integral_constant<std::uint32_t, first_capacity>()), true;
  if (capacity == 2 * first_capacity) return visit(std::integral_constant<std::uint32_t, 2 * first_capacity>()), true;
  return false;
}

// Moves the items behind index `at` one place to the front. Avoids branches.
template <std::uint32_t capacity>
void remove_item(std::uint32_t* items, std::uint32_t at) {
  for (std::uint32_t k = 0; k + 1 < capacity; ++k) items[k] = k >= at ? items[k + 1] : items[k];
}

// Calls visit(v, next, last) for each corner of each face, where next and last are the other corners in winding order.
// Each thread goes through all faces and handles the vertices of its part.
template <typename Visit>
void for_each_corner(std::span<const Triangle> faces, std::size_t vertices, unsigned threads, const Visit& visit) {
  for_each_part(vertices, threads, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (const Triangle& t : faces)
      for (int i = 0; i < 3; ++i)
        if (t[i] >= begin && t[i] < end) visit(t[i], t[(i + 1) % 3], t[(i + 2) % 3]);
  });
}

// Returns whether no earlier face of the star has the same corners as the i-th.
bool is_first(const Star& star, std::size_t i) {
  if (star.is_ring()) return true;
  const StarFace f = star[i];
  for (std::size_t k = 0; k < i; ++k)
    if (contains(star[k], f.next) && contains(star[k], f.last)) return false;
  return true;
}

}  // namespace

std::uint32_t* StarArena::allocate(std::size_t count) {
  if (count > left_) {
    left_ = std::max(count, chunk_size);
    chunks_.push_back(std::make_unique_for_overwrite<std::uint32_t[]>(left_));
  }
  left_ -= count;
  return chunks_.back().get() + left_;
}

StarMesh::StarMesh(std::span<const Triangle> faces, std::size_t vertex_count, unsigned threads)
    : places_(vertex_count) {
  for_each_corner(faces, vertex_count, threads, [&](VertexId v, VertexId, VertexId) { ++places_[v].size; });
  std::size_t slots = 0;
  for (Place& place : places_) {
    place.capacity = std::max(first_capacity, place.size) & 0x7fffffffU;
    slots += 2 * std::size_t{place.capacity};
  }
  const std::size_t bytes = slots * sizeof(std::uint32_t);
  pool_ = {static_cast<std::uint32_t*>(allocate_large(bytes)), Delete{bytes}};
  std::uint32_t* next_place = pool_.get();
  for (Place& place : places_) {
    place.ids = next_place;
    place.size = 0;
    next_place += 2 * std::size_t{place.capacity};
  }
  // First store the two other corners of each face, using the whole place: capacity is at least size.
  for_each_corner(faces, vertex_count, threads, [&](VertexId v, VertexId next, VertexId last) {
    std::uint32_t* const ids = places_[v].ids + 2 * std::size_t{places_[v].size++};
    ids[0] = next;
    ids[1] = last;
  });
  std::mutex arena_mutex;
  for_each_range(vertex_count, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<StarFace> star;
    for (std::size_t v = begin; v < end; ++v) {
      Place& place = places_[v];
      star.clear();
      for (std::size_t i = 0; i < place.size; ++i) star.push_back({place.ids[2 * i], place.ids[2 * i + 1], no_id});
      const bool is_ring = chain(star);
      std::unique_lock lock(arena_mutex, std::defer_lock);
      if (!is_ring && 2 * star.size() > place.capacity) lock.lock();  // does not fit
      store(place, star, is_ring, arena_);
    }
  });
}

int StarMesh::edge_degree(VertexId a, VertexId b) const noexcept {
  if (places_[a].size > places_[b].size) std::swap(a, b);
  const Star of_a = star(a);
  int degree = 0;
  for (std::size_t i = 0; i < of_a.size(); ++i) degree += contains(of_a[i], b) && is_first(of_a, i) ? 1 : 0;
  return degree;
}

void StarMesh::distinct_faces(VertexId v, std::vector<StarFace>& out) const {
  constexpr std::size_t most_compared = 32;  // faces compared each with each; more are sorted
  out.clear();
  const Star star = this->star(v);
  if (star.is_ring() || star.size() <= most_compared) {
    for (std::size_t i = 0; i < star.size(); ++i)
      if (is_first(star, i)) out.push_back(star[i]);
    return;
  }
  std::vector<std::array<std::uint32_t, 3>> sorted;  // the other two corners, ascending, and the place in the star
  for (std::size_t i = 0; i < star.size(); ++i)
    sorted.push_back(
        {std::min(star[i].next, star[i].last), std::max(star[i].next, star[i].last), static_cast<std::uint32_t>(i)});
  std::ranges::sort(sorted);
  const auto same_corners = [](const auto& a, const auto& b) { return a[0] == b[0] && a[1] == b[1]; };
  sorted.erase(std::unique(sorted.begin(), sorted.end(), same_corners), sorted.end());
  std::ranges::sort(sorted, {}, [](const auto& face) { return face[2]; });
  for (const auto& face : sorted) out.push_back(star[face[2]]);
}

void StarMesh::neighbours(VertexId v, std::vector<VertexId>& out) const {
  out.clear();
  for (const StarFace f : star(v)) {
    out.push_back(f.next);
    out.push_back(f.last);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

std::vector<LevelFace> StarMesh::faces() const {
  std::vector<LevelFace> result;
  for (VertexId v = 0; v < places_.size(); ++v)
    for (const StarFace f : star(v))
      if (v < f.next && v < f.last) result.push_back({{v, f.next, f.last}, f.made_by});
  return result;
}

void StarMesh::reserve(Place& place, std::size_t slots, StarArena& arena) {
  if (slots <= place.capacity) return;
  const auto capacity = static_cast<std::uint32_t>(std::max<std::size_t>(slots, 2 * std::size_t{place.capacity}));
  std::uint32_t* const ids = arena.allocate(2 * static_cast<std::size_t>(capacity));
  const std::size_t used = place.is_ring != 0 ? place.size : 2 * static_cast<std::size_t>(place.size);
  std::copy_n(place.ids, used, ids);
  std::copy_n(place.ids + place.capacity, used, ids + capacity);
  place.ids = ids;
  place.capacity = capacity & 0x7fffffffU;
}

void StarMesh::store(Place& place, std::span<const StarFace> faces, bool is_ring, StarArena& arena) {
  place.is_ring = is_ring ? 1 : 0;
  place.size = 0;
  const std::size_t stride = place.is_ring != 0 ? 1 : 2;
  reserve(place, stride * faces.size(), arena);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    place.ids[stride * i] = faces[i].next;
    if (!is_ring) place.ids[2 * i + 1] = faces[i].last;
    place.ids[place.capacity + stride * i] = faces[i].made_by;
  }
  place.size = static_cast<std::uint32_t>(faces.size());
}

void StarMesh::make_list(Place& place, StarArena& arena) {
  if (place.is_ring == 0) return;
  reserve(place, 2 * static_cast<std::size_t>(place.size), arena);
  std::uint32_t* const made_by = place.ids + place.capacity;
  VertexId last = place.ids[0];
  for (std::size_t i = place.size; i-- > 0;) {
    const VertexId next = place.ids[i];
    place.ids[2 * i] = next;
    place.ids[2 * i + 1] = last;
    made_by[2 * i] = made_by[i];
    last = next;
  }
  place.is_ring = 0;
}

// Removes a face from a list that contains it.
void StarMesh::remove(Place& place, const StarFace& face) noexcept {
  const Star star = view(place);
  std::size_t i = 0;
  while (i < star.size() && star[i] != face) ++i;
  assert(i < star.size() && place.is_ring == 0);
  std::uint32_t* const made_by = place.ids + place.capacity;
  std::copy(place.ids + 2 * i + 2, place.ids + 2 * star.size(), place.ids + 2 * i);
  std::copy(made_by + 2 * i + 2, made_by + 2 * star.size(), made_by + 2 * i);
  --place.size;
}

// Replaces v by u in a list; faces that contain both end.
void StarMesh::replace_in_list(Place& place, VertexId v, VertexId u, CollapseId id) noexcept {
  std::uint32_t* const ids = place.ids;
  std::uint32_t* const made_by = ids + place.capacity;
  const std::size_t size = place.size;
  std::size_t kept = 0;
  for (std::size_t from = 0;; ++from) {
    const std::size_t found = from + position_of({ids + 2 * from, 2 * (size - from)}, v) / 2;
    if (kept != from) {
      std::copy(ids + 2 * from, ids + 2 * found, ids + 2 * kept);
      std::copy(made_by + 2 * from, made_by + 2 * found, made_by + 2 * kept);
    }
    kept += found - from;
    if (found == size) break;
    from = found;
    const VertexId next = ids[2 * found], last = ids[2 * found + 1];
    if (next == u || last == u) continue;
    ids[2 * kept] = next == v ? u : next;
    ids[2 * kept + 1] = last == v ? u : last;
    made_by[2 * kept++] = id;
  }
  place.size = static_cast<std::uint32_t>(kept);
}

// Returns the index of v in the ring of w, which contains it. Avoids a branch where v is in its usual first place.
std::uint32_t StarMesh::find_in_ring(VertexId w, VertexId v, StarArena& arena) const noexcept {
  const Place& place = places_[w];
  std::uint32_t at = 0;
  const bool is_found = with_usual_capacity(place.capacity, [&](auto capacity) {
    for (std::uint32_t k = 0; k < capacity; ++k) at |= ((place.ids[k] == v) & (k < place.size)) ? k : 0U;
  });
  if (is_found) return at;
  std::uint32_t& hint = arena.hints[w % arena.hints.size()];
  return hint = position_near({place.ids, place.size}, v, hint);
}

// Replaces the neighbour at index `at` of a ring by u.
void StarMesh::replace_in_ring(Place& place, std::uint32_t at, VertexId u, CollapseId id) noexcept {
  std::uint32_t* const made_by = place.ids + place.capacity;
  place.ids[at] = u;
  made_by[at] = id;
  made_by[at == 0 ? place.size - 1 : at - 1] = id;
}

// Removes the neighbour at index `at` from a ring that has it beside the vertex into which it is merged.
void StarMesh::remove_from_ring(Place& place, std::uint32_t at, CollapseId id) noexcept {
  std::uint32_t* const ids = place.ids;
  std::uint32_t* const made_by = ids + place.capacity;
  --place.size;
  const bool is_removed = with_usual_capacity(place.capacity, [&](auto capacity) {
    remove_item<capacity>(ids, at);
    remove_item<capacity>(made_by, at);
  });
  if (!is_removed) {
    std::copy(ids + at + 1, ids + place.size + 1, ids + at);
    std::copy(made_by + at + 1, made_by + place.size + 1, made_by + at);
  }
  made_by[at == 0 ? place.size - 1 : at - 1] = id;  // last, as vectors around a number just stored would wait for it
}

// Replaces v by u in the star of a neighbour w of both. In a ring, v and u must be adjacent.
void StarMesh::replace(VertexId w, VertexId v, VertexId u, CollapseId id, StarArena& arena) noexcept {
  Place& place = places_[w];
  if (place.is_ring == 0) return replace_in_list(place, v, u, id);
  const auto ring = view(place).ring();
  const std::uint32_t at = find_in_ring(w, v, arena);
  const bool is_beside = ring[at == 0 ? ring.size() - 1 : at - 1] == u || ring[at + 1 == ring.size() ? 0 : at + 1] == u;
  is_beside ? remove_from_ring(place, at, id) : replace_in_ring(place, at, u, id);
}

// Inserts the ring of v into that of u = ring[i] in place of v, except for ring[i] and the neighbours beside it, which
// are already there.
void StarMesh::splice(VertexId u, std::span<const VertexId> ring, std::size_t i, VertexId v, CollapseId id,
                      StarArena& arena) {
  Place& place = places_[u];
  const std::size_t n = place.size;
  const std::size_t added = ring.size() - 3;
  reserve(place, n + added, arena);
  std::uint32_t* const ids = place.ids;
  std::uint32_t* const made_by = ids + place.capacity;
  const std::size_t at = find_in_ring(u, v, arena);
  made_by[at == 0 ? n - 1 : at - 1] = id;
  if (added == 0) {
    std::copy(ids + at + 1, ids + n, ids + at);
    std::copy(made_by + at + 1, made_by + n, made_by + at);
  } else {
    std::copy_backward(ids + at + 1, ids + n, ids + n + added - 1);
    std::copy_backward(made_by + at + 1, made_by + n, made_by + n + added - 1);
    std::size_t from = i + 2;
    for (std::size_t k = 0; k < added; ++k, ++from) {
      if (from >= ring.size()) from -= ring.size();
      ids[at + k] = ring[from];
      made_by[at + k] = id;
    }
  }
  place.size = static_cast<std::uint32_t>(n + added - 1);
}

// Appends the faces of v to u, stored as a list.
void StarMesh::take_over(VertexId v, VertexId u, CollapseId id, StarArena& arena) {
  Place& place = places_[u];
  arena.scratch.clear();
  for (const StarFace f : star(u))
    if (!contains(f, v)) arena.scratch.push_back(f);
  for (const StarFace f : star(v))
    if (!contains(f, u)) arena.scratch.push_back({f.next, f.last, id});
  make_list(place, arena);
  reserve(place, 2 * arena.scratch.size(), arena);
  place.size = 0;
  for (const StarFace& f : arena.scratch) {
    place.ids[2 * place.size] = f.next;
    place.ids[2 * place.size + 1] = f.last;
    place.ids[place.capacity + 2 * place.size++] = f.made_by;
  }
}

// Ends pairs of faces in lists: a face of v that moved to u and coincides with an older face of opposite winding that
// may_end accepts.
template <typename MayEnd>
std::size_t StarMesh::cancel_folds(VertexId v, VertexId u, CollapseId id, const MayEnd& may_end,
                                   std::vector<LevelFace>& ended) {
  std::size_t gone = 0;
  for (const StarFace moved : star(v)) {
    if (contains(moved, u)) continue;
    const StarFace f{moved.next, moved.last, id};
    const Star of_u = star(u);
    const auto is_twin = [&](const StarFace& g) {
      return g.made_by != id && g.next == f.last && g.last == f.next && may_end(g);
    };
    std::size_t i = 0;
    while (i < of_u.size() && !is_twin(of_u[i])) ++i;
    if (i == of_u.size()) continue;
    const StarFace twin = of_u[i];
    ended.push_back({{u, twin.next, twin.last}, twin.made_by});
    for (const StarFace& face : {f, twin}) {
      remove(places_[u], face);
      remove(places_[face.next], {face.last, u, face.made_by});
      remove(places_[face.last], {u, face.next, face.made_by});
    }
    gone += 2;
  }
  return gone;
}

// Converts lists that now form one closed fan to rings.
void StarMesh::settle(VertexId v, StarArena& arena) {
  const auto settle_one = [&](Place& place) {
    if (place.is_ring != 0) return;
    arena.scratch.clear();
    for (const StarFace f : view(place)) arena.scratch.push_back(f);
    store(place, arena.scratch, chain(arena.scratch), arena);
  };
  neighbours(v, arena.ring);  // u is one of them
  for (const VertexId w : arena.ring) settle_one(places_[w]);
}

std::size_t StarMesh::collapse(VertexId v, VertexId u, CollapseId id, bool may_fold, StarArena& arena,
                               std::vector<LevelFace>& ended) {
  if (may_fold)
    return collapse_list(
        v, u, id, [](const StarFace&) { return true; }, arena, ended);
  const Star of_v = star(v);
  if (of_v.is_ring()) return collapse_ring(v, u, id, arena, ended);
  std::size_t gone = 0;
  for (const StarFace f : of_v) {
    ended.push_back({{v, f.next, f.last}, f.made_by});
    gone += contains(f, u) ? 1U : 0U;
  }
  neighbours(v, arena.ring);
  for (const VertexId w : arena.ring)
    if (w != u) replace(w, v, u, id, arena);
  take_over(v, u, id, arena);
  places_[v].size = 0;
  return gone;
}

std::size_t StarMesh::collapse_again(VertexId v, VertexId u, CollapseId id, std::span<const Triangle> folded,
                                     StarArena& arena, std::vector<LevelFace>& ended) {
  const auto may_end = [&](const StarFace& f) {
    return std::find(folded.begin(), folded.end(), Triangle(u, f.next, f.last)) != folded.end();
  };
  return collapse_list(v, u, id, may_end, arena, ended);
}

template <typename MayEnd>
std::size_t StarMesh::collapse_list(VertexId v, VertexId u, CollapseId id, const MayEnd& may_end, StarArena& arena,
                                    std::vector<LevelFace>& ended) {
  std::size_t gone = 0;
  for (const StarFace f : star(v)) {
    ended.push_back({{v, f.next, f.last}, f.made_by});
    gone += contains(f, u) ? 1U : 0U;
  }
  make_list(places_[u], arena);
  neighbours(v, arena.ring);
  for (const VertexId w : arena.ring) {
    if (w == u) continue;
    make_list(places_[w], arena);
    replace(w, v, u, id, arena);
  }
  take_over(v, u, id, arena);
  gone += cancel_folds(v, u, id, may_end, ended);
  settle(v, arena);
  places_[v].size = 0;
  return gone;
}

std::size_t StarMesh::collapse_ring(VertexId v, VertexId u, CollapseId id, StarArena& arena,
                                    std::vector<LevelFace>& ended) {
  const std::span<const VertexId> ring = star(v).ring();
  const CollapseId* const made_by = places_[v].ids + places_[v].capacity;
  std::size_t i = 0;
  for (std::size_t k = 0; k + 1 < ring.size(); ++k) {
    ended.push_back({{v, ring[k], ring[k + 1]}, made_by[k]});
    if (ring[k + 1] == u) i = k + 1;
  }
  ended.push_back({{v, ring.back(), ring[0]}, made_by[ring.size() - 1]});
  const auto at = [&](std::size_t k) { return ring[k < ring.size() ? k : k - ring.size()]; };
  for (const VertexId w : {at(i + 1), at(i + ring.size() - 1)}) {
    Place& place = places_[w];
    place.is_ring != 0 ? remove_from_ring(place, find_in_ring(w, v, arena), id) : replace_in_list(place, v, u, id);
  }
  for (std::size_t k = i + 2; k + 1 < i + ring.size(); ++k) {
    Place& place = places_[at(k)];
    place.is_ring != 0 ? replace_in_ring(place, find_in_ring(at(k), v, arena), u, id)
                       : replace_in_list(place, v, u, id);
  }
  if (places_[u].is_ring != 0)
    splice(u, ring, i, v, id, arena);
  else
    take_over(v, u, id, arena);
  places_[v].size = 0;
  return 2;
}

}  // namespace occlod
