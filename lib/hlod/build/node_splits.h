// From the collapses of a node to the splits that an HLOD stores.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hlod/store/hlod_data.h"
#include "hlod/build/level_draft.h"
#include "hlod/build/local_ids.h"
#include "hlod/store/wedge_mesh.h"

namespace occlod::hlod {

// The arrays of NodeSplits. All empty: none.
struct NodeSplitsData {
  std::vector<WedgeId> wedges;  // bare ones, then one for each split
  std::vector<float> errors;
  std::vector<std::uint16_t> indices, parents;
};

// Numbers the wedges of `draft`, those in the node's mesh (`own`) as they are there. `ids` is scratch memory.
// Expected O(n).
[[nodiscard]] NodeSplitsData number_splits(const SplitsDraft& draft, std::span<const WedgeId> own, LocalIds& ids);

// Lays the splits of all nodes out in `data`, whose nodes are complete. O(n).
void append_splits(const WedgeMesh& mesh, std::span<const NodeSplitsData> splits, HlodData& data);

// Writes the positions and attributes of wedges to `to`, where `layout` has them.
void copy_wedges(const WedgeMesh& mesh, std::span<const WedgeId> wedges, const VertexLayout& layout, std::byte* to);

}  // namespace occlod::hlod
