#include "support/hierarchy_hash.h"

#include <xxhash.h>

namespace occlod::bench {
namespace {

// None of the array's types has padding.
template <class T>
std::uint64_t hash_array(const std::vector<T>& array, std::uint64_t hash) {
  const std::uint64_t link[] = {hash, array.size(), XXH3_64bits(array.data(), array.size() * sizeof(T))};
  return XXH3_64bits(link, sizeof(link));
}

}  // namespace

std::uint64_t hash_of(const Hierarchy& hierarchy) {
  const HierarchyData& data = hierarchy.data();
  std::uint64_t hash = hash_array(data.positions, 0);
  hash = hash_array(data.normals, hash);
  hash = hash_array(data.colors, hash);
  hash = hash_array(data.nodes, hash);
  hash = hash_array(data.roots, hash);
  hash = hash_array(data.first_dependency, hash);
  hash = hash_array(data.dependencies, hash);
  hash = hash_array(data.faces, hash);
  hash = hash_array(data.died, hash);
  hash = hash_array(data.removed_faces, hash);
  hash = hash_array(data.boxes, hash);
  return hash_array(data.cylinders, hash);
}

}  // namespace occlod::bench
