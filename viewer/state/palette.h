// The colours that tell something, and the words that go with them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

#include "settings.h"

namespace occlod::viewer {

// What a triangle of the refined mesh is to the camera that it was refined for.
enum class Seen : std::uint8_t {
  visible,      // owns a pixel
  hidden,       // behind others, or too small to own one
  back_facing,  // and nothing shows it
  off_screen,
};
inline constexpr std::size_t seen_count = 4;

// What ended refinement at a triangle, judged from the finished mesh and its last occluder.
enum class Outcome : std::uint8_t {
  budget,       // it would go on: the budget is used up, or the tolerance met
  hidden,       // the next split is hidden by the occluder
  back_facing,  // it faces away
  off_screen,   // it is outside the frustum
  complete,     // there is no next split: a triangle of the input
  forced,       // made by a split that nobody sees, on which others depend
};
inline constexpr std::size_t outcome_count = 6;

// sRGB.
[[nodiscard]] glm::u8vec4 color_of(Seen seen);
[[nodiscard]] glm::u8vec4 color_of(Outcome outcome);
[[nodiscard]] glm::u8vec4 level_color(double share);  // of the deepest level, in [0, 1]
[[nodiscard]] glm::u8vec4 error_color(double error_px);
inline constexpr double least_error_px = 0.125;  // the ends of its logarithmic scale
inline constexpr double most_error_px = 16.0;
[[nodiscard]] glm::u8vec4 age_color(std::uint32_t occluders);      // see Refiner::visibility_ages()
inline constexpr std::uint32_t most_age = 15;                      // the end of its logarithmic scale
inline constexpr glm::u8vec4 base_mesh_color{120, 124, 132, 255};  // of triangles that no split has made

struct LegendEntry {
  glm::u8vec4 color;
  std::string text;
};
// Empty where colours tell nothing.
[[nodiscard]] std::vector<LegendEntry> legend_of(ColorBy color_by, int level_count);

}  // namespace occlod::viewer
