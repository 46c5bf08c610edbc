// The features of a tile: ids of its vertices (EXT_mesh_features) and a table of their names (EXT_structural_metadata).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hlod/tiles/tile_mesh.h"
#include "mesh/glb.h"
#include "occlod/mesh.h"

namespace occlod::tiles {

// Their rows are those features that a tile may have.
class FeatureTable {
 public:
  // `tile` and `names`, those of the HLOD's features, outlive it. O(n).
  FeatureTable(const TileMesh& tile, std::span<const std::string> names);

  // Returns whether the tile has no features.
  [[nodiscard]] bool empty() const noexcept { return features_.empty(); }
  // Returns the row of the table for a vertex.
  [[nodiscard]] std::uint16_t row_of(WedgeId vertex) const { return static_cast<std::uint16_t>(rows_[vertex]); }
  // Describes the feature ids of a primitive with these vertices.
  [[nodiscard]] GlbDocument::Json described(std::span<const WedgeId> vertices) const;
  // Adds the table to the document, and its bytes to the end of the buffer. A row has the number of the feature, which
  // is the same in all tiles, and its name.
  void add_to(GlbDocument& document, std::string& buffer) const;

 private:
  std::span<const FeatureId> features_;  // by row
  std::vector<FeatureId> rows_;          // by vertex
  std::span<const std::string> names_;
};

}  // namespace occlod::tiles
