#include "hlod/store/ohlod_format.h"

#include <algorithm>

#include "hlod/store/hlod_data.h"

namespace occlod::ohlod {
namespace {

std::uint64_t digest_of(std::span<const std::byte> all, std::uint64_t place, std::size_t bytes) {
  return sections::checksum_of(all.subspan(place, std::min(hlod::align_mesh(bytes), all.size() - place)));
}

}  // namespace

std::uint64_t digest_of_mesh(const hlod::HlodView& view, hlod::NodeId n) {
  const hlod::Node& node = view.nodes[n];
  return digest_of(view.meshes, node.mesh, hlod::MeshLayout(node, hlod::arrays_of(view)).bytes);
}

std::uint64_t digest_of_splits(const hlod::HlodView& view, hlod::NodeId n) {
  const hlod::NodeWithin& within = view.within[n];
  return digest_of(view.splits, within.place, hlod::SplitsLayout(within, hlod::arrays_of(view)).bytes);
}

}  // namespace occlod::ohlod
