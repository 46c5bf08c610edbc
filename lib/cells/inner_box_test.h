// What boxes inside solids hide from all of a cell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

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

  static constexpr std::size_t most_remembered = 32;

  const CellSurface& surface_;
  const InnerBoxes& boxes_;
  CellBox cell_;
  double near_reach_ = 0.0;
  std::vector<State> states_;              // of boxes
  std::vector<bool> at_cell_;              // parts that come too close to the cell to hide anything
  std::vector<std::uint32_t> remembered_;  // the last boxes that hid, the latest first
};

}  // namespace occlod
