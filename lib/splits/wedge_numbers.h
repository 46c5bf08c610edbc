// The wedges of a hierarchy: the input's, and those that collapses across seams add.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "splits/hierarchy_data.h"
#include "occlod/mesh/triangle_mesh.h"
#include "splits/simplify.h"

namespace occlod {

// Numbers pairs of a vertex and a wedge of the input whose attributes it has. Vertices as in the hierarchy, wedges as
// in the mesh.
class WedgeNumbers {
 public:
  // `new_ids`: by vertex of the mesh its number in the hierarchy. Both outlive it, and so does the sequence. O(n log
  // n).
  WedgeNumbers(const TriangleMesh& mesh, const CollapseSequence& sequence, std::span<const VertexId> new_ids);

  // The new number of a wedge at a corner of this vertex of the mesh. O(log n).
  [[nodiscard]] WedgeId operator()(VertexId vertex, WedgeId wedge) const;
  [[nodiscard]] Triangle operator()(const Triangle& vertices, const Triangle& wedges) const;

  // Attributes and materials of all wedges.
  void copy_attributes(HierarchyData& data) const;

 private:
  struct Extra {
    VertexId vertex;  // of the hierarchy
    WedgeId wedge;    // of the mesh
    friend bool operator==(const Extra&, const Extra&) = default;
    friend bool operator<(const Extra& a, const Extra& b) {
      return a.vertex != b.vertex ? a.vertex < b.vertex : a.wedge < b.wedge;
    }
  };
  void add(VertexId vertex, WedgeId wedge);

  const TriangleMesh& mesh_;
  std::span<const VertexId> new_ids_;
  std::vector<Extra> extras_;  // ascending
};

}  // namespace occlod
