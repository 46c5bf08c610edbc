// What bench_report measures of every picture, and how many pictures become one number.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "json_output.h"

namespace occlod::bench {

enum class Mean {
  arithmetic,
  square,   // the root of the mean of the squares
  decibel,  // of the mean of the powers: PSNR of all pixels of all pictures
  middle,   // the median
};

struct Measure {
  const char* key;  // in CSV and JSON
  const char* name;
  const char* unit;
  bool less_is_better;
  Mean mean;
  const char* about;
};

inline constexpr std::array measures = {
    Measure{"depth_rms_px", "visible error", "px", true, Mean::square,
            "root mean square distance between the pictures' depth and that of the full mesh, in pixels at that depth, "
            "each capped at 10"},
    Measure{"largest_px", "largest visible error", "px", true, Mean::arithmetic,
            "the farthest that any silhouette or surface of the picture is from where the full mesh has it, no more "
            "than 64"},
    Measure{"psnr_y", "PSNR of Y", "dB", false, Mean::decibel, "luma of the shaded picture"},
    Measure{"psnr_cb", "PSNR of Cb", "dB", false, Mean::decibel, "blue against luma"},
    Measure{"psnr_cr", "PSNR of Cr", "dB", false, Mean::decibel, "red against luma"},
    Measure{"silhouette_mismatch", "silhouette mismatch", "%", true, Mean::arithmetic,
            "pixels that only one of the two pictures covers"},
    Measure{"visible_share", "visible share", "%", false, Mean::arithmetic, "triangles that own a pixel"},
    Measure{"wrongly_hidden_px", "wrongly hidden", "px", true, Mean::arithmetic,
            "pixels of a picture that occlusion made wrong when everything is refined to one pixel without a budget"},
    Measure{"pop_rms_px", "popping", "px", true, Mean::square,
            "root mean square jump of the surface from one frame to the next because of the mesh alone"},
    Measure{"pop_largest_px", "largest pop", "px", true, Mean::arithmetic,
            "the farthest that any silhouette or surface jumps, no more than 64"},
    Measure{"max_error_px", "promised error", "px", true, Mean::middle,
            "the largest guaranteed error left on surface held to be visible"},
    Measure{"texture_slip_px", "texture slip", "px", true, Mean::square,
            "root mean square distance of what is on textures from where the picture of the full mesh has it, each "
            "capped at 10; scenes without texture coordinates have none"},
};

// Places in `measures`.
inline constexpr std::size_t main_measure = 0;
inline constexpr std::size_t wrongly_hidden_measure = 7;
static_assert(measures[wrongly_hidden_measure].mean == Mean::arithmetic);

// A number for each measure; what was not measured is NaN.
using Measured = std::array<double, measures.size()>;

// Of those that are numbers; NaN when none is.
[[nodiscard]] double mean_of(Mean mean, std::span<const double> values);
[[nodiscard]] Measured mean_of(std::span<const Measured> pictures);

// null for what is not finite.
[[nodiscard]] tool::Json number(double value);

}  // namespace occlod::bench
