// How a camera moves. Angles in degrees, directions as seen in the picture: right, up, ahead.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string_view>

#include "objects.h"
#include "occlod/view.h"

namespace occlod::viewer {

// Around the target, so that what is seen turns right and up; never over the poles.
void orbit(Camera& camera, double right_deg, double up_deg);
// The eye stays, the target turns around it; never over the poles. Where rays are parallel the eye is where it would be
// in perspective.
void look_around(Camera& camera, double right_deg, double up_deg);
// Eye and target, by shares of what the picture shows at the target.
void pan(Camera& camera, double right, double up);
// Scales the distance to the target, or the orthographic height, around the point that is seen at `place` ((0, 0) = top
// left, (1, 1) = bottom right) as far away as the target, so that it stays under the cursor. factor > 0; < 1 = nearer.
void zoom(Camera& camera, double factor, const glm::dvec2& place = {0.5, 0.5});
// Eye and target, by world units along right, up direction, view direction.
void move(Camera& camera, const glm::dvec3& by);
// The same along the ground: right, up direction, ahead across it.
void move_level(Camera& camera, const glm::dvec3& by);

struct Ray {
  glm::dvec3 origin{0.0};
  glm::dvec3 direction{0.0};  // not of unit length
};
// What is seen at `place` of the picture.
[[nodiscard]] Ray ray_through(const Camera& camera, const glm::dvec2& place);

// Parallel rays, or perspective again, by the angle from before. What is shown at the target keeps its size: where that
// was perspective, the eye is back where it was.
void set_orthographic(Camera& camera, bool on, const SceneBounds& bounds);

// Looks at all of `bounds` along the present direction; as near as the smaller side of the picture allows.
void frame(Camera& camera, const SceneBounds& bounds);
// Looks along an axis: "front" (against z), "back", "left", "right", "top", "bottom" with y up, turned when z is up.
// False for another word.
[[nodiscard]] bool view_from(Camera& camera, std::string_view side, const SceneBounds& bounds);
// Near and far planes that hold what of `bounds` is before the eye, near as far away as far / 10,000 at least.
void fit_range(Camera& camera, const SceneBounds& bounds);
// The same, for which an orthographic camera stands back first: its picture stays, with all of `bounds` before it.
void hold(Camera& camera, const SceneBounds& bounds);

}  // namespace occlod::viewer
