#include "cells/cell_divider.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "cells/cell_grid.h"

namespace occlod {
namespace {

// The recursion of divide_cell().
class Division {
 public:
  Division(const CellTreeOptions& options, const std::function<CellContent(const CellBox&)>& content_of,
           const std::function<void(double)>& done)
      : options_(options), content_of_(content_of), done_(done) {}

  [[nodiscard]] CellSubtree tree_of(CellContent cell, std::uint32_t level, double share) const {
    std::vector<CellContent> parts = parts_worth_having(cell.node, level);
    if (parts.empty()) {
      done_(share);
      return leaf_of_tree(cell.node, std::move(cell.sets));
    }
    cell.sets = {};  // frees its memory
    std::vector<CellSubtree> trees;
    for (CellContent& part : parts)
      trees.push_back(tree_of(std::move(part), level + 1, share / static_cast<double>(parts.size())));
    return join(std::move(trees));
  }

 private:
  [[nodiscard]] std::vector<CellContent> parts_worth_having(const CellNode& cell, std::uint32_t level) const {
    if (cell.drawn_triangles <= options_.most_triangles || level >= options_.levels) return {};
    const std::vector<CellBox> boxes = parts_of(cell.box, options_.smallest_cell);
    if (boxes.size() == 1) return {};
    std::vector<CellContent> parts;
    std::vector<std::size_t> drawn;
    for (const CellBox& box : boxes) drawn.push_back(parts.emplace_back(content_of_(box)).node.drawn_triangles);
    if (!is_worth_dividing(options_, cell.drawn_triangles, drawn)) return {};
    return parts;
  }

  const CellTreeOptions& options_;
  const std::function<CellContent(const CellBox&)>& content_of_;
  const std::function<void(double)>& done_;
};

}  // namespace

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

CellSubtree divide_cell(const CellTreeOptions& options, CellContent root,
                        const std::function<CellContent(const CellBox&)>& content_of,
                        const std::function<void(double)>& done) {
  return Division(options, content_of, done).tree_of(std::move(root), 0, 1.0);
}

CellSubtree CellDivider::divide(const CellBox& root, const std::function<void(double share)>& done) {
  return divide_cell(
      *options_, content_of(root), [this](const CellBox& box) { return content_of(box); }, done);
}

CellContent CellDivider::content_of(const CellBox& box) {
  const CellCut& cut = builder_.build(box);
  ++cuts_;
  CellContent cell;
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

}  // namespace occlod
