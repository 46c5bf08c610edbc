#include "cells_side.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "occlod/build_hierarchy.h"
#include "occlod/cell_builder.h"

namespace occlod::viewer {
namespace {

double value_of(const ViewCells& cells, CellId leaf, CellBoxes boxes) {
  const CellNode& node = cells.file->tree().node(leaf);
  if (boxes == CellBoxes::bytes) return static_cast<double>(cells.path_bytes[leaf]);
  return boxes == CellBoxes::error ? static_cast<double>(node.error_px) : static_cast<double>(node.drawn_triangles);
}

// Returns a place in [0, 1]; 0 if all leaves have the same value.
double place_of(const CellScale& scale, double value) {
  if (!(scale.most > scale.least)) return 0.0;
  const double least = std::max(scale.least, 1e-3 * scale.most);
  return std::clamp(std::log(std::max(value, least) / least) / std::log(scale.most / least), 0.0, 1.0);
}

}  // namespace

LeftOut left_out_of(const ViewCells& cells, CellId leaf, std::size_t object, const CellObjectCut& cut) {
  const PlacedObject& placed = (*cells.objects)[object];
  const Hierarchy& hierarchy = *placed.mesh->hierarchy;
  FixedCut fixed;
  fixed.applied.resize(hierarchy.split_count());
  for (const SplitId s : cut.applied) fixed.applied[s] = true;
  const CellView view(cells.file->tree().node(leaf).box, cells.file->options().cell.eyes, placed.object_to_world);
  LeftOut out;
  auto drawn = cut.triangles.begin();  // in the order of the active ones
  for (const Triangle& t : wedge_triangles_of(hierarchy, fixed)) {
    if (drawn != cut.triangles.end() && *drawn == t) {
      ++drawn;
      continue;
    }
    const auto corner = [&](int k) { return hierarchy.positions()[t[k]]; };
    const bool away = !placed.two_sided && view.faces_away(corner(0), corner(1), corner(2));
    out.triangles.push_back(t);
    out.kept.push_back(away ? CellKept::facing_away : CellKept::hidden);
  }
  return out;
}

CellScale scale_of(const ViewCells& cells, CellBoxes boxes) {
  CellScale scale{std::numeric_limits<double>::infinity(), 0.0};
  for (const CellId leaf : cells.leaves) {
    const double value = value_of(cells, leaf, boxes);
    scale.least = std::min(scale.least, value);
    scale.most = std::max(scale.most, value);
  }
  return scale;
}

glm::u8vec4 box_color(const CellsFrame& frame, CellId leaf, CellBoxes boxes, const CellScale& scale) {
  if (boxes != CellBoxes::late) return level_color(place_of(scale, value_of(*frame.cells, leaf, boxes)));
  const auto visit = frame.visits.find(leaf);
  if (visit == frame.visits.end()) return color_of(CellArrival::not_visited);
  return color_of(visit->second.late > 0 ? CellArrival::late : CellArrival::in_time);
}

std::vector<LegendEntry> legend_of(const ViewCells& cells, CellBoxes boxes) {
  if (boxes == CellBoxes::none || boxes == CellBoxes::cell) return {};
  if (boxes == CellBoxes::late) return legend_of_arrivals();
  const CellScale scale = scale_of(cells, boxes);
  std::vector<LegendEntry> legend;
  for (const double value : {scale.least, std::sqrt(scale.least * scale.most), scale.most}) {
    const std::string text = boxes == CellBoxes::triangles ? fmt::format("{:.0f} triangles", value)
                             : boxes == CellBoxes::error   ? fmt::format("{:.3g} px", value)
                                                           : fmt::format("{:.1f} KB", value / 1e3);
    legend.push_back({level_color(place_of(scale, value)), "cell: " + text});
    if (!(scale.most > scale.least)) break;
  }
  return legend;
}

}  // namespace occlod::viewer
