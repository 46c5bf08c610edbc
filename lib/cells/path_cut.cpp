#include "cells/path_cut.h"

#include <algorithm>

#include "cells/leaf_faces.h"

namespace occlod {

void PathCut::gather(std::uint32_t object, std::span<const CellAdditions* const> path, bool is_leaf) {
  applied.clear();
  hidden.clear();
  for (const CellAdditions* node : path) {
    const auto found = std::ranges::lower_bound(node->objects, object, {}, &ObjectAdditions::object);
    if (found == node->objects.end() || found->object != object) continue;
    applied.insert(applied.end(), found->splits.begin(), found->splits.end());
    if (is_leaf) hidden.insert(hidden.end(), found->hidden.begin(), found->hidden.end());
  }
  std::ranges::sort(applied);
  std::ranges::sort(hidden, {}, face_key);
}

}  // namespace occlod
