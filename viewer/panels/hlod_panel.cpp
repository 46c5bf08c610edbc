// Shows how HLODs are traversed: the strategy, its bias as a curve, the device and the cost of its commands.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "controls.h"
#include "hlod_strategies.h"
#include "panels.h"

namespace occlod::viewer {
namespace {

// Draws the share of an error that counts (up) over the visible share of a node (right). The diagonal is that share
// itself.
void draw_bias_curve(const hlod::TraverseOptions& options, float scale) {
  const float width = ImGui::GetContentRegionAvail().x;
  const float height = 90.0F * scale;
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 high(low.x + width, low.y + height);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(low, high, ImGui::GetColorU32(ImGuiCol_FrameBg), 3.0F);
  const auto place = [&](double share, double counts) {
    return ImVec2(low.x + static_cast<float>(share) * width, high.y - static_cast<float>(counts) * height);
  };
  list.AddLine(place(0.0, 0.0), place(1.0, 1.0), ImGui::GetColorU32(ImGuiCol_Border));
  constexpr int pieces = 64;
  std::vector<ImVec2> curve;
  for (int i = 0; i <= pieces; ++i) {
    const double share = static_cast<double>(i) / pieces;
    curve.push_back(place(share, options.bias(share)));
  }
  list.AddPolyline(curve.data(), static_cast<int>(curve.size()), IM_COL32(226, 164, 84, 255), ImDrawFlags_None, 2.0F);
  list.AddText(ImVec2(low.x + 6.0F, low.y + 4.0F), ImGui::GetColorU32(ImGuiCol_TextDisabled), "B(visible share)");
  ImGui::Dummy(ImVec2(width, height));
  draw_help_of_item("How much of a node's error counts, over the share of its box that is visible");
}

void draw_bias(Panels& panels) {
  draw_setting(panels, "bias_s");
  draw_setting(panels, "bias_t");
  draw_bias_curve(panels.session.state().settings.hlod.traverse, panels.scale);
}

std::string time_text(double ns) {
  if (ns < 1e3) return fmt::format("{:.3g} ns", ns);
  return ns < 1e6 ? fmt::format("{:.3g} us", ns / 1e3) : fmt::format("{:.3g} ms", ns / 1e6);
}

struct Cost {
  const char* name;
  const char* help;
  double ns;
};

void draw_costs(const hlod::DeviceCosts& costs) {
  if (!ImGui::BeginTable("costs", 4, ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_RowBg)) return;
  const Cost rows[] = {{"draw", "Setting up a draw", costs.draw_ns},
                       {"triangle", "A triangle of a draw", costs.triangle_ns},
                       {"pixel", "A pixel that a triangle covers", costs.fragment_ns},
                       {"query", "Setting up a query", costs.query_ns},
                       {"its pixel", "A pixel that a box covers", costs.query_fragment_ns},
                       {"beside", "What a query beside a draw adds to it", costs.wrapped_query_ns},
                       {"answer", "From the end of a query until its answer can be read", costs.readback_ns},
                       {"batch", "Setting up a batch of queries", costs.batch_ns},
                       {"its box", "A box of a batch", costs.batch_item_ns},
                       {"command", "Of the processor: giving a command", costs.submit_ns},
                       {"visit", "Of the processor: looking at a node", costs.visit_ns}};
  for (const Cost& cost : rows) {
    ImGui::TableNextColumn();
    ImGui::TextDisabled("%s", cost.name);
    draw_help_of_item(cost.help);
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(time_text(cost.ns).c_str());
  }
  ImGui::EndTable();
}

void draw_device(Panels& panels) {
  draw_setting(panels, "device");
  const auto& frame = panels.session.frame();
  if (!frame || frame->hlod_sides.empty()) return;
  if (frame->device_costs)
    draw_costs(*frame->device_costs);
  else
    draw_row("Costs", "not measured yet");
  draw_help_of_item("Measured when a strategy needs to know them: nohc, batch and auto");
}

std::string megabytes(std::uint64_t bytes) { return fmt::format("{:.1f} MB", static_cast<double>(bytes) * 1e-6); }

// Shows the cache of HLODs whose meshes are loaded on demand.
void draw_cache(const hlod::StoreStats& cache) {
  draw_row("Cache", fmt::format("{} of {}", megabytes(cache.resident_bytes), megabytes(cache.budget_bytes)));
  draw_help_of_item("Meshes that are there, and what they may take: --memory");
  draw_row("Waiting",
           fmt::format("{}; {} come", grouped(static_cast<double>(cache.missing)), megabytes(cache.loading_bytes)));
  draw_help_of_item("Meshes in place of which something coarser is drawn; what is being read, also ahead of time");
  draw_row("Loaded", fmt::format("{}, {}", grouped(static_cast<double>(cache.loads)), megabytes(cache.bytes_loaded)));
  draw_help_of_item("Meshes that came since the file was opened, those that came again included");
  draw_row("Evicted", grouped(static_cast<double>(cache.evictions)));
  draw_help_of_item("Meshes that left to make room");
  draw_row("Damaged", grouped(static_cast<double>(cache.failed)));
  draw_help_of_item("Meshes that cannot be read and never come; standard error says which");
}

// Shows what `auto` drew, and the predicted time of each strategy.
void draw_forecasts(const hlod::Frame& frame) {
  draw_row("Drawn by", tool::name_of(frame.strategy));
  for (const hlod::StrategyForecast& forecast : frame.forecasts)
    draw_row(("  " + tool::name_of(forecast.strategy)).c_str(),
             fmt::format("{:.2f} ms, {} frames ago", forecast.frame_ms, forecast.age));
}

}  // namespace

void draw_hlod(Panels& panels) {
  const Session& session = panels.session;
  const bool is_open = are_hlods(*session.state().objects);
  if (!begin_section(panels, "HLOD", false)) return;
  if (!is_open) {  // otherwise they stand above
    draw_setting(panels, "strategy");
    draw_setting(panels, "hlod_tolerance");
  }
  const auto& frame = session.frame();
  if (frame && !frame->hlod_sides.empty() && frame->hlod_sides[0].strategy == hlod::Strategy::automatic)
    draw_forecasts(frame->hlod_sides[0].front->frame);
  if (!is_open || !session.state().settings.compare) draw_setting(panels, "other_strategy");
  draw_setting(panels, "most_triangles");
  draw_bias(panels);
  draw_setting(panels, "between");
  if (frame && frame->cache) draw_cache(*frame->cache);
  draw_device(panels);
  draw_setting(panels, "settle");
  for (const char* name : {"hlod_color_by", "node_boxes"}) draw_setting(panels, name);
}

}  // namespace occlod::viewer
