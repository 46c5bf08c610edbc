#include "support/hierarchy_hash.h"

#include <xxhash.h>

#include <span>

namespace occlod::bench {
namespace {

// None of the array's types has padding.
template <class T>
std::uint64_t hash_array(std::span<const T> array, std::uint64_t hash) {
  const std::uint64_t link[] = {hash, array.size(), XXH3_64bits(array.data(), array.size_bytes())};
  return XXH3_64bits(link, sizeof(link));
}

}  // namespace

std::uint64_t hash_of(const Hierarchy& hierarchy) {
  const HierarchyView& data = hierarchy.data();
  std::uint64_t hash = hash_array(data.positions, 0);
  hash = hash_array(data.normals, hash);
  hash = hash_array(data.colors, hash);
  hash = hash_array(data.nodes, hash);
  hash = hash_array(data.stars, hash);
  hash = hash_array(data.roots, hash);
  return hash_array(data.base_faces, hash);
}

}  // namespace occlod::bench
