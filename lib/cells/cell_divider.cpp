#include "cells/cell_divider.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

#include "cells/cell_geometry.h"
#include "cells/vlod_format.h"
#include "cells/vlod_payload.h"
#include "mesh/section_file.h"
#include "occlod/base.h"

namespace occlod {
namespace {

constexpr unsigned hilbert_bits = 21;
constexpr double max_root_cells = 1U << 24U;

double edge(const CellBox& box, int axis) { return box.max[axis] - box.min[axis]; }

// Returns the i-th of n + 1 planes that cut the box into n parts.
double plane(const CellBox& box, int axis, std::uint32_t i, std::uint32_t n) {
  return i == n ? box.max[axis] : box.min[axis] + edge(box, axis) * (static_cast<double>(i) / n);
}

std::array<std::uint32_t, 3> counts_of(const CellBox& region, double root_cell) {
  std::array<double, 3> counts{};
  for (int axis = 0; axis < 3; ++axis)  // rounding must not add cells
    counts[static_cast<std::size_t>(axis)] = std::max(1.0, std::ceil(edge(region, axis) / root_cell - 1e-9));
  if (!(counts[0] * counts[1] * counts[2] <= max_root_cells) ||
      *std::max_element(counts.begin(), counts.end()) > static_cast<double>(1U << hilbert_bits))
    throw Error({"cell options", "root_cell",
                 fmt::format("{} cuts a region into more than {} cells", root_cell, max_root_cells),
                 "make root cells larger, or the region smaller"});
  return {static_cast<std::uint32_t>(counts[0]), static_cast<std::uint32_t>(counts[1]),
          static_cast<std::uint32_t>(counts[2])};
}

}  // namespace

std::uint64_t hilbert_index(std::array<std::uint32_t, 3> x) {
  constexpr std::uint32_t top = 1U << (hilbert_bits - 1);
  for (std::uint32_t q = top; q > 1; q >>= 1U) {
    const std::uint32_t p = q - 1;
    for (std::uint32_t& axis : x) {
      if ((axis & q) != 0) {
        x[0] ^= p;
      } else {
        const std::uint32_t t = (x[0] ^ axis) & p;
        x[0] ^= t;
        axis ^= t;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t t = 0;
  for (std::uint32_t q = top; q > 1; q >>= 1U)
    if ((x[2] & q) != 0) t ^= q - 1;
  std::uint64_t index = 0;
  for (unsigned bit = hilbert_bits; bit-- > 0;)
    for (const std::uint32_t axis : x) index = index << 1U | (((axis ^ t) >> bit) & 1U);
  return index;
}

std::vector<RootCell> root_cells(const CellTreeOptions& options) {
  std::vector<RootCell> cells;
  for (std::uint32_t r = 0; r < options.regions.size(); ++r) {
    const CellBox& region = options.regions[r];
    const auto [nx, ny, nz] = counts_of(region, options.root_cell);
    const std::size_t first = cells.size();
    for (std::uint32_t z = 0; z < nz; ++z)
      for (std::uint32_t y = 0; y < ny; ++y)
        for (std::uint32_t x = 0; x < nx; ++x)
          cells.push_back({{{plane(region, 0, x, nx), plane(region, 1, y, ny), plane(region, 2, z, nz)},
                            {plane(region, 0, x + 1, nx), plane(region, 1, y + 1, ny), plane(region, 2, z + 1, nz)}},
                           r,
                           {x, y, z}});
    if (static_cast<double>(cells.size()) > max_root_cells)
      throw Error({"cell options", "regions", fmt::format("have more than {} root cells", max_root_cells),
                   "make root cells larger"});
    std::sort(cells.begin() + static_cast<std::ptrdiff_t>(first), cells.end(),
              [](const RootCell& a, const RootCell& b) { return hilbert_index(a.place) < hilbert_index(b.place); });
  }
  return cells;
}

std::vector<CellBox> parts_of(const CellBox& box, double smallest) {
  constexpr double long_enough = 0.7;  // as a share of the longest axis
  const double longest = std::max({edge(box, 0), edge(box, 1), edge(box, 2)});
  std::vector<CellBox> parts = {box};
  for (int axis = 2; axis >= 0; --axis) {
    const double half = 0.5 * edge(box, axis);
    if (!(edge(box, axis) > long_enough * longest) || half < smallest) continue;
    const double middle = box.min[axis] + half;
    std::vector<CellBox> halves;
    for (const CellBox& part : parts) {
      halves.push_back(part);
      halves.back().max[axis] = middle;
      halves.push_back(part);
      halves.back().min[axis] = middle;
    }
    parts = std::move(halves);
  }
  return parts;
}

namespace {

using Set = std::vector<std::uint64_t>;

template <typename Operation>
Set combined(const Set& a, const Set& b, const Operation& operation) {
  Set result;
  operation(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
  return result;
}
constexpr auto in_both = [](auto... args) { std::set_intersection(args...); };
constexpr auto in_either = [](auto... args) { std::set_union(args...); };
constexpr auto not_in = [](auto... args) { std::set_difference(args...); };

// Joins the sets of all parts into those of one tree.
CellSets joined_sets(std::span<const CellSubtree> parts) {
  CellSets sets = parts.front().sets;
  sets.candidates.clear();
  for (const CellSubtree& part : parts.subspan(1)) {
    sets.splits = combined(sets.splits, part.sets.splits, in_both);
    sets.candidates = combined(sets.candidates, combined(sets.used, part.sets.used, in_both), in_either);
    sets.used = combined(sets.used, part.sets.used, in_either);
    sets.hidden = combined(sets.hidden, part.sets.hidden, in_either);
    sets.drawn = combined(sets.drawn, part.sets.drawn, in_either);
  }
  sets.candidates = combined(sets.candidates, sets.splits, not_in);
  sets.hidden = combined(sets.hidden, sets.drawn, not_in);
  return sets;
}

// Appends to the payloads what the root of a tree adds beyond the nodes above it.
void add_payload(CellSubtree& tree, const CellSets& above) {
  const vlod::Additions additions{combined(tree.sets.splits, above.splits, not_in), std::move(tree.sets.candidates),
                                  combined(tree.sets.hidden, above.hidden, not_in)};
  const std::vector<std::byte> bytes = vlod::encode(additions, above.candidates, vlod::max_ids_per_byte);
  CellNode& root = tree.nodes.front();
  if (bytes.size() > vlod::max_payload_bytes)
    throw Error({"cells", "", "one of them adds more than 16 MiB", "allow a larger tolerance"});
  root.payload = tree.payloads.size();
  root.payload_bytes = static_cast<std::uint32_t>(bytes.size());
  root.checksum = sections::checksum_of(bytes);
  root.splits = static_cast<std::uint32_t>(additions.splits.size());
  root.candidates = static_cast<std::uint32_t>(additions.candidates.size());
  root.hidden_faces = static_cast<std::uint32_t>(additions.hidden.size());
  tree.payloads.insert(tree.payloads.end(), bytes.begin(), bytes.end());
}

// Appends `part` as a child of the first node of `tree`.
void append(CellSubtree& tree, CellSubtree part) {
  const auto first = static_cast<CellId>(tree.nodes.size());
  for (CellNode& node : part.nodes) {
    node.parent = node.parent == no_id ? 0 : node.parent + first;
    node.end += first;
    node.payload += tree.payloads.size();
    tree.nodes.push_back(node);
  }
  tree.payloads.insert(tree.payloads.end(), part.payloads.begin(), part.payloads.end());
  tree.nodes.front().box = unite(tree.nodes.front().box, part.nodes.front().box);
  tree.nodes.front().end = static_cast<CellId>(tree.nodes.size());
}

}  // namespace

CellSubtree leaf_of_tree(const CellNode& node, CellSets sets) {
  CellSubtree tree{{node}, {}, std::move(sets)};
  tree.nodes.front().parent = no_id;
  tree.nodes.front().end = 1;
  tree.sets.used = tree.sets.splits;
  return tree;
}

CellSubtree join(std::vector<CellSubtree> parts) {
  CellSubtree tree{{CellNode{}}, {}, joined_sets(parts)};
  tree.nodes.front().box = parts.front().nodes.front().box;
  for (CellSubtree& part : parts) {
    add_payload(part, tree.sets);
    append(tree, std::exchange(part, {}));
  }
  return tree;
}

void set_levels(CellSubtree& tree) {
  for (CellNode& node : tree.nodes) node.level = node.parent == no_id ? 0 : tree.nodes[node.parent].level + 1;
}

void finish(CellSubtree& tree) {
  add_payload(tree, {});
  set_levels(tree);
  // Stores payloads in the order of the nodes, whatever order the tree has grown in.
  std::vector<std::byte> payloads;
  payloads.reserve(tree.payloads.size());
  for (CellNode& node : tree.nodes) {
    const auto bytes = std::span(tree.payloads).subspan(node.payload, node.payload_bytes);
    node.payload = payloads.size();
    payloads.insert(payloads.end(), bytes.begin(), bytes.end());
  }
  tree.payloads = std::move(payloads);
}

namespace {

// Implements the recursion of divide_cell().
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
    if (cell.drawn_triangles <= options_.max_triangles || level >= vlod::max_cell_levels) return {};
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
  // The parts have equal volumes, so an eye is equally likely in each.
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

namespace {

constexpr unsigned regions_level = 22;  // above blocks of 2^21 root cells along each axis

// Returns whether two root cells are in one block of 2^level root cells along each axis.
bool together(const RootCell& a, const RootCell& b, unsigned level) {
  if (level >= regions_level) return true;
  bool same = a.region == b.region;
  for (std::size_t axis = 0; axis < 3; ++axis) same = same && a.place[axis] >> level == b.place[axis] >> level;
  return same;
}

// Joins roots [first, end), which are in one block at this level.
CellSubtree join_block(std::span<const RootCell> roots, std::size_t first, std::size_t end, unsigned level,
                       const std::function<CellSubtree(std::size_t)>& take) {
  if (end - first == 1) return take(first);
  std::vector<CellSubtree> parts;
  for (std::size_t begin = first; begin < end;) {
    std::size_t next = begin + 1;
    while (next < end && together(roots[begin], roots[next], level - 1)) ++next;
    parts.push_back(join_block(roots, begin, next, level - 1, take));
    begin = next;
  }
  return parts.size() == 1 ? std::move(parts.front()) : join(std::move(parts));
}

}  // namespace

CellSubtree join_roots(std::span<const RootCell> roots, const std::function<CellSubtree(std::size_t)>& take) {
  return join_block(roots, 0, roots.size(), regions_level, take);
}

}  // namespace occlod
