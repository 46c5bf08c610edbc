// Simplifies one group of triangles from nothing but what is given of it, so that any process can do it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "hlod/build/finish_level.h"
#include "hlod/build/level_draft.h"
#include "occlod/bounds.h"
#include "occlod/mesh.h"
#include "splits/simplify_group.h"

namespace occlod::hlod {

// Holds the triangles of a group and all that its simplification depends on.
struct GroupInput {
  TriangleMesh mesh;                 // numbered anew; positions, and attributes if they count
  std::vector<VertexId> vertices;    // per vertex of `mesh`, its id in the input of the HLOD
  std::vector<WedgeId> wedges;       // per wedge of `mesh`, likewise
  std::vector<std::uint8_t> locked;  // per vertex of `mesh`, 1 if it must stay
  std::vector<std::uint8_t> shared;  // likewise, with free borders: 1 if other groups have it too; else empty
  std::vector<Box> boxes;            // per vertex of `mesh`, around all that it stands for
};

// Holds what is the same for all groups of a level.
struct GroupRules {
  float max_cost = std::numeric_limits<float>::max();  // as in GroupTarget
  float scale = 1.0F;                                  // likewise
  float least_share = 0.25F;               // simplification ends when this share of the group's triangles is left
  WedgeId first_added = 0;                 // id of the first wedge that a group adds
  float lattice_step = 0.0F;               // as in GroupTarget
  std::uint8_t names_wedges = 0;           // whether results name wedges of corners
  std::uint8_t keeps_splits = 0;           // as Within::splits
  std::uint8_t measures = 0;               // as ErrorBound::measured
  std::uint8_t keeps_bounds = 1;           // as Reduction::keeps_bounds
  std::uint8_t refits = 0;                 // as Reduction::refits; needs names_wedges
  std::array<std::uint8_t, 3> reserved{};  // always 0
};
static_assert(sizeof(GroupRules) == 28);  // no padding, whose bytes nobody has set

// Simplifies one group after another and reuses its memory.
class GroupSimplifier {
 public:
  // Returns the node that replaces the group. Wedges that it adds are numbered from rules.first_added on. O(n log n).
  [[nodiscard]] SimplifiedNode run(const GroupInput& group, const GroupRules& rules);

  // Returns the cost of the most expensive collapse, for GroupRules::max_cost, when no cost is too high.
  [[nodiscard]] static float cost_of(const GroupInput& group, const GroupRules& rules);

 private:
  void add_wedges(SimplifiedNode& result, WedgeId first_added);
  void list_merges(SimplifiedNode& result);
  void list_lost(SimplifiedNode& result);
  void list_vanished(SimplifiedNode& result);
  void note_left();
  [[nodiscard]] bool is_left(const std::array<std::uint32_t, 3>& corners) const;
  [[nodiscard]] VertexId vertex_of(WedgeId wedge) const;
  [[nodiscard]] Triangle image_of(const Triangle& t) const;
  [[nodiscard]] bool can_replay() const;
  void keep_splits(SplitsDraft& within) const;

  const GroupInput* group_ = nullptr;
  SimplifiedGroup simplified_;
  std::vector<WedgeId> wedges_;  // GroupInput::wedges, then those added where charts were stretched
  std::vector<WedgeId> images_;  // per wedge in wedges_: the one where its vertex is now; itself if it has not moved
  std::vector<std::uint8_t> used_;
  std::vector<std::array<std::uint32_t, 3>> left_;                   // the remaining triangles, in order
  std::vector<std::pair<std::uint32_t, std::uint32_t>> left_edges_;  // of them, in order
  std::vector<GrownBox> grown_;                                      // by local vertex
};

}  // namespace occlod::hlod
