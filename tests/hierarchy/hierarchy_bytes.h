// Whether two hierarchies are the same, bit by bit.
#pragma once

#include <cstring>
#include <span>

#include "occlod/hierarchy.h"

namespace occlod::test {

template <typename T>
[[nodiscard]] bool same_bytes(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

[[nodiscard]] inline bool same_bytes(const Hierarchy& a, const Hierarchy& b) {
  const HierarchyView &x = a.data(), &y = b.data();
  return same_bytes(x.positions, y.positions) && same_bytes(x.normals, y.normals) && same_bytes(x.colors, y.colors) &&
         same_bytes(x.nodes, y.nodes) && same_bytes(x.stars, y.stars) && same_bytes(x.roots, y.roots) &&
         same_bytes(x.base_faces, y.base_faces) && x.error_bound == y.error_bound;
}

}  // namespace occlod::test
