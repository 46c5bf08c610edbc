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

Front front_of(const hlod::Frame& frame) {
  Front front{frame.draws, frame.ranges};
  for (hlod::DrawnNode& draw : front.draws) draw.cut = {};
  return front;
}

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
  cuts_.assign(front.draws.size(), {});
  std::size_t indices = index_count(front);
  for (std::size_t i = 0; i < front.draws.size(); ++i) {
    const hlod::DrawnNode& draw = front.draws[i];
    if (draw.splits == 0) continue;
    const hlod::Hlod& hlod = *placed[draw.object].hlod;
    hlod.require_within(draw.node);
    cuts_[i] = cut_with_splits(hlod, draw.node, draw.splits);
    indices += cuts_[i].indices.size();
  }
  triangles_.reserve(indices / 3);  // so that spans into them stay where they are
  positions_.resize(front.draws.size());
  colors_.resize(front.draws.size());
  for (const hlod::DrawnNode& draw : front.draws)
    append(draw, std::span(front.ranges).subspan(draw.first_range, draw.range_count), placed[draw.object]);
}

void FrontMesh::append(const hlod::DrawnNode& draw, std::span<const hlod::DrawRange> ranges,
                       const hlod::PlacedHlod& placed) {
  const hlod::Hlod& hlod = *placed.hlod;
  const hlod::NodeCut& cut = cuts_[objects_.size()];
  std::vector<glm::vec3>& scratch = positions_[objects_.size()];
  const auto positions = cut.splits > 0 ? hlod::cut_positions(hlod, draw.node, scratch)
                                        : hlod::morphed_positions(hlod, draw.node, ranges, scratch);
  const hlod::NodeMesh mesh = hlod.mesh(draw.node);
  const std::size_t first = triangles_.size();
  append_triangles(cut.indices);
  for (const hlod::DrawRange& range : ranges)
    append_triangles(mesh.indices.subspan(range.first_index, range.index_count));
  const auto colors = cut.splits > 0 ? colors_of_cut(hlod, draw.node) : mesh.colors;
  objects_.push_back({positions, colors, std::span(triangles_).subspan(first), placed.object_to_world});
}

std::span<const glm::u8vec4> FrontMesh::colors_of_cut(const hlod::Hlod& hlod, hlod::NodeId node) {
  std::vector<glm::u8vec4>& colors = colors_[objects_.size()];
  const auto own = hlod.mesh(node).colors, more = hlod.within(node).colors;
  colors.assign(own.begin(), own.end());
  colors.insert(colors.end(), more.begin(), more.end());
  return colors;
}

void FrontMesh::append_triangles(std::span<const std::uint16_t> indices) {
  for (std::size_t i = 0; i < indices.size(); i += 3)
    triangles_.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
}

}  // namespace occlod::tool
