#include "ohlod_format.h"

#include <algorithm>

#include "hlod/hlod_data.h"

namespace occlod::ohlod {

std::uint64_t digest_of_mesh(const hlod::HlodView& view, hlod::NodeId n) {
  const hlod::Node& node = view.nodes[n];
  const std::size_t bytes = hlod::MeshLayout(node, view.has_normals, view.has_colors).bytes;
  const std::size_t aligned = (bytes + hlod::mesh_alignment - 1) / hlod::mesh_alignment * hlod::mesh_alignment;
  return sections::checksum_of(view.meshes.subspan(node.mesh, std::min(aligned, view.meshes.size() - node.mesh)));
}

}  // namespace occlod::ohlod
