// Records half-edge collapses, cheapest first, from the input mesh down to the base mesh.
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

// Identifies a collapse while the mesh is simplified. CollapseSequence::place() converts it to an index in the final
// order.
using CollapseId = std::uint32_t;

// Describes one face of one level: its corners and the collapse that made it; no_id for faces of the input.
struct LevelFace {
  Triangle corners;
  CollapseId made_by = no_id;
};

// Describes the collapse of v into u. The faces that it ended follow in memory; see CollapseMemory.
class Collapse {
 public:
  // Names a face that a collapse ended by its index among them.
  struct EndedFace {
    CollapseId ended_by = no_id;
    std::uint32_t slot = 0;
  };

  VertexId v = no_id;
  VertexId u = no_id;
  float error = 0.0F;             // quadric error, object units
  float guaranteed_error = 0.0F;  // distance of its new faces from the input, object units
  float moved = 0.0F;             // bound on the distance between the faces it ended and those it made, object units

  // Returns how many faces ended: first the star of v, each face with v as its first corner, a fan in ring order; then
  // faces without v, onto which others were folded.
  [[nodiscard]] std::uint32_t ended_count() const noexcept { return ended_count_; }
  [[nodiscard]] StarShape shape() const noexcept { return shape_; }
  [[nodiscard]] bool is_fan() const noexcept { return shape_ != StarShape::other; }
  // Returns the outer vertices of a fan; face j is (v, ring[j], ring[j + 1]).
  [[nodiscard]] std::span<const VertexId> ring() const noexcept {
    return {words(), ended_count_ + (shape_ == StarShape::open_fan ? 1U : 0U)};
  }
  [[nodiscard]] Triangle ended(std::uint32_t slot) const noexcept {
    if (!is_fan()) return {words()[3 * slot], words()[3 * slot + 1], words()[3 * slot + 2]};
    const auto around = ring();
    return {v, around[slot], around[slot + 1 == around.size() ? 0 : slot + 1]};
  }
  // Returns, for a fan, how the face ended that the collapse made in place of this one; ended_by is no_id when there is
  // no such face, or when it is a MisplacedFace.
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
  // Layout of a fan: the ring, an id for each successor, a byte for the slot of each. Layout of any other star: three
  // corners of each face.
  [[nodiscard]] std::uint32_t* words() noexcept { return reinterpret_cast<std::uint32_t*>(this + 1); }
  [[nodiscard]] const std::uint32_t* words() const noexcept { return reinterpret_cast<const std::uint32_t*>(this + 1); }

  std::uint32_t ended_count_ = 0;
  StarShape shape_ = StarShape::other;
};

// Allocates collapses; their addresses do not change.
class CollapseMemory {
 public:
  // Adds a collapse that ended these faces, which are in ring order if they are a fan.
  [[nodiscard]] Collapse& add(std::span<const LevelFace> ended, StarShape shape);

 private:
  [[nodiscard]] std::uint32_t* allocate(std::size_t words);

  std::vector<UninitializedVector<std::uint32_t>> chunks_;
  std::size_t left_ = 0;  // unused words of the last chunk
};

// Describes a face that was not made in the place of one of those that its maker ended.
struct MisplacedFace {
  CollapseId made_by = no_id;
  CollapseId ended_by = no_id;
  std::uint32_t slot = 0;  // index there
};

// Holds the corners of a face that a collapse ended: the input wedges whose attributes they have. Their vertices may
// differ from the face's.
struct EndedCorners {
  std::uint32_t slot = 0;  // index of the face among those that ended
  Triangle wedges;
};

// Describes how a collapse changes attributes, where they count.
struct CollapseAttributes {
  float error = 0.0F;                     // see Hierarchy::attribute_error(), object units; not saturated
  std::span<const EndedCorners> corners;  // of faces with a wedge that is not its vertex's first; ascending
};

struct CollapseSequence {
  std::vector<Collapse*> collapses;        // in order
  UninitializedVector<CollapseId> places;  // per id
  std::vector<LevelFace> base;             // remaining faces
  std::vector<MisplacedFace> misplaced;
  std::vector<CollapseMemory> memory;
  // Where attributes count, the following hold the changes of each collapse, in order, and the wedges of the remaining
  // faces.
  bool has_attributes = false;
  std::vector<CollapseAttributes> attributes;
  std::vector<Triangle> base_corners;
  std::vector<std::vector<EndedCorners>> corner_memory;  // memory to which `attributes` points

  // Returns the index in `collapses` of the collapse with this id; no_id for no_id.
  [[nodiscard]] CollapseId place(CollapseId id) const noexcept { return id == no_id ? no_id : places[id]; }
};

// Describes what is left of a mesh.
struct ReducedFaces {
  std::vector<VertexId> target;   // per vertex of the mesh: the vertex into which it was merged
  std::vector<Triangle> faces;    // of vertices of the mesh
  std::vector<Triangle> corners;  // the wedges whose attributes they have; empty where attributes do not count
  // Per vertex of the mesh that is left: the minimum of its quadric, relative to it, in units of 1 / scale.
  std::vector<glm::vec3> minima;
  float scale = 1.0F;
  std::size_t least_possible = 0;  // where no face is left: how many there were before the last collapse
};

// Simplifies `mesh` like simplify() down to options.base_triangles, in less time, because it records less. Vertices
// that `locked` marks (one entry per vertex, or empty) stay, and more triangles with them.
[[nodiscard]] ReducedFaces reduce(const TriangleMesh& mesh, const BuildOptions& options,
                                  std::span<const std::uint8_t> locked);

// Simplifies `mesh`, which has passed build_hierarchy's checks. Fast when its vertices are in spatial order. The result
// does not depend on the number of threads.
[[nodiscard]] CollapseSequence simplify(const TriangleMesh& mesh, const BuildOptions& options);

}  // namespace occlod
