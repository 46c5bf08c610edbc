// Walks through view cells: what the worker's thread does where cells are open.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cell_walk.h"
#include "cells_side.h"
#include "occlod/item_buffer.h"
#include "refine_worker.h"

namespace occlod::viewer {

class CellsBench {
 public:
  // Goes on by a sixtieth of a second where the job asks for another view than the one before, or for one more frame of
  // it. Fills the first side, `cells` and goes_on. `number`: ascending over all sides; raised where the triangles
  // change. The job has cells. Throws Error when they do not fit into memory.
  void walk(RefinedFrame& frame, std::uint64_t& number);
  void forget();

 private:
  void place(const RefineJob& job);
  void step(const RefineJob& job);
  void take_triangles(bool with_left_out);
  // What the file has for the node that is shown: for colours, and of a leaf what is left out. Without it where it
  // cannot be read: the walk tells.
  void read_splits();
  void add_left_out();
  void count_visible(RefinedSide& side, const View& view);
  [[nodiscard]] std::vector<glm::u8vec4> colors(const RefineJob& job, const RefinedSide& side,
                                                std::size_t object) const;
  [[nodiscard]] std::vector<glm::u8vec4> seen_colors(const View& view, std::size_t object) const;
  [[nodiscard]] std::size_t first_item(std::size_t object) const;

  std::shared_ptr<const ViewCells> cells_;
  CellSettings settings_;  // that the walk was begun with
  std::optional<tool::CellWalk> walk_;
  std::optional<Camera> asked_;  // for what the last step was, without the picture's size
  CellNote note_;                // the last one
  std::uint64_t notes_ = 0;      // of all walks
  CellsFrame told_;
  bool changed_ = false;                     // since triangles were taken last
  bool has_left_out_ = false;                // they were taken with what is left out
  bool has_splits_ = false;                  // drawn_ has
  Refinement drawn_;                         // what was taken
  std::vector<std::vector<CellKept>> kept_;  // by object: of what is left out
  std::uint64_t number_ = 0;
  ItemBuffer items_;
  std::vector<bool> owns_pixel_;  // by triangle that is drawn, of all objects
};

}  // namespace occlod::viewer
