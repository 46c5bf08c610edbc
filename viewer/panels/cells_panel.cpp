// Shows the walk through view cells: what is open, the simulated disk, the colours, and figures.
#include <fmt/format.h>

#include <string>

#include "controls.h"
#include "panels.h"

namespace occlod::viewer {
namespace {

std::string bytes_text(double bytes) {
  if (bytes < 1e6) return fmt::format("{:.1f} KB", bytes / 1e3);
  return bytes < 1e9 ? fmt::format("{:.1f} MB", bytes / 1e6) : fmt::format("{:.2f} GB", bytes / 1e9);
}

void draw_file(const Session& session) {
  const ViewCells& cells = *session.state().cells;
  draw_row("File", cells.path.filename().string());
  draw_row("Cells", fmt::format("{} in {}", grouped(static_cast<double>(cells.leaves.size())),
                                bytes_text(static_cast<double>(cells.file->file_bytes()))));
  const CellOptions& built = cells.file->options().cell;
  draw_row("Built for", built.budget > 0 ? fmt::format("{} triangles", grouped(static_cast<double>(built.budget)))
                                         : fmt::format("{:g} px", built.tolerance_px));
  if (!session.cells_fit()) draw_row("Not walked", "objects have changed");
}

std::string cell_text(const CellsFrame& frame) {
  const WalkedFrame& walked = frame.walked;
  const CellNode& node = frame.cells->file->tree().node(walked.cell);
  const auto edge = [&](int axis) { return node.box.max[axis] - node.box.min[axis]; };
  return fmt::format("{}, level {}, {:.3g} x {:.3g} x {:.3g}{}", walked.cell, node.level, edge(0), edge(1), edge(2),
                     walked.outside ? ", outside" : "");
}

std::string state_text(const CellsFrame& frame) {
  if (frame.walked.missing) return "missing: a node above is drawn";
  if (frame.walked.late) return "late: a node above is drawn";
  if (frame.walked.outside) return "nothing is promised outside";
  if (frame.unpromised.empty()) return "in time, its error holds";
  return "in time; its error may be larger here: " + frame.unpromised;
}

void draw_walk(const CellsFrame& frame) {
  const WalkedFrame& walked = frame.walked;
  draw_row("Cell", cell_text(frame));
  draw_row("State", state_text(frame));
  draw_help_of_item("Errors hold for views that magnify no more than the eye model that the cells were built for");
  draw_row("Triangles drawn", grouped(static_cast<double>(walked.drawn_triangles)));
  if (frame.left_out > 0) draw_row("Left out", grouped(static_cast<double>(frame.left_out)));
  draw_row("Error bound", fmt::format("{:.3g} px", walked.error_px));
  draw_row("Late frames", fmt::format("{} of {}, {} missing", frame.late, frame.frames, frame.missing));
  draw_row("Crossings", grouped(static_cast<double>(frame.crossings)));
  draw_row("Bytes read", fmt::format("{} in {} loads", bytes_text(static_cast<double>(frame.bytes_read)), frame.loads));
  draw_row("In memory", bytes_text(static_cast<double>(walked.resident_bytes)));
}

}  // namespace

void draw_cells(Panels& panels) {
  const Session& session = panels.session;
  const bool is_open = session.state().cells != nullptr;
  if (!begin_section(panels, "Cells", is_open)) return;
  if (is_open)
    draw_file(session);
  else
    ImGui::TextDisabled("Open a .vlod file of this scene");
  draw_setting(panels, "walk_cells");
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x * 0.5F);
  draw_setting(panels, "cells_prefetch");
  draw_setting(panels, "cells_left_out");
  for (const char* name : {"cells_memory", "cells_disk", "cells_latency", "cells_color_by", "cell_boxes"})
    draw_setting(panels, name);
  if (session.frame() && session.frame()->cells) draw_walk(*session.frame()->cells);
  draw_button(panels, "close_cells");
}

}  // namespace occlod::viewer
