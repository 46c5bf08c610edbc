// What is asked about an entry of the queue.
#pragma once

#include "occlod/refine/refiner.h"
#include "occlod/refine/visibility.h"
#include "priority/entry.h"
#include "priority/star_visibility.h"

namespace occlod {

// The bounds of its subtree, or the corners of its star, which live in `star` until that is asked for others.
[[nodiscard]] VisibilityQuery query_about(const Entry& entry, const Hierarchy& hierarchy, Proxy proxy,
                                          StarVisibility& star);

}  // namespace occlod
