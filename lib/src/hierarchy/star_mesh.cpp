#include "star_mesh.h"

#include <algorithm>
#include <cassert>

namespace occlod {
namespace {

// True iff the triangles have the same corners in opposite winding order.
bool reversed(const Triangle& a, const Triangle& b) {
  if (!contains(b, a.x)) return false;
  const OppositeEdge e = opposite_edge(b, a.x);
  return e.next == a.z && e.last == a.y;
}

}  // namespace

StarMesh::StarMesh(std::span<const Triangle> faces, std::size_t vertex_count)
    : faces_(faces.begin(), faces.end()), stars_(vertex_count), live_(faces.size()) {
  for (const Triangle& t : faces_)
    for (int i = 0; i < 3; ++i) ++stars_[t[i]].capacity;
  std::size_t first = 0;
  for (Star& star : stars_) {
    star.first = first;
    first += star.capacity;
  }
  pool_.resize(first);
  for (FaceId f = 0; f < faces_.size(); ++f)
    for (int i = 0; i < 3; ++i) {
      Star& star = stars_[faces_[f][i]];
      pool_[star.first + star.count++] = f;
    }
}

int StarMesh::edge_degree(VertexId a, VertexId b) const noexcept {
  if (stars_[a].count > stars_[b].count) std::swap(a, b);
  const auto at_a = star(a);
  return static_cast<int>(std::count_if(at_a.begin(), at_a.end(), [&](FaceId f) { return contains(faces_[f], b); }));
}

void StarMesh::neighbours(VertexId v, std::vector<VertexId>& out) const {
  out.clear();
  for (const FaceId f : star(v)) {
    const OppositeEdge e = opposite_edge(faces_[f], v);
    out.push_back(e.next);
    out.push_back(e.last);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

void StarMesh::collapse(VertexId v, VertexId u, std::vector<FaceId>& ended) {
  assert(v != u);
  const auto first_new = static_cast<FaceId>(faces_.size());
  // add_to_star(u) may move the pool, so the star of v is read by index.
  for (std::uint32_t i = 0; i < stars_[v].count; ++i) {
    const FaceId f = pool_[stars_[v].first + i];
    const OppositeEdge e = opposite_edge(faces_[f], v);
    ended.push_back(f);
    --live_;
    if (e.next == u || e.last == u) {
      remove_from_star(e.next, f);
      remove_from_star(e.last, f);
      continue;
    }
    const Triangle moved(u, e.next, e.last);
    const FaceId twin = find_reverse(moved, u, first_new);
    if (twin != no_id) {
      for (const VertexId w : {e.next, e.last}) {
        remove_from_star(w, f);
        remove_from_star(w, twin);
      }
      remove_from_star(u, twin);
      ended.push_back(twin);
      --live_;
      continue;
    }
    const auto made = static_cast<FaceId>(faces_.size());
    faces_.push_back(moved);
    replace_in_star(e.next, f, made);
    replace_in_star(e.last, f, made);
    add_to_star(u, made);
    ++live_;
  }
  stars_[v].count = 0;
}

std::vector<FaceId> StarMesh::live_faces() const {
  std::vector<FaceId> faces;
  faces.reserve(live_);
  for (VertexId v = 0; v < stars_.size(); ++v)
    for (const FaceId f : star(v))
      if (faces_[f].x == v) faces.push_back(f);
  std::sort(faces.begin(), faces.end());
  return faces;
}

void StarMesh::add_to_star(VertexId v, FaceId f) {
  Star& star = stars_[v];
  if (star.count == star.capacity) {
    // Move to the end of the pool with twice the room; the old place is given up, which at most triples the pool.
    const std::uint32_t capacity = std::max(8U, 2 * star.capacity);
    const std::size_t first = pool_.size();
    pool_.resize(first + capacity);
    std::copy_n(pool_.begin() + static_cast<std::ptrdiff_t>(star.first), star.count,
                pool_.begin() + static_cast<std::ptrdiff_t>(first));
    star.first = first;
    star.capacity = capacity;
  }
  pool_[star.first + star.count++] = f;
}

void StarMesh::remove_from_star(VertexId v, FaceId f) {
  Star& star = stars_[v];
  FaceId* const begin = pool_.data() + star.first;
  FaceId* const end = begin + star.count;
  FaceId* const found = std::find(begin, end, f);
  assert(found != end);
  *found = *(end - 1);
  --star.count;
}

void StarMesh::replace_in_star(VertexId v, FaceId old_face, FaceId new_face) {
  Star& star = stars_[v];
  FaceId* const begin = pool_.data() + star.first;
  FaceId* const found = std::find(begin, begin + star.count, old_face);
  assert(found != begin + star.count);
  *found = new_face;
}

FaceId StarMesh::find_reverse(const Triangle& t, VertexId at, FaceId end) const noexcept {
  for (const FaceId f : star(at))
    if (f < end && reversed(t, faces_[f])) return f;
  return no_id;
}

}  // namespace occlod
