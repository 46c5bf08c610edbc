// Reading the parameters of actions.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string_view>

#include "base/strict_json.h"

namespace occlod::viewer {

[[nodiscard]] glm::dvec3 vector_at(const JsonPlace& action, std::string_view key);
// `value` where the action does not have it.
[[nodiscard]] double number_or(const JsonPlace& action, std::string_view key, double value);
// "x" and "y" of a place in the picture, each in [0, 1]; the middle where they are not given.
[[nodiscard]] glm::dvec2 place_of(const JsonPlace& action);

}  // namespace occlod::viewer
