#include "viewcells/cell_divider.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "viewcells/cell_grid.h"

namespace occlod {

bool is_worth_dividing(const CellTreeOptions& options, std::size_t drawn, std::span<const std::size_t> drawn_by_parts) {
  if (options.division == CellDivision::halving)
    return drawn > 2 * *std::min_element(drawn_by_parts.begin(), drawn_by_parts.end());
  // The parts are of one volume: an eye is as likely in each.
  const std::size_t sum = std::accumulate(drawn_by_parts.begin(), drawn_by_parts.end(), std::size_t{0});
  return 10 * sum < 9 * drawn * drawn_by_parts.size();
}

CellDivider::CellDivider(std::span<const RefineObject> objects, const CellOccluders* occluders,
                         const CellTreeOptions& options, const vlod::GlobalIds& ids)
    : objects_(objects.begin(), objects.end()),
      options_(&options),
      ids_(&ids),
      builder_(objects, occluders, options.cell),
      faces_(objects) {}

CellSubtree CellDivider::divide(const CellBox& root, const std::function<void(double share)>& done) {
  return divide(cut_of(root), 0, 1.0, done);
}

CellDivider::Cell CellDivider::cut_of(const CellBox& box) {
  const CellCut& cut = builder_.build(box);
  ++cuts_;
  Cell cell;
  cell.node.box = box;
  cell.node.triangles = static_cast<std::uint32_t>(cut.triangles);
  cell.node.drawn_triangles = static_cast<std::uint32_t>(cut.drawn_triangles);
  cell.node.error_px = static_cast<float>(cut.error_px);
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    const CellObjectCut& object = cut.objects[i];
    for (const SplitId s : object.applied) cell.sets.splits.push_back(ids_->split(i, s));
    faces_.set(i, object.applied);
    faces_.classify(i, CellView(box, options_->cell.eyes, objects_[i].object_to_world), object.triangles, drawn_,
                    hidden_);
    const auto id_of = [&](const FaceRef& face) { return ids_->owner(i, face.split) << 32U | face.slot; };
    for (const FaceRef& face : drawn_) cell.sets.drawn.push_back(id_of(face));
    for (const FaceRef& face : hidden_) cell.sets.hidden.push_back(id_of(face));
  }
  return cell;
}

CellSubtree CellDivider::divide(Cell cell, std::uint32_t level, double share,
                                const std::function<void(double share)>& done) {
  std::vector<Cell> parts;
  if (cell.node.drawn_triangles > options_->most_triangles && level < options_->levels) {
    const std::vector<CellBox> boxes = parts_of(cell.node.box, options_->smallest_cell);
    std::vector<std::size_t> drawn;
    if (boxes.size() > 1)
      for (const CellBox& box : boxes) drawn.push_back(parts.emplace_back(cut_of(box)).node.drawn_triangles);
    if (!drawn.empty() && !is_worth_dividing(*options_, cell.node.drawn_triangles, drawn)) parts.clear();
  }
  if (parts.empty()) {
    done(share);
    return leaf_of_tree(cell.node, std::move(cell.sets));
  }
  cell.sets = {};
  std::vector<CellSubtree> subtrees;
  for (Cell& part : parts)
    subtrees.push_back(divide(std::move(part), level + 1, share / static_cast<double>(parts.size()), done));
  return join(std::move(subtrees));
}

}  // namespace occlod
