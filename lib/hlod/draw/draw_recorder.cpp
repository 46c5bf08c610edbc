#include "hlod/draw/draw_recorder.h"

#include <xxhash.h>

#include <algorithm>
#include <array>

namespace occlod::hlod {

// Neighbouring patches become one range where they morph alike. A sum of hashes does not depend on the order of draws.
void DrawRecorder::add(NodeRef n, const Patch& patch, std::uint32_t place) {
  const DrawRange range{patch.first_index, patch.index_count, morph(n, patch.parent)};
  std::vector<DrawRange>& ranges = frame_.ranges;
  const bool goes_on = ranges.size() > first_range_ && ranges.back().morph == range.morph &&
                       ranges.back().first_index + ranges.back().index_count == range.first_index;
  if (goes_on)
    ranges.back().index_count += range.index_count;
  else
    ranges.push_back(range);
  const std::array<std::uint32_t, 3> key{n.object, n.node, place};
  frame_.front_hash += XXH3_64bits(key.data(), sizeof(key));
  ++frame_.stats.drawn_patches;
  frame_.stats.drawn_triangles += patch.index_count / 3;
}

void DrawRecorder::submit(NodeRef n, bool first) {
  const std::span<const DrawRange> ranges = std::span(frame_.ranges).subspan(first_range_);
  frame_.draws.push_back(
      {n.object, n.node, static_cast<std::uint32_t>(first_range_), static_cast<std::uint32_t>(ranges.size())});
  if (first) ++frame_.stats.drawn_nodes;
  frame_.stats.largest_sse_px = std::max(frame_.stats.largest_sse_px, scene_.error_px(n));
  device_.draw({n.object, n.node, ranges, {}, 0});
}

bool DrawRecorder::draw_cut(NodeRef n, bool first, double most_error) {
  const NodeCut& cut = cuts_.get(scene_.hlod(n), n.node, most_error);
  if (cut.splits == 0) return false;
  submit_cut(n, first, cut);
  return true;
}

bool DrawRecorder::draw_finer_cut(NodeRef n, double most_error, double drawn_error) {
  const std::uint32_t drawn = cuts_.get(scene_.hlod(n), n.node, drawn_error).splits;
  const NodeCut& cut = cuts_.get(scene_.hlod(n), n.node, most_error);
  if (cut.splits <= drawn) return false;
  submit_cut(n, false, cut);
  return true;
}

void DrawRecorder::submit_cut(NodeRef n, bool first, const NodeCut& cut) {
  if (cut.indices.empty()) return;  // everything has vanished
  FrameStats& stats = frame_.stats;
  frame_.draws.push_back(
      {n.object, n.node, static_cast<std::uint32_t>(frame_.ranges.size()), 0, 1.0F, cut.indices, cut.splits});
  const std::array<std::uint32_t, 3> key{n.object, n.node, no_id - cut.splits};
  frame_.front_hash += XXH3_64bits(key.data(), sizeof(key));
  if (first) {
    ++stats.drawn_nodes;
    ++stats.cut_nodes;
  }
  stats.drawn_triangles += cut.indices.size() / 3;
  stats.largest_sse_px = std::max(stats.largest_sse_px, scene_.cut_error_px(n, cut.splits));
  device_.draw({n.object, n.node, {}, cut.indices, cut.splits});
}

// From as in the parent, where its error is the tolerance, to as they are, where it is twice that.
float DrawRecorder::morph(NodeRef n, NodeId parent) const {
  const TraverseOptions& options = scene_.options();
  if (!options.geomorph || parent == no_id || !(options.tolerance_px > 0.0)) return 0.0F;
  const double error = scene_.error_px({n.object, parent});
  return static_cast<float>(std::clamp(2.0 - error / options.tolerance_px, 0.0, 1.0));
}

}  // namespace occlod::hlod
