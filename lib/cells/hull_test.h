// What boxes inside solids hide from all of a cell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/memory.h"
#include "cells/cell_surface.h"
#include "cells/hull.h"
#include "cells/inner_boxes.h"

namespace occlod {

// See InnerBoxes. One thread each.
class InnerBoxTest {
 public:
  // Both outlive it.
  InnerBoxTest(const CellSurface& surface, const InnerBoxes& boxes);

  // near_reach: world units from an eye within which its near plane may clip.
  void set_cell(const CellBox& cell, double near_reach);

  // Whether one of the boxes that hid something before does. Forgets all when the cell is set.
  [[nodiscard]] bool hides_again(const CellBox& what);
  // Whether a box of the part does.
  [[nodiscard]] bool hides(const CellBox& what, std::uint32_t part);

 private:
  enum class State : std::uint8_t { unknown, seen, hidden };

  void find_parts_at_cell();
  [[nodiscard]] bool hides_by(const CellBox& what, std::uint32_t box);
  [[nodiscard]] bool is_between(const CellBox& what, const CellBox& box) const;
  // Whether the box itself is hidden from the cell by its part.
  [[nodiscard]] bool is_hidden(std::uint32_t box);
  [[nodiscard]] State find_state(std::uint32_t box) const;
  void remember(std::uint32_t box);

  static constexpr std::size_t max_remembered = 32;

  const CellSurface& surface_;
  const InnerBoxes& boxes_;
  CellBox cell_;
  double near_reach_ = 0.0;
  std::vector<State> states_;              // of boxes
  std::vector<bool> at_cell_;              // parts that come too close to the cell to hide anything
  std::vector<std::uint32_t> remembered_;  // the last boxes that hid, the latest first
};

// What hides a box from all of a cell.

// Let S be a finite set of triangles and dS the edges that an odd number of them share. If one segment from the cell to
// the box meets S an odd number of times, no triangle of S meets the cell or the box, and dS does not meet the hull of
// both, then every segment from the cell to the box meets S: as its ends move, the number of times modulo 2 changes
// only where an end crosses S or the segment crosses dS. So one connected surface, thin, concave or open, hides the
// box; there are no silhouettes, no shrunk occluders and no pixels.
//
// Where S stands for a set S' of the input that is carried to S by motions of at most m (see motion_cut.h), the same
// holds for S' if S keeps its distance m from cell and box, and dS from the hull. And what the near plane of an eye may
// clip away hides nothing, so S keeps the distance of that from the cell as well.
//
// S is found by a flood from a triangle over all edges that meet the hull. What hides is crossed by every segment, so
// floods begin at the triangles on one of them; first at those that hid another box from the same cell. What cannot be
// decided counts as not hidden. Reuses its memory, four bytes a triangle; one thread each.
class HullTest {
 public:
  // Of all calls.
  struct Counts {
    std::size_t queries = 0;
    std::size_t boxed = 0;       // of these, hidden by a box inside a solid
    std::size_t remembered = 0;  // of these, hidden by a surface through a triangle that hid another box
    std::size_t free = 0;        // of these, not hidden because nothing on some segment from cell to box could hide it
    std::size_t floods = 0;
    std::size_t triangles = 0;  // that floods reached
  };
  static constexpr std::size_t max_triangles = 4096;  // of all floods of a query

  // Both outlive it. Without boxes all is found by floods.
  explicit HullTest(const CellSurface& surface, const InnerBoxes* boxes = nullptr);

  // near_reach: world units from an eye within which its near plane may clip. Forgets what was found for other cells.
  void set_cell(const CellBox& cell, double near_reach);
  // Whether no segment from the cell to the box is free. What was asked about the cell before decides how soon it is
  // found, and, where floods grow too long, whether it is.
  [[nodiscard]] bool hides(const CellBox& what);

  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }

 private:
  void begin_floods();
  void find_hits(const CellBox& what, std::size_t segment, std::size_t most, std::vector<std::uint32_t>& hits) const;
  [[nodiscard]] bool is_boxed(const CellBox& what);
  [[nodiscard]] bool is_free(const CellBox& what);
  [[nodiscard]] bool is_blocked(const CellBox& what, std::size_t segment);
  [[nodiscard]] bool must_avoid(std::uint32_t t, const CellBox& what) const;
  [[nodiscard]] bool flood_any(const Hull& hull, const CellBox& what, std::span<const std::uint32_t> seeds);
  [[nodiscard]] bool flood(const Hull& hull, const CellBox& what, std::uint32_t first);
  [[nodiscard]] bool visit(const Hull& hull, const CellBox& what, std::uint32_t t);
  [[nodiscard]] bool is_crossed_already(std::uint32_t edge) const;
  [[nodiscard]] bool reach(std::uint32_t t);
  [[nodiscard]] bool is_crossed(const CellBox& what) const;
  [[nodiscard]] std::optional<bool> is_crossed(const CellSegment& segment) const;
  [[nodiscard]] double growth(std::uint32_t t) const { return surface_.moved(t) + rounding_; }

  // Which triangles have hidden something from the cell, the last of all that share a place.
  static constexpr std::size_t memory_size = 1U << 13U;
  [[nodiscard]] static std::size_t memory_place(std::uint32_t t) { return t * 0x9E3779B1U % memory_size; }
  [[nodiscard]] bool has_hidden(std::uint32_t t) const { return hid_[memory_place(t)] == t; }

  const CellSurface& surface_;
  const InnerBoxes* parts_ = nullptr;  // or none
  std::optional<InnerBoxTest> boxes_;
  CellBox cell_;
  double near_reach_ = 0.0;
  double rounding_ = 0.0;
  Counts counts_;

  std::vector<std::uint32_t> hid_;
  std::vector<std::uint32_t> seeds_;                                       // triangles where floods begin
  std::vector<std::uint32_t> hits_;                                        // those of another segment
  std::size_t first_segment_ = 0;                                          // that is tried: the one that was free last
  std::array<std::uint32_t, inner_segments + outer_segments> blockers_{};  // the last triangles that were on them
  std::vector<std::uint32_t> reached_;     // by this flood, those that are looked at first
  ZeroedArray<std::uint32_t> reached_by_;  // the last flood that did so, by triangle
  std::uint32_t flood_ = 0;                // its number
  std::uint32_t first_flood_ = 0;          // of this query
  std::size_t reached_count_ = 0;          // by all floods of this query
};

}  // namespace occlod
