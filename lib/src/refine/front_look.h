// A node of the front, seen from one eye.
#pragma once

#include "front.h"
#include "occlod/view/view.h"
#include "star.h"

namespace occlod {

// As StarLook::look, of a star wholly inside the frustum. Precondition: its planes are known.
[[nodiscard]] StarView look(const FrontStar& star, const ObjectView& view, bool two_sided);

}  // namespace occlod
