#include "occlod/refine/refiner.h"

namespace occlod {

std::uint64_t Refinement::hash() const noexcept {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  const auto add = [&](std::uint64_t value) { hash = (hash ^ value) * 0x100000001b3ULL; };
  for (const RefinedObject& object : objects) {
    add(object.triangles.size());
    for (const Triangle& t : object.triangles)
      for (int k = 0; k < 3; ++k) add(t[k]);
  }
  return hash;
}

}  // namespace occlod
