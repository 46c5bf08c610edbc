// What rounding may add to the question whether a cone faces away, for those who ask it.
#pragma once

namespace occlod {

constexpr double facing_slack = 1e-6;  // of the lengths: the axis is a unit vector of floats
constexpr double eye_slack = 1.2e-7;   // of its largest coordinate: the eye was rounded to floats

}  // namespace occlod
