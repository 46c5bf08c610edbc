// The forest of splits as files tell it.
#pragma once

#include "occlod/hierarchy/hierarchy.h"

namespace occlod {

// Throws Error when the forest parent of s is another one: a file that lies about its forest could be walked without an
// end.
void require_parent(const Hierarchy& hierarchy, SplitId s, SplitId parent);

}  // namespace occlod
