// Walks through view cells on the worker's thread when cells are open.
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
  // Advances by a sixtieth of a second if the job asks for another view than the last job, or for one more frame of it.
  // Fills the first side, `cells` and goes_on. `number` ascends over all sides, and is increased when the triangles
  // change. The job has cells. Throws Error when they do not fit into memory.
  void walk(RefinedFrame& frame, std::uint64_t& number);
  void forget();

 private:
  void place(const RefineJob& job);
  void step(const RefineJob& job);
  void take_triangles(bool with_left_out);
  // Reads what the file has for the shown node, for colours and, at a leaf, for the left-out triangles. Does without it
  // if it cannot be read, which the walk reports.
  void read_splits();
  void add_left_out();
  void count_visible(RefinedSide& side, const View& view);
  [[nodiscard]] std::vector<glm::u8vec4> colors(const RefineJob& job, const RefinedSide& side,
                                                std::size_t object) const;
  [[nodiscard]] std::vector<glm::u8vec4> seen_colors(const View& view, std::size_t object) const;
  [[nodiscard]] std::size_t first_item(std::size_t object) const;

  std::shared_ptr<const ViewCells> cells_;
  CellSettings settings_;  // with which the walk was begun
  std::optional<tool::CellWalk> walk_;
  std::optional<Camera> asked_;  // for the last step, without the picture's size
  CellNote note_;                // the last note
  std::uint64_t notes_ = 0;      // over all walks
  CellsFrame told_;
  bool changed_ = false;                     // since triangles were last taken
  bool has_left_out_ = false;                // whether they were taken with left-out triangles
  bool has_splits_ = false;                  // whether drawn_ has splits
  Refinement drawn_;                         // what was taken
  std::vector<std::vector<CellKept>> kept_;  // per object, for left-out triangles
  std::uint64_t number_ = 0;
  ItemBuffer items_;
  std::vector<bool> owns_pixel_;  // per drawn triangle, of all objects
};

}  // namespace occlod::viewer
