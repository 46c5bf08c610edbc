// Draws the strip at the bottom: the costs of the last picture, and of those before it.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "controls.h"
#include "panels.h"
#include "plots.h"

namespace occlod::viewer {
namespace {

struct Part {
  const char* name;
  const char* hlod_name;
  ImU32 color;
  double (*milliseconds)(const PictureRecord&);
};
constexpr std::array<Part, 4> parts = {
    {{"refine", "frame", IM_COL32(226, 164, 84, 255), [](const PictureRecord& r) { return r.refine_ms; }},
     {"occlusion", "stall", IM_COL32(84, 132, 196, 255), [](const PictureRecord& r) { return r.occlusion_ms; }},
     {"upload", "upload", IM_COL32(140, 108, 160, 255), [](const PictureRecord& r) { return r.cost.upload_ms; }},
     {"draw", "draw", IM_COL32(106, 160, 108, 255), [](const PictureRecord& r) { return r.cost.draw_ms; }}}};

struct Cell {
  const char* name;
  std::string value;
};

struct ColumnWidths {
  float names = 0.0F;
  float values = 0.0F;
};

std::vector<ColumnWidths> widths_of(const std::vector<Cell>& cells, std::size_t columns) {
  const float space = ImGui::GetFontSize() * 0.7F;
  std::vector<ColumnWidths> widths(columns, {0.0F, ImGui::CalcTextSize("123,456").x + space});
  for (std::size_t i = 0; i < cells.size(); ++i) {
    ColumnWidths& width = widths[i % columns];
    width.names = std::max(width.names, ImGui::CalcTextSize(cells[i].name).x + space);
    width.values = std::max(width.values, ImGui::CalcTextSize(cells[i].value.c_str()).x + space);
  }
  return widths;
}

// Draws them row by row, in as many columns as there is room for, each as wide as its longest text is now. (Columns of
// a table of Dear ImGui have the widths that its last picture needed.)
void draw_grid(const std::vector<Cell>& cells, std::size_t columns) {
  std::vector<ColumnWidths> widths = widths_of(cells, columns);
  const auto total = [&] {
    float sum = 0.0F;
    for (const ColumnWidths& width : widths) sum += width.names + width.values;
    return sum;
  };
  while (columns > 1 && total() > ImGui::GetContentRegionAvail().x) widths = widths_of(cells, --columns);
  const float left = ImGui::GetCursorPosX();
  float x = left;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i % columns == 0) x = left;
    if (i % columns != 0) ImGui::SameLine();
    ImGui::SetCursorPosX(x);
    ImGui::TextDisabled("%s", cells[i].name);
    draw_help_of_item(help_of_number(cells[i].name));
    ImGui::SameLine();
    ImGui::SetCursorPosX(x + widths[i % columns].names);
    ImGui::TextUnformatted(cells[i].value.c_str());
    draw_help_of_item(help_of_number(cells[i].name));
    x += widths[i % columns].names + widths[i % columns].values;
  }
}

std::string share(std::size_t part, std::size_t whole) {
  if (whole == 0) return "0";
  return fmt::format("{} ({:.1f} %)", grouped(static_cast<double>(part)),
                     100.0 * static_cast<double>(part) / static_cast<double>(whole));
}

std::string pixels(double px) {
  if (!std::isfinite(px)) return "unbounded";
  return px < 1000.0 ? fmt::format("{:.2f} px", px) : grouped(px) + " px";
}

std::string count(std::size_t number) { return grouped(static_cast<double>(number)); }

std::vector<Cell> cells_of_mesh(const PictureRecord& shown, const RefinedSide& side) {
  return {{"triangles", count(shown.triangles)},
          {"splits", count(shown.splits)},
          {"visible",
           side.visible_triangles ? share(shown.visible_triangles, shown.triangles) : std::string("not counted")},
          // From frame to frame they are counted for the last mesh only.
          {"forced", share(shown.forced_splits, side.refinement.stats.new_splits)},
          // The quadric error comes first: it is about what is seen, and its bound often many times as much.
          {"largest error", pixels(shown.max_quadric_error_px)},
          {"its bound", pixels(shown.max_error_px)},
          {"queries", count(shown.queries)},
          {"hidden", share(shown.queries_hidden, shown.queries)},
          {"split, merged", fmt::format("{}, {}{}", count(side.refinement.stats.new_splits),
                                        count(side.refinement.stats.merged_splits), shown.pending ? ", pending" : "")},
          {"changed", share(side.refinement.stats.changed_triangles, shown.triangles)}};
}

std::vector<Cell> cells_of_hlod(const PictureRecord& shown, const hlod::Frame& frame) {
  const hlod::FrameStats& stats = frame.stats;
  return {{"nodes (DN)", count(stats.drawn_nodes)},
          {"triangles", count(stats.drawn_triangles)},
          {"frame", fmt::format("{:.2f} ms", frame.times.frame_ms)},
          {"drawn twice", share(stats.rarn, stats.drawn_nodes)},
          {"queries", count(stats.queries)},
          {"stall", fmt::format("{:.2f} ms", frame.times.stall_ms)},
          {"delayed (D)", share(stats.delayed, stats.drawn_nodes)},
          {"wasted", share(stats.wasted_queries, stats.queries)},
          {"node error", pixels(stats.largest_sse_px)},
          {"blocked", count(stats.blocked)},
          {"hidden", count(stats.hidden_nodes)},
          {"front", fmt::format("{:016x}", shown.hash)}};
}

std::vector<Cell> cells_of_walk(const PictureRecord& shown, const CellsFrame& frame, const RefinedSide& side) {
  const WalkedFrame& walked = frame.walked;
  return {{"triangles", count(walked.drawn_triangles)},
          {"cell", fmt::format("{}{}", walked.cell, walked.late ? ", late" : "")},
          {"visible", side.visible_triangles ? share(shown.visible_triangles, walked.drawn_triangles)
                                             : std::string("not counted")},
          {"late frames", share(frame.late, frame.frames)},
          {"error bound", pixels(walked.error_px)},
          {"crossings", count(frame.crossings)},
          {"memory", grouped(shown.memory_mb) + " MB"},
          {"of cells", fmt::format("{:.2f} MB", static_cast<double>(walked.resident_bytes) / 1e6)},
          {"read", fmt::format("{:.2f} MB", static_cast<double>(frame.bytes_read) / 1e6)},
          {"loads", count(frame.loads)}};
}

void draw_cells_of(const RefinedFrame& frame, const PictureRecord& shown) {
  if (!frame.hlod_sides.empty()) return draw_grid(cells_of_hlod(shown, frame.hlod_sides[0].front->frame), 3);
  draw_grid(frame.cells ? cells_of_walk(shown, *frame.cells, frame.sides[0]) : cells_of_mesh(shown, frame.sides[0]), 2);
}

// Draws a bar for each of the last pictures.
void draw_bars(ImDrawList& list, const Area& area, const std::deque<PictureRecord>& records, float bar) {
  const auto bars = std::min(records.size(), static_cast<std::size_t>(area.width() / bar));
  const std::size_t first = records.size() - bars;
  const double top = graph_top_ms(records, first);
  draw_time_axis(list, area, records, first, bar);
  float x = area.high.x - static_cast<float>(bars) * bar;
  for (std::size_t i = first; i < records.size(); ++i, x += bar) {
    float y = area.high.y;
    for (const Part& part : parts) {
      const auto height = static_cast<float>(part.milliseconds(records[i]) / top) * area.height();
      const float next = std::max(y - height, area.low.y);
      list.AddRectFilled(ImVec2(x, next), ImVec2(x + bar, y), part.color);
      y = next;
    }
  }
  list.AddText(ImVec2(area.low.x + 4.0F, area.low.y + 2.0F), ImGui::GetColorU32(ImGuiCol_TextDisabled),
               fmt::format("{:g} ms", top).c_str());
}

// Draws the costs of a picture, as many in a line as there is room for.
void draw_times(const PictureRecord& last, bool is_hlod, float right) {
  for (const Part& part : parts) {
    const std::string text = fmt::format("{} {:.1f} ms", is_hlod ? part.hlod_name : part.name, part.milliseconds(last));
    const float side = ImGui::GetFontSize() * 0.7F, gap = ImGui::GetStyle().ItemSpacing.x;
    const float width = side + gap + ImGui::CalcTextSize(text.c_str()).x;
    if (&part != parts.data()) {
      ImGui::SameLine(0.0F, ImGui::GetFontSize());
      if (ImGui::GetCursorScreenPos().x + width > right) ImGui::NewLine();
    }
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float low = at.y + (ImGui::GetTextLineHeight() - side) / 2.0F;
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(at.x, low), ImVec2(at.x + side, low + side), part.color);
    ImGui::Dummy(ImVec2(side, side));
    ImGui::SameLine();
    ImGui::TextUnformatted(text.c_str());
    draw_help_of_item(help_of_number(is_hlod ? part.hlod_name : part.name));
  }
}

void draw_graph(Panels& panels, ImDrawList& list, const Area& area) {
  const auto& records = panels.session.timeline().records();
  const Plot plot = panels.session.state().settings.window.plot;
  const float step = 3.0F * panels.scale;
  if (plot == Plot::times)
    draw_bars(list, area, records, step);
  else
    draw_plot(list, area, records, plot, step);
  if (ImGui::InvisibleButton("graph", ImVec2(area.width(), area.height())))
    panels.perform("flip", {{"setting", "plot"}});
  draw_help_of_item("Click to see triangles, the visible share, the largest error, or times again");
}

const char* why_there_is_nothing(const Session& session) {
  if (session.loader().busy()) return "A file is being opened";
  return session.state().objects->empty() ? "Nothing is open" : "The first picture is being prepared";
}

}  // namespace

void draw_numbers(Panels& panels, const Area& area) {
  const auto& records = panels.session.timeline().records();
  const auto& frame = panels.session.frame();
  if (!frame || frame->side_count() == 0) {
    ImGui::TextDisabled("%s", why_there_is_nothing(panels.session));
    return;
  }
  const PictureRecord shown = panels.session.record_of_frame();
  ImGui::BeginGroup();
  draw_cells_of(*frame, shown);
  draw_button(panels, "export_csv", {{"file", panels.fields.csv}});
  ImGui::SameLine();
  ImGui::SetNextItemWidth(150.0F * panels.scale);
  ImGui::InputText("##csv", &panels.fields.csv);
  if (!frame->sides.empty() && !frame->cells) {
    ImGui::SameLine();
    ImGui::TextDisabled("%s MB", grouped(shown.memory_mb).c_str());
    draw_help_of_item(help_of_number("memory"));
  }
  ImGui::EndGroup();
  if (records.empty()) return;  // the costs of the first picture are not known yet
  ImGui::SameLine(0.0F, 20.0F * panels.scale);
  ImGui::BeginGroup();
  const float right = area.high.x - 10.0F * panels.scale;
  if (right - ImGui::GetCursorScreenPos().x < 100.0F * panels.scale) return ImGui::EndGroup();  // no room for a graph
  draw_times(records.back(), !frame->hlod_sides.empty(), right);
  const Area graph{ImGui::GetCursorScreenPos(),
                   ImVec2(right, area.high.y - 4.0F * panels.scale - ImGui::GetTextLineHeight())};
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(graph.low, graph.high, ImGui::GetColorU32(ImGuiCol_FrameBg), 3.0F);
  if (graph.width() > 20.0F && graph.height() > 10.0F) draw_graph(panels, list, graph);
  ImGui::EndGroup();
}

}  // namespace occlod::viewer
