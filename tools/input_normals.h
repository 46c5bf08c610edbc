// Smooth normals of the input of HLODs, for the vertices of all their nodes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/device.h"

namespace occlod::tool {

class InputNormals {
 public:
  // Takes the triangles of level 0: the normal at a point is the mean of those of all triangles that have a corner
  // there, weighted by area. A vertex of a coarser node that has moved has that of the nearest vertex that slides to
  // it. O(vertices + triangles). Throws Error when a mapped file is damaged.
  explicit InputNormals(std::span<const hlod::PlacedHlod> placed);

  // Returns the normal at a vertex of one of the HLODs: unit length, object space. Returns zero where no node has a
  // vertex, or triangles there cancel out. O(1).
  [[nodiscard]] glm::dvec3 at(std::size_t object, const glm::vec3& position) const;

 private:
  // A hash table of the vertices of one HLOD.
  class Table {
   public:
    // Adds all levels.
    explicit Table(const hlod::Hlod& hlod);
    // Returns the sum over triangles, twice their area long; null at no vertex.
    [[nodiscard]] const glm::vec3* find(const glm::vec3& position) const;

   private:
    void add_corners(const hlod::Hlod& hlod, hlod::NodeId n);
    void add_moved(const hlod::Hlod& hlod, const hlod::Level& level);
    struct Entry {
      glm::vec3 position;
      glm::vec3 normal;
      float distance2 = 0.0F;  // of where the normal is from
    };
    // Returns the entry of the position, a new one where there is none.
    Entry& at(const glm::vec3& position);
    [[nodiscard]] std::size_t slot(const glm::vec3& position) const;
    std::vector<Entry> entries_;
    std::vector<std::uint32_t> slots_;  // a power of two; entry + 1, or 0 for none
  };
  std::vector<Table> tables_;  // per object
};

}  // namespace occlod::tool
