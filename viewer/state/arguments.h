// Reads the parameters of actions.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string_view>

#include "base/strict_json.h"

namespace occlod::viewer {

[[nodiscard]] glm::dvec3 vector_at(const JsonPlace& action, std::string_view key);
// Returns `value` if the action lacks the key.
[[nodiscard]] double number_or(const JsonPlace& action, std::string_view key, double value);
// Returns "x" and "y" of a place in the picture, each in [0, 1]; the middle if they are missing.
[[nodiscard]] glm::dvec2 place_of(const JsonPlace& action);

}  // namespace occlod::viewer
