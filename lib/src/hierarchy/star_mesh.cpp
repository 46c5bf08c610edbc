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

FaceId* StarArena::allocate(std::size_t count) {
  if (count > left_) {
    left_ = std::max(count, chunk_size);
    chunks_.push_back(std::make_unique_for_overwrite<FaceId[]>(left_));
  }
  left_ -= count;
  return chunks_.back().get() + left_;
}

StarMesh::StarMesh(std::span<const Triangle> faces, std::size_t vertex_count)
    : faces_(faces.begin(), faces.end()), stars_(vertex_count), pool_(3 * faces.size()) {
  for (const Triangle& t : faces_)
    for (int i = 0; i < 3; ++i) ++stars_[t[i]].capacity;
  FaceId* place = pool_.data();
  for (Star& star : stars_) {
    star.faces = place;
    place += star.capacity;
  }
  for (FaceId f = 0; f < faces_.size(); ++f)
    for (int i = 0; i < 3; ++i) {
      Star& star = stars_[faces_[f][i]];
      star.faces[star.count++] = f;
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

std::vector<FaceId> StarMesh::live_faces() const {
  std::vector<FaceId> live;
  for (VertexId v = 0; v < stars_.size(); ++v)
    for (const FaceId f : star(v))
      if (faces_[f].x == v) live.push_back(f);
  std::sort(live.begin(), live.end());
  return live;
}

void StarMesh::add_to_star(VertexId v, FaceId f, StarArena& arena) {
  Star& star = stars_[v];
  if (star.count == star.capacity) {
    star.capacity = std::max(8U, 2 * star.capacity);
    FaceId* const place = arena.allocate(star.capacity);
    std::copy_n(star.faces, star.count, place);
    star.faces = place;
  }
  star.faces[star.count++] = f;
}

// Keeps the order of the others: what was there before a collapse stays in front of what the collapse adds.
void StarMesh::remove_from_star(VertexId v, FaceId f) noexcept {
  Star& star = stars_[v];
  FaceId* const end = star.faces + star.count;
  FaceId* const found = std::find(star.faces, end, f);
  assert(found != end);
  std::copy(found + 1, end, found);
  --star.count;
}

FaceId StarMesh::find_reverse(const Triangle& t, VertexId u, std::uint32_t count) const noexcept {
  const auto old_faces = star(u).first(count);
  const auto found = std::find_if(old_faces.begin(), old_faces.end(), [&](FaceId f) { return reversed(t, faces_[f]); });
  return found == old_faces.end() ? no_id : *found;
}

}  // namespace occlod
