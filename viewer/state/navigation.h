// Moves cameras. Angles are in degrees, directions as seen in the picture: right, up, ahead.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string_view>

#include "objects.h"
#include "occlod/view.h"

namespace occlod::viewer {

// Moves the eye around the target, so that the scene turns right and up; never over the poles.
void orbit(Camera& camera, double right_deg, double up_deg);
// Turns the target around the eye; never over the poles. In orthographic views the eye is where it would be in
// perspective.
void look_around(Camera& camera, double right_deg, double up_deg);
// Moves eye and target by shares of what the picture shows at the target.
void pan(Camera& camera, double right, double up);
// Scales the distance to the target, or the orthographic height, around the point that is seen at `place` ((0, 0) = top
// left, (1, 1) = bottom right) at the target's distance, so that it stays under the cursor. factor > 0; < 1: nearer.
void zoom(Camera& camera, double factor, const glm::dvec2& place = {0.5, 0.5});
// Moves eye and target by world units along the right, up and view directions.
void move(Camera& camera, const glm::dvec3& by);
// Moves eye and target along the ground, by world units right, up and ahead.
void move_level(Camera& camera, const glm::dvec3& by);

struct Ray {
  glm::dvec3 origin{0.0};
  glm::dvec3 direction{0.0};  // not normalised
};
// Returns the ray through `place` of the picture.
[[nodiscard]] Ray ray_through(const Camera& camera, const glm::dvec2& place);

// Switches to orthographic rays, or back to perspective with the previous angle. The image at the target keeps its
// size: a camera that was in perspective before gets its eye back.
void set_orthographic(Camera& camera, bool on, const SceneBounds& bounds);

// Looks at all of `bounds` along the current direction, as near as the smaller side of the picture allows.
void frame(Camera& camera, const SceneBounds& bounds);
// Looks along an axis: "front" (against z), "back", "left", "right", "top" or "bottom" with y up, turned if z is up.
// Returns false for another word.
[[nodiscard]] bool view_from(Camera& camera, std::string_view side, const SceneBounds& bounds);
// Sets near and far planes that contain what of `bounds` is in front of the eye, with near >= far / 10,000.
void fit_range(Camera& camera, const SceneBounds& bounds);
// Like fit_range(), but first moves an orthographic camera back: its picture stays, with all of `bounds` in front of
// it.
void hold(Camera& camera, const SceneBounds& bounds);

}  // namespace occlod::viewer
