// The state of OpenGL in which surfaces are drawn, and proxies tested against them.
#pragma once

#include "gl/functions.h"

namespace occlod::gl {

// Depths that should be equal differ by rounding and by the 1/256 pixel of the rasteriser: surfaces are pushed away and
// proxies are pulled near, so that a bound which touches a surface is visible.

// Both sides of surfaces, with depth test and depth writes.
void set_surface_state(const Functions& gl);
// Front faces of proxies, after set_surface_state(): depth test without depth writes.
void set_proxy_state(const Functions& gl);

}  // namespace occlod::gl
