// Tests what boxes inside solids hide from all of a cell.
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

// Runs the test described at InnerBoxes. Each thread needs its own.
class InnerBoxTest {
 public:
  // Both arguments must outlive this object.
  InnerBoxTest(const CellSurface& surface, const InnerBoxes& boxes);

  // Sets the cell. `near_reach` (world units) is the distance from an eye within which its near plane may clip.
  void set_cell(const CellBox& cell, double near_reach);

  // Returns whether one of the boxes that hid something before hides `what`. They are forgotten when the cell is set.
  [[nodiscard]] bool hides_again(const CellBox& what);
  // Returns whether a box of the part hides `what`.
  [[nodiscard]] bool hides(const CellBox& what, std::uint32_t part);

 private:
  enum class State : std::uint8_t { unknown, seen, hidden };

  void find_parts_at_cell();
  [[nodiscard]] bool hides_by(const CellBox& what, std::uint32_t box);
  [[nodiscard]] bool is_between(const CellBox& what, const CellBox& box) const;
  // Returns whether the box itself is hidden from the cell by its part.
  [[nodiscard]] bool is_hidden(std::uint32_t box);
  [[nodiscard]] State find_state(std::uint32_t box) const;
  void remember(std::uint32_t box);

  static constexpr std::size_t max_remembered = 32;

  const CellSurface& surface_;
  const InnerBoxes& boxes_;
  CellBox cell_;
  double near_reach_ = 0.0;
  std::vector<State> states_;              // per box
  std::vector<bool> at_cell_;              // per part: too close to the cell to hide anything
  std::vector<std::uint32_t> remembered_;  // the last boxes that hid something, the latest first
};

// Tests whether a box is hidden from all of a cell.
//
// Let S be a finite set of triangles and dS the edges that an odd number of them share. If one segment from the cell to
// the box meets S an odd number of times, no triangle of S meets the cell or the box, and dS does not meet the hull of
// both, then every segment from the cell to the box meets S: as its ends move, the parity of the intersections changes
// only where an end crosses S or the segment crosses dS. So one connected surface, which may be thin, concave or open,
// hides the box. The test needs no silhouettes, no shrunk occluders and no pixels.
//
// If S represents a set S' of the input that motions of at most m carry to S (see SurfaceMotion), the same holds for S'
// if S keeps a distance of m from cell and box, and dS from the hull. Triangles that the near plane of an eye may clip
// hide nothing, so S also keeps the near plane's reach from the cell.
//
// S is found by a flood from a triangle over all edges that meet the hull. Every segment crosses the surface that hides
// the box, so floods begin at the triangles on one of them; first at those that hid another box from the same cell.
// Most floods fail, and the sooner the better: they go first towards where they may. A flood that has reached all
// triangles of its part (see InnerBoxes) that the segment crosses fails if these are an even number, as those of
// something closed are. Where the test cannot decide, the box counts as not hidden. Reuses its memory, four bytes per
// triangle; each thread needs its own.
class HullTest {
 public:
  // Counts over all calls.
  struct Counts {
    std::size_t queries = 0;
    std::size_t boxed = 0;       // subset: hidden by a box inside a solid
    std::size_t remembered = 0;  // subset: hidden by a surface through a triangle that hid another box
    std::size_t free = 0;        // subset: not hidden because nothing on some segment from cell to box could hide it
    std::size_t floods = 0;
    std::size_t triangles = 0;  // reached by floods
  };
  static constexpr std::size_t max_triangles = 16'384;  // over all floods of a query

  // Both arguments must outlive this object. Without boxes only floods are used.
  explicit HullTest(const CellSurface& surface, const InnerBoxes* boxes = nullptr);

  // Sets the cell and forgets what was found for other cells. `near_reach` (world units) is the distance from an eye
  // within which its near plane may clip.
  void set_cell(const CellBox& cell, double near_reach);
  // Returns whether every segment from the cell to the box is blocked. Earlier queries of the same cell affect how fast
  // the answer is found and, where floods grow too long, whether the box is found to be hidden.
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
  // Finds which of the seeds the first segment crosses; none where rounding decides, or where there may be more.
  void find_crossings(const CellBox& what);
  // Finds what a flood from this triangle has to reach to fail.
  void aim(const CellBox& what, std::uint32_t first);
  // Takes the nearest to the goal from those that wait.
  [[nodiscard]] std::uint32_t next_to_visit();
  [[nodiscard]] bool visit(const Hull& hull, const CellBox& what, std::uint32_t t);
  [[nodiscard]] bool is_crossed_already(std::uint32_t edge) const;
  [[nodiscard]] bool reach(std::uint32_t t);
  [[nodiscard]] bool is_crossed(const CellBox& what) const;
  [[nodiscard]] std::optional<bool> is_crossed(const CellSegment& segment) const;
  [[nodiscard]] double growth(std::uint32_t t) const { return surface_.moved(t) + rounding_; }

  struct Waiting {
    double distance = 0.0;  // squared, to the goal
    std::uint32_t triangle = 0;

    // Orders the heap: the farthest is visited last.
    friend bool operator<(const Waiting& a, const Waiting& b) {
      return a.distance > b.distance || (a.distance == b.distance && a.triangle > b.triangle);
    }
  };

  // Caches triangles that have hidden something from the cell; each entry keeps the latest of those that share it.
  static constexpr std::size_t memory_size = 1U << 13U;
  [[nodiscard]] static std::size_t memory_place(std::uint32_t t) { return t * 0x9E3779B1U % memory_size; }
  [[nodiscard]] bool has_hidden(std::uint32_t t) const { return hid_[memory_place(t)] == t; }

  const CellSurface& surface_;
  const InnerBoxes* parts_ = nullptr;  // may be null
  std::optional<InnerBoxTest> boxes_;
  CellBox cell_;
  double near_reach_ = 0.0;
  double rounding_ = 0.0;
  Counts counts_;

  std::vector<std::uint32_t> hid_;
  std::vector<std::uint32_t> seeds_;  // triangles where floods begin
  std::vector<std::uint32_t> hits_;   // those of another segment
  std::size_t first_segment_ = 0;     // first segment to try: the one that was free last
  // The last triangle that blocked each of the segments that are tested.
  std::array<std::uint32_t, 1 + outer_segments> blockers_{};
  std::vector<std::uint32_t> reached_;     // triangles reached by this flood
  std::vector<Waiting> waiting_;           // heap of those of them that are not visited yet
  std::vector<std::uint32_t> crossings_;   // triangles that the segment with the seeds crosses; empty where unknown
  std::vector<std::uint32_t> left_;        // of these, those of the flood's part that it has not reached
  bool is_even_ = false;                   // whether the segment crosses the flood's part an even number of times
  glm::dvec3 goal_{0.0};                   // towards which the flood goes first
  ZeroedArray<std::uint32_t> reached_by_;  // per triangle: the last flood that reached it
  std::uint32_t flood_ = 0;                // number of the current flood
  std::uint32_t first_flood_ = 0;          // number of the first flood of this query
  std::size_t reached_count_ = 0;          // triangles reached by all floods of this query
};

}  // namespace occlod
