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

// Returns the first of 1, 2, 5, 10, ... times a power of ten that is no less.
double round_up(double value) {
  if (!(value > 0.0)) return 1.0;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= value) return factor * power;
  return 10.0 * power;
}

}  // namespace

void draw_plot(ImDrawList& list, const Area& area, const std::deque<PictureRecord>& records, Plot plot, float step) {
  const auto last = std::find_if(records.rbegin(), records.rend(),
                                 [&](const PictureRecord& r) { return std::isfinite(value_of(r, plot)); });
  if (last == records.rend()) return;
  // Labels have a column of their own, as wide as the widest of them.
  const std::string now = "now " + text_of(value_of(*last, plot), plot);
  const float left = area.low.x + 12.0F + std::max(ImGui::CalcTextSize(now.c_str()).x, 80.0F);
  const auto count = std::min(records.size(), static_cast<std::size_t>(std::max(area.high.x - left, 0.0F) / step));
  std::vector<double> values;
  for (std::size_t i = records.size() - count; i < records.size(); ++i)
    if (const double value = value_of(records[i], plot); std::isfinite(value)) values.push_back(value);
  if (values.empty()) return;
  const double top = plot == Plot::visible ? 100.0 : round_up(*std::max_element(values.begin(), values.end()));
  std::vector<ImVec2> line;
  float x = area.high.x - static_cast<float>(values.size()) * step;
  for (const double value : values) {
    line.emplace_back(x, area.high.y - static_cast<float>(value / top) * area.height());
    x += step;
    line.emplace_back(x, line.back().y);
  }
  const ImU32 grid = ImGui::GetColorU32(ImGuiCol_Border), label = ImGui::GetColorU32(ImGuiCol_TextDisabled);
  const float line_height = ImGui::GetTextLineHeight();
  const auto write = [&](float y, const std::string& text) {
    list.AddText(ImVec2(area.low.x + 4.0F, y), label, text.c_str());
  };
  for (const float share : {0.0F, 0.5F, 1.0F}) {
    const float y = area.high.y - share * area.height();
    list.AddLine(ImVec2(left, y), ImVec2(area.high.x, y), grid);
  }
  list.AddPolyline(line.data(), static_cast<int>(line.size()), IM_COL32(226, 144, 54, 255), ImDrawFlags_None, 2.0F);
  write(area.low.y, text_of(top, plot));
  write((area.low.y + area.high.y - line_height) / 2.0F, now);
  write(area.high.y - line_height, fmt::format("0, {} pictures", values.size()));
}

}  // namespace occlod::viewer
