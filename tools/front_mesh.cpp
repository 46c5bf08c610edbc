#include "front_mesh.h"

#include <numeric>

#include "device/morphed_positions.h"

namespace occlod::tool {
namespace {

std::size_t index_count(const Front& front) {
  return std::transform_reduce(front.ranges.begin(), front.ranges.end(), std::size_t{0}, std::plus<>(),
                               [](const hlod::DrawRange& range) { return std::size_t{range.index_count}; });
}

}  // namespace

Front front_of(const hlod::Frame& frame) { return {frame.draws, frame.ranges}; }

Front full_front(std::span<const hlod::PlacedHlod> placed, const View& view) {
  Front front;
  for (std::uint32_t object = 0; object < placed.size(); ++object) {
    const hlod::Hlod& hlod = *placed[object].hlod;
    const ObjectView in_object(view, placed[object].object_to_world);
    const hlod::Level& finest = hlod.data().levels[0];
    for (hlod::NodeId n = finest.first_node; n < finest.first_node + finest.node_count; ++n) {
      const hlod::Node& node = hlod.node(n);
      if (node.triangles == 0 || !in_object.may_be_inside(node.sphere)) continue;
      front.draws.push_back({object, n, static_cast<std::uint32_t>(front.ranges.size()), 1});
      front.ranges.push_back({0, 3 * node.triangles, 0.0F});
    }
  }
  return front;
}

void FrontMesh::assign(const Front& front, std::span<const hlod::PlacedHlod> placed) {
  objects_.clear();
  triangles_.clear();
  triangles_.reserve(index_count(front) / 3);  // so that spans into them stay where they are
  positions_.resize(front.draws.size());
  for (const hlod::DrawnNode& draw : front.draws)
    append(draw, std::span(front.ranges).subspan(draw.first_range, draw.range_count), placed[draw.object]);
}

void FrontMesh::append(const hlod::DrawnNode& draw, std::span<const hlod::DrawRange> ranges,
                       const hlod::PlacedHlod& placed) {
  const hlod::Hlod& hlod = *placed.hlod;
  const auto positions = hlod::morphed_positions(hlod, draw.node, ranges, positions_[objects_.size()]);
  const hlod::NodeMesh mesh = hlod.mesh(draw.node);
  const std::size_t first = triangles_.size();
  for (const hlod::DrawRange& range : ranges) {
    const auto indices = mesh.indices.subspan(range.first_index, range.index_count);
    for (std::size_t i = 0; i < indices.size(); i += 3)
      triangles_.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
  }
  objects_.push_back({positions, mesh.colors, std::span(triangles_).subspan(first), placed.object_to_world});
}

}  // namespace occlod::tool
