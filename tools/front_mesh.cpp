#include "front_mesh.h"

#include <numeric>

#include "hlod/draw/morphed_positions.h"

namespace occlod::tool {
namespace {

std::size_t index_count(const Front& front) {
  return std::transform_reduce(front.ranges.begin(), front.ranges.end(), std::size_t{0}, std::plus<>(),
                               [](const hlod::DrawRange& range) { return std::size_t{range.index_count}; });
}

template <typename T>
void assign_both(std::vector<T>& to, std::span<const T> first, std::span<const T> second) {
  to.assign(first.begin(), first.end());
  to.insert(to.end(), second.begin(), second.end());
}

}  // namespace

Front front_of(const hlod::Frame& frame) {
  Front front{frame.draws, frame.ranges};
  for (hlod::DrawnNode& draw : front.draws) draw.cut = {};
  return front;
}

Front full_front(std::span<const hlod::PlacedHlod> placed) {
  Front front;
  for (std::uint32_t object = 0; object < placed.size(); ++object) {
    const hlod::Hlod& hlod = *placed[object].hlod;
    const hlod::Level& finest = hlod.data().levels[0];
    for (hlod::NodeId n = finest.first_node; n < finest.first_node + finest.node_count; ++n) {
      const hlod::Node& node = hlod.node(n);
      if (node.triangles == 0) continue;
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
  triangles_.reserve(indices / 3);  // so that spans into it stay valid
  positions_.resize(front.draws.size());
  attributes_.resize(front.draws.size());
  laid_.clear();
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
  if (cut.splits == 0) {
    objects_.push_back({positions, mesh.colors, std::span(triangles_).subspan(first), placed.object_to_world});
    laid_.push_back({draw.object, draw.node, mesh.texture_coordinates, mesh.materials, mesh});
    return;
  }
  CutAttributes& attributes = attributes_[objects_.size()];
  const hlod::NodeSplits within = hlod.within(draw.node);
  assign_both(attributes.colors, mesh.colors, within.colors);
  assign_both(attributes.texture_coordinates, mesh.texture_coordinates, within.texture_coordinates);
  assign_both(attributes.materials, mesh.materials, within.materials);
  objects_.push_back({positions, attributes.colors, std::span(triangles_).subspan(first), placed.object_to_world});
  laid_.push_back({draw.object, draw.node, attributes.texture_coordinates, attributes.materials, mesh});
  laid_.back().mesh.image = {};
}

void FrontMesh::append_triangles(std::span<const std::uint16_t> indices) {
  for (std::size_t i = 0; i < indices.size(); i += 3)
    triangles_.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
}

}  // namespace occlod::tool
