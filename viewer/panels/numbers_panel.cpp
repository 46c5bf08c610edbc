// Draws the strip at the bottom: the costs of the last picture, and of those before it.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cmath>

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

void draw_cell(const char* name, const std::string& value) {
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%s", name);
  draw_help_of_item(help_of_number(name));
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(value.c_str());
  draw_help_of_item(help_of_number(name));
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

void draw_table(const PictureRecord& last, const Session& session) {
  if (!ImGui::BeginTable("numbers", 4, ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_NoClip)) return;
  draw_cell("triangles", grouped(static_cast<double>(last.triangles)));
  draw_cell("splits", grouped(static_cast<double>(last.splits)));
  draw_cell("visible", session.frame()->sides[0].visible_triangles ? share(last.visible_triangles, last.triangles)
                                                                   : std::string("not counted"));
  // From frame to frame they are counted for the last mesh only.
  draw_cell("forced", share(last.forced_splits, session.frame()->sides[0].refinement.stats.new_splits));
  // The quadric error comes first: it is about what is seen, and its bound often many times as much.
  draw_cell("largest error", pixels(last.max_quadric_error_px));
  draw_cell("its bound", pixels(last.max_error_px));
  draw_cell("queries", grouped(static_cast<double>(last.queries)));
  draw_cell("hidden", share(last.queries_hidden, last.queries));
  draw_cell("split, merged",
            fmt::format("{}, {}{}", grouped(static_cast<double>(last.new_splits)),
                        grouped(static_cast<double>(last.merged_splits)), last.pending ? ", pending" : ""));
  draw_cell("changed", share(last.changed_triangles, last.triangles));
  ImGui::EndTable();
}

void draw_hlod_table(const PictureRecord& last, const hlod::Frame& frame) {
  if (!ImGui::BeginTable("numbers", 6, ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_NoClip)) return;
  const auto draw_count = [](const char* name, std::size_t count) {
    draw_cell(name, grouped(static_cast<double>(count)));
  };
  const hlod::FrameStats& stats = frame.stats;
  draw_count("nodes (DN)", stats.drawn_nodes);
  draw_count("triangles", stats.drawn_triangles);
  draw_cell("frame", fmt::format("{:.2f} ms", frame.times.frame_ms));
  draw_cell("drawn twice (RARN)", share(stats.rarn, stats.drawn_nodes));
  draw_count("queries", stats.queries);
  draw_cell("stall", fmt::format("{:.2f} ms", frame.times.stall_ms));
  draw_cell("delayed (D)", share(stats.delayed, stats.drawn_nodes));
  draw_cell("wasted", share(stats.wasted_queries, stats.queries));
  draw_cell("largest node error", pixels(stats.largest_sse_px));
  draw_count("blocked", stats.blocked);
  draw_count("hidden", stats.hidden_nodes);
  draw_cell("front", fmt::format("{:016x}", last.hash));
  ImGui::EndTable();
}

void draw_cells_table(const PictureRecord& last, const CellsFrame& frame, const RefinedSide& side) {
  if (!ImGui::BeginTable("numbers", 4, ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_NoClip)) return;
  const WalkedFrame& walked = frame.walked;
  draw_cell("triangles", grouped(static_cast<double>(walked.drawn_triangles)));
  draw_cell("cell", fmt::format("{}{}", walked.cell, walked.late ? ", late" : ""));
  draw_cell("visible", side.visible_triangles ? share(last.visible_triangles, walked.drawn_triangles)
                                              : std::string("not counted"));
  draw_cell("late frames", share(frame.late, frame.frames));
  draw_cell("error bound", pixels(walked.error_px));
  draw_cell("crossings", grouped(static_cast<double>(frame.crossings)));
  draw_cell("memory", grouped(last.memory_mb) + " MB");
  draw_cell("of cells", fmt::format("{:.2f} MB", static_cast<double>(walked.resident_bytes) / 1e6));
  draw_cell("read", fmt::format("{:.2f} MB", static_cast<double>(frame.bytes_read) / 1e6));
  draw_cell("loads", grouped(static_cast<double>(frame.loads)));
  ImGui::EndTable();
}

// Returns the scale of the graph: the first of 5, 10, 20, 50, ... that contains nearly all pictures.
double top_of(const std::deque<PictureRecord>& records, std::size_t first) {
  std::vector<double> totals;
  for (std::size_t i = first; i < records.size(); ++i) totals.push_back(records[i].total_ms());
  const auto place = totals.begin() + static_cast<std::ptrdiff_t>(totals.size() * 98 / 100);
  std::nth_element(totals.begin(), place, totals.end());
  double top = 5.0;
  for (const double factor : {2.0, 2.0, 2.5, 2.0, 2.0, 2.5, 2.0, 2.0, 2.5})
    if (*place > top) top *= factor;
  return top;
}

void draw_bars(ImDrawList& list, const Area& area, const std::deque<PictureRecord>& records, float bar) {
  const auto count = std::min(records.size(), static_cast<std::size_t>(area.width() / bar));
  const std::size_t first = records.size() - count;
  const double top = top_of(records, first);
  float x = area.high.x - static_cast<float>(count) * bar;
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

void draw_times(const PictureRecord& last, bool is_hlod) {
  for (const Part& part : parts) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float side = ImGui::GetFontSize() * 0.7F;
    const float low = at.y + (ImGui::GetTextLineHeight() - side) / 2.0F;
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(at.x, low), ImVec2(at.x + side, low + side), part.color);
    ImGui::Dummy(ImVec2(side, side));
    ImGui::SameLine();
    ImGui::Text("%s %.1f ms", is_hlod ? part.hlod_name : part.name, part.milliseconds(last));
    draw_help_of_item(help_of_number(is_hlod ? part.hlod_name : part.name));
    ImGui::SameLine(0.0F, 16.0F);
  }
}

}  // namespace

void draw_numbers(Panels& panels, const Area& area) {
  const auto& records = panels.session.timeline().records();
  const auto& frame = panels.session.frame();
  if (records.empty() || !frame || frame->side_count() == 0) {
    ImGui::TextDisabled("No mesh has been drawn yet");
    return;
  }
  const PictureRecord& last = records.back();
  ImGui::BeginGroup();
  const bool is_hlod = !frame->hlod_sides.empty();
  if (is_hlod)
    draw_hlod_table(last, frame->hlod_sides[0].front->frame);
  else if (frame->cells)
    draw_cells_table(last, *frame->cells, frame->sides[0]);
  else
    draw_table(last, panels.session);
  draw_button(panels, "export_csv", {{"file", panels.fields.csv}});
  ImGui::SameLine();
  ImGui::SetNextItemWidth(150.0F * panels.scale);
  ImGui::InputText("##csv", &panels.fields.csv);
  if (!is_hlod && !frame->cells) {
    ImGui::SameLine();
    ImGui::TextDisabled("%s MB", grouped(last.memory_mb).c_str());
    draw_help_of_item(help_of_number("memory"));
  }
  ImGui::EndGroup();
  ImGui::SameLine(0.0F, 20.0F * panels.scale);
  ImGui::BeginGroup();
  draw_times(last, is_hlod);
  ImGui::NewLine();
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const Area graph{low, ImVec2(area.high.x - 10.0F * panels.scale, area.high.y - 8.0F * panels.scale)};
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(graph.low, graph.high, ImGui::GetColorU32(ImGuiCol_FrameBg), 3.0F);
  if (graph.width() > 20.0F && graph.height() > 10.0F) {
    const Plot plot = panels.session.state().settings.window.plot;
    if (plot == Plot::times)
      draw_bars(list, graph, records, 3.0F * panels.scale);
    else
      draw_plot(list, graph, records, plot, 3.0F * panels.scale);
    if (ImGui::InvisibleButton("graph", ImVec2(graph.width(), graph.height())))
      panels.perform("flip", {{"setting", "plot"}});
    draw_help_of_item("Click to see triangles, the visible share, the largest error, or times again");
  }
  ImGui::EndGroup();
}

}  // namespace occlod::viewer
