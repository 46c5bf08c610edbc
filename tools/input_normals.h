// Smooth normals of the input of HLODs, which the vertices of all their nodes have: they are vertices of the input.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/device.h"

namespace occlod::tool {

class InputNormals {
 public:
  // Takes the triangles of level 0: the normal at a point is the mean of those of all triangles that have a corner
  // there, weighted by area. O(n log n) time for n vertices. Throws Error when a mapped file is damaged.
  explicit InputNormals(std::span<const hlod::PlacedHlod> placed);

  // Returns the normal at a vertex of an HLOD, which has one of `placed`: unit length, object space. Returns zero where
  // the input has no vertex, or its triangles there cancel out. O(log n).
  [[nodiscard]] glm::dvec3 at(std::size_t object, const glm::vec3& position) const;

 private:
  struct Entry {
    glm::vec3 position;
    glm::vec3 normal;  // sum over triangles, twice their area long
  };
  std::vector<std::vector<Entry>> entries_;  // per object, by position
};

}  // namespace occlod::tool
