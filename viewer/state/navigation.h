// How a camera moves. Angles in degrees, directions as seen in the picture: right, up, ahead.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string_view>

#include "objects.h"
#include "occlod/view/camera.h"

namespace occlod::viewer {

// Around the target, so that what is seen turns right and up; never over the poles.
void orbit(Camera& camera, double right_deg, double up_deg);
// The eye stays, the target turns around it; never over the poles.
void look_around(Camera& camera, double right_deg, double up_deg);
// Eye and target, by shares of what the picture shows at the target.
void pan(Camera& camera, double right, double up);
// Scales the distance to the target around the point that is seen at `place` ((0, 0) = top left, (1, 1) = bottom right)
// as far away as the target, so that it stays under the cursor. factor > 0; < 1 = nearer.
void zoom(Camera& camera, double factor, const glm::dvec2& place = {0.5, 0.5});
// Eye and target, by world units along right, up direction, view direction.
void move(Camera& camera, const glm::dvec3& by);
// The same along the ground: right, up direction, ahead across it.
void move_level(Camera& camera, const glm::dvec3& by);

// From the eye through `place` of the picture; not of unit length.
[[nodiscard]] glm::dvec3 ray_through(const Camera& camera, const glm::dvec2& place);

// Looks at all of `bounds` along the present direction; as near as the smaller side of the picture allows.
void frame(Camera& camera, const SceneBounds& bounds);
// Looks along an axis: "front" (against z), "back", "left", "right", "top", "bottom" with y up, turned when z is up.
// False for another word.
[[nodiscard]] bool view_from(Camera& camera, std::string_view side, const SceneBounds& bounds);
// Near and far planes that hold `bounds`, near as far away as far / 10,000 at least.
void fit_range(Camera& camera, const SceneBounds& bounds);

}  // namespace occlod::viewer
