// Defines the colours that carry information, and the words for them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

#include "settings.h"

namespace occlod::viewer {

// Tells how the camera for which a mesh was refined sees a triangle.
enum class Seen : std::uint8_t {
  visible,      // owns a pixel
  hidden,       // behind others, or too small to own a pixel
  back_facing,  // faces away, and owns no pixel
  off_screen,
};
inline constexpr std::size_t seen_count = 4;

// Tells what ended refinement at a triangle, judged from the finished mesh and its last occluder.
enum class Outcome : std::uint8_t {
  budget,       // it would continue, but the budget is used up or the tolerance met
  hidden,       // the next split is hidden by the occluder
  back_facing,  // it faces away
  off_screen,   // it is outside the frustum
  complete,     // there is no next split: a triangle of the input
  forced,       // made by an invisible split on which others depend
};
inline constexpr std::size_t outcome_count = 6;

// Tells how a node of an HLOD came to be drawn; the last that applies.
enum class DrawnAs : std::uint8_t {
  unasked,  // without its own query
  stopped,  // queried, and drawn at once
  delayed,  // drawn when its answer came
  blocked,  // was to be refined, but a parent was drawn
  twice,    // drawn, and refined in the same frame
};
inline constexpr std::size_t drawn_as_count = 5;
[[nodiscard]] DrawnAs drawn_as(const hlod::DrawnNode& draw);
[[nodiscard]] const char* word_of(DrawnAs drawn);

// Tells what happens to an active triangle of a view cell.
enum class CellKept : std::uint8_t {
  seen,         // drawn, and owns a pixel
  unseen,       // drawn, and owns none in this picture
  facing_away,  // left out: every eye in the cell sees its back
  hidden,       // left out: hidden from the whole cell
};
inline constexpr std::size_t cell_kept_count = 4;

// Tells whether a cell was loaded when the eye came to it.
enum class CellArrival : std::uint8_t { not_visited, in_time, late };
inline constexpr std::size_t cell_arrival_count = 3;

// Colours are sRGB.
[[nodiscard]] glm::u8vec4 color_of(Seen seen);
[[nodiscard]] glm::u8vec4 color_of(Outcome outcome);
[[nodiscard]] glm::u8vec4 level_color(double share);  // of the deepest level, in [0, 1]
[[nodiscard]] glm::u8vec4 error_color(double error_px);
inline constexpr double min_error_px = 0.125;  // lower end of its logarithmic scale
inline constexpr double max_error_px = 16.0;
[[nodiscard]] glm::u8vec4 age_color(std::uint32_t occluders);       // see Refiner::visibility_ages()
inline constexpr std::uint32_t max_age = 15;                        // upper end of its logarithmic scale
inline constexpr glm::u8vec4 no_surface_color{210, 216, 224, 255};  // of a difference: neither picture has a surface
inline constexpr glm::u8vec4 one_surface_color{92, 60, 150, 255};   // of a difference: only one of them has
inline constexpr glm::u8vec4 base_mesh_color{120, 124, 132, 255};   // of triangles that no split has made

// These colours are for HLODs. Level 0 is the input.
[[nodiscard]] glm::u8vec4 hlod_level_color(std::size_t level, std::size_t level_count);
[[nodiscard]] glm::u8vec4 bias_color(float bias);
[[nodiscard]] glm::u8vec4 patch_color(std::uint32_t patch);
[[nodiscard]] glm::u8vec4 color_of(DrawnAs drawn);
[[nodiscard]] glm::u8vec4 color_of(hlod::Answer answer);          // of a box
inline constexpr glm::u8vec4 unasked_box_color{96, 96, 96, 255};  // drawn without a query

// These colours are for view cells.
[[nodiscard]] glm::u8vec4 color_of(CellKept kept);
[[nodiscard]] glm::u8vec4 color_of(CellArrival arrival);  // of a box

struct LegendEntry {
  glm::u8vec4 color;
  std::string text;
};
// Returns no entries where colours tell nothing.
[[nodiscard]] std::vector<LegendEntry> legend_of(ColorBy color_by, int level_count);
[[nodiscard]] std::vector<LegendEntry> legend_of(HlodColorBy color_by, std::size_t level_count);
[[nodiscard]] std::vector<LegendEntry> legend_of(NodeBoxes boxes);
[[nodiscard]] std::vector<LegendEntry> legend_of(CellColorBy color_by, int level_count);
[[nodiscard]] std::vector<LegendEntry> legend_of_arrivals();
[[nodiscard]] std::vector<LegendEntry> legend_of_difference();

}  // namespace occlod::viewer
