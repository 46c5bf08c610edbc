// Draws how a number went over the last pictures.
#include "plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "controls.h"

namespace occlod::viewer {
namespace {

double value_of(const PictureRecord& record, Plot plot) {
  switch (plot) {
    case Plot::times:
      return record.total_ms();
    case Plot::triangles:
      return static_cast<double>(record.triangles);
    case Plot::visible:
      return record.triangles == 0
                 ? 0.0
                 : 100.0 * static_cast<double>(record.visible_triangles) / static_cast<double>(record.triangles);
    case Plot::error:
      return record.max_quadric_error_px > 0.0 ? record.max_quadric_error_px : record.max_error_px;
  }
  return 0.0;
}

std::string text_of(double value, Plot plot) {
  switch (plot) {
    case Plot::times:
      return fmt::format("{:.4g} ms", value);
    case Plot::triangles:
      return grouped(value) + " triangles";
    case Plot::visible:
      return fmt::format("{:.4g} % visible", value);
    case Plot::error:
      return fmt::format("{:.4g} px", value);
  }
  return "";
}

}  // namespace

void draw_time_axis(ImDrawList& list, const Area& area, const std::deque<PictureRecord>& records, std::size_t first,
                    float step) {
  const double seconds = records.back().at_s - records[first].at_s;
  const double mark = round_up(seconds / 6.0, 1.0);
  const ImU32 dim = ImGui::GetColorU32(ImGuiCol_TextDisabled);
  const float left = area.high.x - static_cast<float>(records.size() - first) * step;
  float x = left;
  for (std::size_t i = first + 1; i < records.size(); ++i) {
    x += step;
    if (std::floor(records[i].at_s / mark) > std::floor(records[i - 1].at_s / mark))
      list.AddLine(ImVec2(x, area.low.y), ImVec2(x, area.high.y), ImGui::GetColorU32(ImGuiCol_Border));
  }
  const std::string now = fmt::format("now; a line every {:g} s", mark);
  const float now_left = area.high.x - ImGui::CalcTextSize(now.c_str()).x;
  list.AddText(ImVec2(now_left, area.high.y), dim, now.c_str());
  const std::string ago = fmt::format("{:.1f} s ago", seconds);
  const float ago_left = std::max(area.low.x, left);
  if (ago_left + ImGui::CalcTextSize(ago.c_str()).x < now_left)
    list.AddText(ImVec2(ago_left, area.high.y), dim, ago.c_str());
}

void draw_plot(ImDrawList& list, const Area& area, const std::deque<PictureRecord>& records, Plot plot, float step) {
  // Labels have a column of their own, as wide as the widest of them.
  const std::string now = "now " + text_of(value_of(records.back(), plot), plot);
  const Area graph{ImVec2(area.low.x + 12.0F + std::max(ImGui::CalcTextSize(now.c_str()).x, 80.0F), area.low.y),
                   area.high};
  const auto count = std::min(records.size(), static_cast<std::size_t>(std::max(graph.width(), 0.0F) / step));
  if (count == 0) return;
  const std::size_t first = records.size() - count;
  double most = 0.0;
  for (std::size_t i = first; i < records.size(); ++i)
    if (const double value = value_of(records[i], plot); std::isfinite(value)) most = std::max(most, value);
  const double top = plot == Plot::visible ? 100.0 : round_up(most, plot == Plot::triangles ? 1000.0 : 0.01);
  std::vector<ImVec2> line;
  float x = graph.high.x - static_cast<float>(count) * step;
  for (std::size_t i = first; i < records.size(); ++i, x += step) {
    const double value = value_of(records[i], plot);
    if (!std::isfinite(value)) continue;
    const float y = graph.high.y - static_cast<float>(value / top) * graph.height();
    line.emplace_back(x, y);
    line.emplace_back(x + step, y);
  }
  draw_time_axis(list, graph, records, first, step);
  const ImU32 grid = ImGui::GetColorU32(ImGuiCol_Border), label = ImGui::GetColorU32(ImGuiCol_TextDisabled);
  const float middle = (graph.low.y + graph.high.y) / 2.0F, line_height = ImGui::GetTextLineHeight();
  for (const float y : {graph.low.y, middle, graph.high.y})
    list.AddLine(ImVec2(graph.low.x, y), ImVec2(graph.high.x, y), grid);
  list.AddPolyline(line.data(), static_cast<int>(line.size()), IM_COL32(226, 144, 54, 255), ImDrawFlags_None, 2.0F);
  const auto write = [&](float y, const std::string& text) {
    list.AddText(ImVec2(area.low.x + 4.0F, y), label, text.c_str());
  };
  write(graph.low.y, text_of(top, plot));
  write(middle - line_height / 2.0F, now);
  write(graph.high.y - line_height, "0");
}

}  // namespace occlod::viewer
