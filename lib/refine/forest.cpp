#include "refine/forest.h"

#include <string>

#include "occlod/core/error.h"

namespace occlod {

void require_parent(const Hierarchy& hierarchy, SplitId s, SplitId parent) {
  if (hierarchy.node(s).parent != parent)
    throw Error({"hierarchy", "split " + std::to_string(s), "is not where its parent says", "build it again"});
}

}  // namespace occlod
