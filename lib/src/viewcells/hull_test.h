// What hides a box from all of a cell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "viewcells/cell_surface.h"
#include "viewcells/hull.h"

namespace occlod {

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
// S is found by a flood from a triangle over all edges that meet the hull. What cannot be decided counts as not hidden.
// Reuses its memory; one thread each.
class HullTest {
 public:
  // Of all calls.
  struct Counts {
    std::size_t queries = 0;
    std::size_t remembered = 0;  // of these, hidden by the triangle that was tried first
    std::size_t free = 0;        // of these, not hidden because nothing on some segment from cell to box could hide it
    std::size_t floods = 0;
    std::size_t triangles = 0;  // that floods reached
  };
  static constexpr std::size_t most_triangles = 2048;  // of all floods of a query

  // The surface outlives it.
  explicit HullTest(const CellSurface& surface) : surface_(surface) {}

  // near_reach: world units from an eye within which its near plane may clip.
  void set_cell(const CellBox& cell, double near_reach);
  // Whether no segment from the cell to the box is free. `blocker`, unless no_id, is a triangle to begin with; where
  // the answer is true it becomes one of those that hide.
  [[nodiscard]] bool hides(const CellBox& what, std::uint32_t& blocker);

  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }

 private:
  [[nodiscard]] bool find_seeds(const CellBox& what);
  void find_hits(const CellBox& what, std::size_t segment, std::size_t most);
  [[nodiscard]] bool must_avoid(std::uint32_t t, const CellBox& what) const;
  [[nodiscard]] bool flood(const Hull& hull, const CellBox& what, std::uint32_t first);
  [[nodiscard]] bool visit(const Hull& hull, const CellBox& what, std::uint32_t t);
  [[nodiscard]] bool is_crossed_already(std::uint32_t edge) const;
  [[nodiscard]] bool reach(std::uint32_t t);
  [[nodiscard]] std::size_t place_of(std::uint32_t t) const;
  [[nodiscard]] bool is_crossed(const CellBox& what) const;
  [[nodiscard]] std::optional<bool> is_crossed(const glm::dvec3& from, const glm::dvec3& to) const;
  [[nodiscard]] double growth(std::uint32_t t) const { return surface_.moved(t) + rounding_; }

  const CellSurface& surface_;
  CellBox cell_;
  double near_reach_ = 0.0;
  double rounding_ = 0.0;
  Counts counts_;

  std::vector<std::uint32_t> seeds_;    // triangles where floods begin
  std::vector<std::uint32_t> hits_;     // those of one segment
  std::size_t first_segment_ = 0;       // that is tried: the one that was free last
  std::vector<std::uint32_t> reached_;  // by floods of this query, those that are looked at first
  std::size_t first_reached_ = 0;       // by this flood
  // Which triangles these are: open addressing, one entry in four at most.
  static constexpr std::size_t table_size = 4 * most_triangles;
  struct Entry {
    std::uint32_t triangle = 0;
    std::uint32_t query = 0;
    std::uint32_t place = 0;  // in reached_
  };
  std::vector<Entry> table_ = std::vector<Entry>(table_size);
  std::uint32_t query_ = 0;
};

}  // namespace occlod
