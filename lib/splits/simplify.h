// Half-edge collapses from the input mesh down to the base mesh, cheapest first, recorded.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/mesh.h"
#include "splits/star_record.h"

namespace occlod {

// Names a collapse while the mesh is simplified. Where collapses are in order, CollapseSequence::place() of it is its
// place.
using CollapseId = std::uint32_t;

// One face of one level: its corners, and the collapse that made it; no_id for faces of the input.
struct LevelFace {
  Triangle corners;
  CollapseId made_by = no_id;
};

// v was merged into u. The faces that this ended follow in memory; see CollapseMemory.
class Collapse {
 public:
  // A face that a collapse ended: its place among them.
  struct EndedFace {
    CollapseId ended_by = no_id;
    std::uint32_t slot = 0;
  };

  VertexId v = no_id;
  VertexId u = no_id;
  float error = 0.0F;             // quadric error, object units
  float guaranteed_error = 0.0F;  // distance of the faces made from the input, object units
  float moved = 0.0F;  // bound on the distance between what the collapse ended and what it made, object units

  // Faces that ended: first the star of v, each face with v as its first corner; a fan in ring order. Then faces
  // without v, which others were folded onto.
  [[nodiscard]] std::uint32_t ended_count() const noexcept { return ended_count_; }
  [[nodiscard]] StarShape shape() const noexcept { return shape_; }
  [[nodiscard]] bool is_fan() const noexcept { return shape_ != StarShape::other; }
  // Of a fan: its outer vertices; face j is (v, ring[j], ring[j + 1]).
  [[nodiscard]] std::span<const VertexId> ring() const noexcept {
    return {words(), ended_count_ + (shape_ == StarShape::open_fan ? 1U : 0U)};
  }
  [[nodiscard]] Triangle ended(std::uint32_t slot) const noexcept {
    if (!is_fan()) return {words()[3 * slot], words()[3 * slot + 1], words()[3 * slot + 2]};
    const auto around = ring();
    return {v, around[slot], around[slot + 1 == around.size() ? 0 : slot + 1]};
  }
  // Of a fan: the face that the collapse made in place of that one, by what became of it; ended_by is no_id when there
  // is none, or it is a MisplacedFace.
  [[nodiscard]] EndedFace successor(std::uint32_t slot) const noexcept {
    const std::uint32_t* const ids = words() + ring().size();
    return {ids[slot], reinterpret_cast<const std::uint8_t*>(ids + ended_count_)[slot]};
  }
  void set_successor(std::uint32_t slot, EndedFace face) noexcept {
    std::uint32_t* const ids = words() + ring().size();
    ids[slot] = face.ended_by;
    reinterpret_cast<std::uint8_t*>(ids + ended_count_)[slot] = static_cast<std::uint8_t>(face.slot);
  }

 private:
  friend class CollapseMemory;
  // Fan: ring, an id for each successor, a byte for the slot of each. Other: three corners of each face.
  [[nodiscard]] std::uint32_t* words() noexcept { return reinterpret_cast<std::uint32_t*>(this + 1); }
  [[nodiscard]] const std::uint32_t* words() const noexcept { return reinterpret_cast<const std::uint32_t*>(this + 1); }

  std::uint32_t ended_count_ = 0;
  StarShape shape_ = StarShape::other;
};

// Memory for collapses; they stay where they are.
class CollapseMemory {
 public:
  // A new one that ended these faces, which are in ring order if they are a fan.
  [[nodiscard]] Collapse& add(std::span<const LevelFace> ended, StarShape shape);

 private:
  [[nodiscard]] std::uint32_t* allocate(std::size_t words);

  std::vector<UninitializedVector<std::uint32_t>> chunks_;
  std::size_t left_ = 0;  // words of the last chunk
};

// A face that was not made in the place of one of those that its maker ended.
struct MisplacedFace {
  CollapseId made_by = no_id;
  CollapseId ended_by = no_id;
  std::uint32_t slot = 0;  // there
};

// The corners of a face that a collapse ended: wedges of the input, whose attributes they have. Their vertices may be
// others.
struct EndedCorners {
  std::uint32_t slot = 0;  // of the face among those that ended
  Triangle wedges;
};

// What a collapse does to attributes, where they count.
struct CollapseAttributes {
  float error = 0.0F;                     // see Hierarchy::attribute_error(), object units; not saturated
  std::span<const EndedCorners> corners;  // of faces with a wedge that is not its vertex's first; ascending
};

struct CollapseSequence {
  std::vector<Collapse*> collapses;        // in order
  UninitializedVector<CollapseId> places;  // of each id
  std::vector<LevelFace> base;             // faces that are left
  std::vector<MisplacedFace> misplaced;
  std::vector<CollapseMemory> memory;
  // Where attributes count: what each collapse does, in order, and the wedges of the faces that are left.
  bool has_attributes = false;
  std::vector<CollapseAttributes> attributes;
  std::vector<Triangle> base_corners;
  std::vector<std::vector<EndedCorners>> corner_memory;  // that `attributes` points into

  // Where in `collapses` the one with this id is; no_id for no_id.
  [[nodiscard]] CollapseId place(CollapseId id) const noexcept { return id == no_id ? no_id : places[id]; }
};

// `mesh` has passed build_hierarchy's checks. Quick when its vertices are in spatial order. The result does not depend
// on the number of threads.
[[nodiscard]] CollapseSequence simplify(const TriangleMesh& mesh, const BuildOptions& options);

}  // namespace occlod
