#include "splits/collapse_records.h"

#include "occlod/hierarchy/split_star.h"
#include "splits/star_mesh.h"

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

// A split removes the faces that its collapse made. Those of a fan lie where the star's own faces will be: the one in
// place of slot j has the outer edge of slot j. Returns j, or the number of slots when there is no such place.
std::uint32_t find_slot(const Collapse& maker, const Triangle& corners) {
  const std::uint32_t slots = maker.ended_count();
  if (!maker.is_fan() || !contains(corners, maker.u)) return slots;
  // The other two in winding order; chosen, like the slot, without branches that nobody could predict.
  const VertexId next = corners.x == maker.u ? corners.y : corners.y == maker.u ? corners.z : corners.x;
  const VertexId last = corners.x == maker.u ? corners.z : corners.y == maker.u ? corners.x : corners.y;
  const std::span<const VertexId> ring = maker.ring();
  std::uint32_t slot = slots;
  for (std::uint32_t k = 0; k < slots; ++k) slot = ring[k] == next ? k : slot;
  return slot < slots && ring[slot + 1 == ring.size() ? 0 : slot + 1] == last ? slot : slots;
}

}  // namespace

StarShape shape_of(VertexId v, std::span<LevelFace> faces) {
  if (faces.empty() || faces.size() > SplitStar::most_ring) return StarShape::other;
  for (const LevelFace& face : faces)
    if (face.corners.x != v) return StarShape::other;
  const bool closed = is_closed_fan(faces);
  if (!closed && !order_open_fan(faces)) return StarShape::other;
  if (!is_simple(faces)) return StarShape::other;
  return closed ? StarShape::closed_fan : StarShape::open_fan;
}

std::uint32_t* CollapseMemory::allocate(std::size_t words) {
  constexpr std::size_t first_chunk = std::size_t{1} << 18U, most = std::size_t{1} << 22U;  // words
  if (words > left_) {
    left_ = std::max(words, std::min(first_chunk << chunks_.size(), most));
    chunks_.emplace_back();
    chunks_.back().reserve(left_);
  }
  std::uint32_t* const result = chunks_.back().data() + (chunks_.back().capacity() - left_);
  left_ -= words;
  return result;
}

Collapse& CollapseMemory::add(std::span<const LevelFace> ended, StarShape shape) {
  static_assert(sizeof(Collapse) % sizeof(std::uint32_t) == 0 && alignof(Collapse) == alignof(std::uint32_t));
  constexpr std::size_t head = sizeof(Collapse) / sizeof(std::uint32_t);
  const std::size_t n = ended.size(), ring_size = shape == StarShape::open_fan ? n + 1 : n;
  const std::size_t words = shape == StarShape::other ? 3 * n : ring_size + n + (n + 3) / 4;
  Collapse& collapse = *new (allocate(head + words)) Collapse;
  collapse.ended_count_ = static_cast<std::uint32_t>(n);
  collapse.shape_ = shape;
  std::uint32_t* next = collapse.words();
  if (shape == StarShape::other) {
    for (const LevelFace& face : ended)
      for (int k = 0; k < 3; ++k) *next++ = face.corners[k];
    return collapse;
  }
  for (const LevelFace& face : ended) *next++ = face.corners.y;
  if (shape == StarShape::open_fan) *next++ = ended.back().corners.z;
  for (std::size_t i = 0; i < n; ++i) *next++ = no_id;
  for (std::size_t i = 0; i < n; i += 4) *next++ = 0;
  return collapse;
}

// Each face of a manifold fan has its own place, so threads do not meet; elsewhere two faces may ask for one place, and
// those stars are lists.
void CollapseRecords::add(std::size_t block, Collapse& collapse, std::span<const LevelFace> ended) {
  BlockRecord& record = records_[block];
  const auto id = static_cast<CollapseId>(first_id(block) + record.collapses.size());
  record.collapses.push_back(&collapse);
  for (std::uint32_t slot = 0; slot < ended.size(); ++slot) {
    const LevelFace& face = ended[slot];
    if (face.made_by == no_id) continue;
    Collapse& maker = *this->collapse(face.made_by);
    const std::uint32_t place = slot < 256 ? find_slot(maker, face.corners) : maker.ended_count();
    if (place < maker.ended_count())
      maker.set_successor(place, {id, slot});
    else
      record.misplaced.push_back({face.made_by, id, slot});
  }
}

}  // namespace occlod
