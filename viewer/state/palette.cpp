#include "palette.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace occlod::viewer {
namespace {

using Stops = std::array<glm::vec3, 6>;

// From dark blue over green to yellow: levels. After viridis (Smith & van der Walt), lightened at the dark end.
constexpr Stops level_stops = {
    {{74, 60, 130}, {60, 96, 146}, {42, 136, 142}, {53, 176, 120}, {132, 206, 80}, {246, 222, 60}}};
// From pale to dark red: errors.
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
  if (!(error_px > least_error_px)) return mix(error_stops, 0.0);
  return mix(error_stops, std::log2(error_px / least_error_px) / std::log2(most_error_px / least_error_px));
}

glm::u8vec4 age_color(std::uint32_t occluders) {
  if (occluders == never_asked) return never_asked_color;
  return mix(level_stops, 1.0 - std::log2(1.0 + occluders) / std::log2(1.0 + most_age));
}

std::vector<LegendEntry> legend_of(ColorBy color_by, int level_count) {
  std::vector<LegendEntry> legend;
  switch (color_by) {
    case ColorBy::plain:
    case ColorBy::vertices:
      break;
    case ColorBy::level:
      legend.push_back({base_mesh_color, "base mesh"});
      for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0})
        legend.push_back({level_color(share), fmt::format("level {:.0f}", share * std::max(level_count - 1, 0))});
      break;
    case ColorBy::error:
      legend.push_back({error_color(least_error_px), fmt::format("{:g} px or less", least_error_px)});
      for (const double px : {0.5, 2.0, 8.0}) legend.push_back({error_color(px), fmt::format("{:g} px", px)});
      legend.push_back({error_color(most_error_px), fmt::format("{:g} px or more", most_error_px)});
      break;
    case ColorBy::age:
      legend.push_back({base_mesh_color, "base mesh"});
      legend.push_back({age_color(0), "visible by the last occluder"});
      for (const std::uint32_t age : {1U, 3U, 7U})
        legend.push_back({age_color(age), fmt::format("visible {} occluder{} ago", age, age > 1 ? "s" : "")});
      legend.push_back({age_color(most_age), fmt::format("visible {} or more occluders ago", most_age)});
      legend.push_back({never_asked_color, "not queried since refinement from scratch"});
      break;
    case ColorBy::visibility:
      return entries(seen_colors, seen_words);
    case ColorBy::outcome:
      return entries(outcome_colors, outcome_words);
  }
  return legend;
}

}  // namespace occlod::viewer
