#include "palette.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "bias_color.h"
#include "scene/color.h"

namespace occlod::viewer {
namespace {

using Stops = std::array<glm::vec3, 6>;

// Levels run from dark blue over green to yellow, after viridis (Smith & van der Walt), lightened at the dark end.
constexpr Stops level_stops = {
    {{74, 60, 130}, {60, 96, 146}, {42, 136, 142}, {53, 176, 120}, {132, 206, 80}, {246, 222, 60}}};
// Errors run from pale to dark red.
constexpr Stops error_stops = {
    {{232, 236, 230}, {196, 218, 200}, {246, 218, 140}, {242, 160, 88}, {214, 88, 68}, {142, 34, 66}}};

glm::u8vec4 mix(const Stops& stops, double share) {
  const double place = std::clamp(share, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(place), stops.size() - 2);
  const glm::vec3 color = glm::mix(stops[i], stops[i + 1], static_cast<float>(place - static_cast<double>(i)));
  return {glm::u8vec3(color + 0.5F), 255};
}

constexpr glm::u8vec4 never_asked_color{206, 120, 128, 255};

constexpr std::array<const char*, seen_count> seen_words = {"visible", "hidden, or smaller than a pixel", "facing away",
                                                            "off screen"};
constexpr std::array<glm::u8vec4, seen_count> seen_colors = {
    {{238, 174, 92, 255}, {62, 96, 158, 255}, {128, 92, 148, 255}, {112, 118, 126, 255}}};
constexpr std::array<const char*, outcome_count> outcome_words = {"budget or tolerance",    "next split is hidden",
                                                                  "next split faces away",  "next split is off screen",
                                                                  "nothing left to refine", "forced by a dependency"};
constexpr std::array<glm::u8vec4, outcome_count> outcome_colors = {{{238, 174, 92, 255},
                                                                    {62, 96, 158, 255},
                                                                    {128, 92, 148, 255},
                                                                    {112, 118, 126, 255},
                                                                    {212, 224, 208, 255},
                                                                    {208, 82, 92, 255}}};

constexpr std::array<const char*, drawn_as_count> drawn_words = {
    "drawn without a question", "asked about, drawn at once", "delayed until its answer came",
    "blocked by a parent that is drawn", "drawn twice: refined in the same frame"};
constexpr std::array<glm::u8vec4, drawn_as_count> drawn_colors = {
    {{150, 156, 164, 255}, {96, 164, 120, 255}, {238, 174, 92, 255}, {128, 92, 148, 255}, {208, 66, 76, 255}}};
constexpr std::array<const char*, 4> answer_words = {"answer not used", "hidden by a query",
                                                     "visible: decided something", "wasted: decided nothing"};
constexpr std::array<glm::u8vec4, 4> answer_colors = {
    {{196, 152, 208, 255}, {246, 246, 246, 255}, {58, 132, 206, 255}, {12, 12, 14, 255}}};

// Words and colours are those of Seen where the meaning is the same.
constexpr std::array<const char*, cell_kept_count> kept_words = {"seen in this picture", "drawn, but unseen in it",
                                                                 "left out: faces away from the cell",
                                                                 "left out: hidden from the cell"};
constexpr std::array<glm::u8vec4, cell_kept_count> kept_colors = {
    {{238, 174, 92, 255}, {62, 96, 158, 255}, {128, 92, 148, 255}, {186, 192, 198, 255}}};
constexpr std::array<const char*, cell_arrival_count> arrival_words = {"cell: not entered yet", "cell: in time",
                                                                       "cell: late"};
constexpr std::array<glm::u8vec4, cell_arrival_count> arrival_colors = {
    {{150, 156, 164, 255}, {96, 164, 120, 255}, {208, 66, 76, 255}}};

template <std::size_t count>
std::vector<LegendEntry> entries(const std::array<glm::u8vec4, count>& colors,
                                 const std::array<const char*, count>& words) {
  std::vector<LegendEntry> legend;
  for (std::size_t i = 0; i < count; ++i) legend.push_back({colors[i], words[i]});
  return legend;
}

}  // namespace

glm::u8vec4 color_of(Seen seen) { return seen_colors[static_cast<std::size_t>(seen)]; }
glm::u8vec4 color_of(Outcome outcome) { return outcome_colors[static_cast<std::size_t>(outcome)]; }
glm::u8vec4 level_color(double share) { return mix(level_stops, share); }

glm::u8vec4 error_color(double error_px) {
  if (!(error_px > min_error_px)) return mix(error_stops, 0.0);
  return mix(error_stops, std::log2(error_px / min_error_px) / std::log2(max_error_px / min_error_px));
}

glm::u8vec4 age_color(std::uint32_t occluders) {
  if (occluders == never_asked) return never_asked_color;
  return mix(level_stops, 1.0 - std::log2(1.0 + occluders) / std::log2(1.0 + max_age));
}

std::vector<LegendEntry> legend_of(ColorBy color_by, int level_count) {
  std::vector<LegendEntry> legend;
  switch (color_by) {
    case ColorBy::plain:
    case ColorBy::vertices:
    case ColorBy::texture:
      break;
    case ColorBy::level:
      legend.push_back({base_mesh_color, "base mesh"});
      for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0})
        legend.push_back({level_color(share), fmt::format("level {:.0f}", share * std::max(level_count - 1, 0))});
      break;
    case ColorBy::error:
    case ColorBy::slip:
      legend.push_back({error_color(min_error_px), fmt::format("{:g} px or less", min_error_px)});
      for (const double px : {0.5, 2.0, 8.0}) legend.push_back({error_color(px), fmt::format("{:g} px", px)});
      legend.push_back({error_color(max_error_px), fmt::format("{:g} px or more", max_error_px)});
      break;
    case ColorBy::age:
      legend.push_back({base_mesh_color, "base mesh"});
      legend.push_back({age_color(0), "visible by the last occluder"});
      for (const std::uint32_t age : {1U, 3U, 7U})
        legend.push_back({age_color(age), fmt::format("visible {} occluder{} ago", age, age > 1 ? "s" : "")});
      legend.push_back({age_color(max_age), fmt::format("visible {} or more occluders ago", max_age)});
      legend.push_back({never_asked_color, "not queried since refinement from scratch"});
      break;
    case ColorBy::visibility:
      return entries(seen_colors, seen_words);
    case ColorBy::outcome:
      return entries(outcome_colors, outcome_words);
  }
  return legend;
}

DrawnAs drawn_as(const hlod::DrawnNode& draw) {
  if (draw.refined) return DrawnAs::twice;
  if (draw.blocked) return DrawnAs::blocked;
  if (draw.delayed) return DrawnAs::delayed;
  return draw.asked ? DrawnAs::stopped : DrawnAs::unasked;
}

const char* word_of(DrawnAs drawn) { return drawn_words[static_cast<std::size_t>(drawn)]; }

glm::u8vec4 hlod_level_color(std::size_t level, std::size_t level_count) {
  return level_color(1.0 - static_cast<double>(level) / static_cast<double>(std::max<std::size_t>(level_count, 2) - 1));
}

glm::u8vec4 bias_color(float bias) { return picture::to_srgb(tool::bias_color(bias)); }

// Hues are a golden angle apart.
glm::u8vec4 patch_color(std::uint32_t patch) {
  if (patch == no_id) return base_mesh_color;
  const double hue = std::fmod(static_cast<double>(patch) * 0.61803398875, 1.0);
  const auto channel = [&](double shift) {
    const double place = std::fmod(hue + shift, 1.0) * 6.0;
    const double value = std::clamp(std::abs(place - 3.0) - 1.0, 0.0, 1.0);
    return static_cast<std::uint8_t>(std::lround(110.0 + 130.0 * value));
  };
  return {channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0), 255};
}

glm::u8vec4 color_of(DrawnAs drawn) { return drawn_colors[static_cast<std::size_t>(drawn)]; }
glm::u8vec4 color_of(hlod::Answer answer) { return answer_colors[static_cast<std::size_t>(answer)]; }

std::vector<LegendEntry> legend_of(HlodColorBy color_by, std::size_t level_count) {
  std::vector<LegendEntry> legend;
  switch (color_by) {
    case HlodColorBy::plain:
    case HlodColorBy::vertices:
    case HlodColorBy::texture:
    case HlodColorBy::patch:
      break;
    case HlodColorBy::level:
      for (std::size_t level = 0; level < level_count; ++level)
        legend.push_back(
            {hlod_level_color(level, level_count), fmt::format("level {}{}", level, level == 0 ? ", the input" : "")});
      break;
    case HlodColorBy::error:
      return legend_of(ColorBy::error, 0);
    case HlodColorBy::bias:
      for (const float bias : {1.0F, 0.75F, 0.5F, 0.25F, 0.0F})
        legend.push_back({bias_color(bias), fmt::format("{:.0f} % of the error counted", 100.0F * bias)});
      break;
    case HlodColorBy::state:
      return entries(drawn_colors, drawn_words);
  }
  return legend;
}

std::vector<LegendEntry> legend_of(NodeBoxes boxes) {
  if (boxes != NodeBoxes::asked) return {};
  std::vector<LegendEntry> legend = entries(answer_colors, answer_words);
  for (LegendEntry& entry : legend) entry.text = "box: " + entry.text;
  legend.push_back({unasked_box_color, "box: drawn without a question"});
  return legend;
}

glm::u8vec4 color_of(CellKept kept) { return kept_colors[static_cast<std::size_t>(kept)]; }
glm::u8vec4 color_of(CellArrival arrival) { return arrival_colors[static_cast<std::size_t>(arrival)]; }

std::vector<LegendEntry> legend_of(CellColorBy color_by, int level_count) {
  if (color_by == CellColorBy::level) return legend_of(ColorBy::level, level_count);
  if (color_by == CellColorBy::error) return legend_of(ColorBy::error, 0);
  if (color_by == CellColorBy::kept) return entries(kept_colors, kept_words);
  return {};
}

std::vector<LegendEntry> legend_of_difference() {
  std::vector<LegendEntry> legend = legend_of(ColorBy::error, 0);
  for (LegendEntry& entry : legend) entry.text = "depth is off by " + entry.text;
  legend.push_back({one_surface_color, "surface in one picture only"});
  return legend;
}

std::vector<LegendEntry> legend_of_arrivals() { return entries(arrival_colors, arrival_words); }

}  // namespace occlod::viewer
