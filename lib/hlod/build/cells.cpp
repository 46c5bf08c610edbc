#include "hlod/build/cells.h"

#include <algorithm>

#include "splits/parallel.h"
#include "splits/sort_by_key.h"
#include "hlod/build/octree_grid.h"

namespace occlod::hlod {
namespace {

constexpr unsigned key_bits = 30;  // of the codes, the highest

class CellMaker {
 public:
  CellMaker(std::span<const std::uint64_t> codes, std::uint32_t most_items, std::span<const std::uint32_t> unit_of,
            unsigned threads)
      : codes_(codes), most_items_(most_items), unit_of_(unit_of) {
    sort(threads);
  }

  Cells run() {
    split(0, static_cast<std::uint32_t>(cells_.order.size()), 0);
    cells_.first_item.push_back(static_cast<std::uint32_t>(cells_.order.size()));
    return std::move(cells_);
  }

 private:
  void sort(unsigned threads) {
    UninitializedVector<Keyed> keyed(codes_.size());
    for_each_id(codes_.size(), threads, [&](std::uint32_t i) {
      keyed[i] = {static_cast<std::uint32_t>(codes_[i] >> (3 * OctreeGrid::depth - key_bits)), i};
    });
    sort_by_key(keyed, key_bits, threads);
    cells_.order.resize(codes_.size());
    for_each_id(codes_.size(), threads, [&](std::uint32_t i) { cells_.order[i] = keyed[i].item; });
  }

  // Items [begin, end) of the order are those of one cell.
  void split(std::uint32_t begin, std::uint32_t end, unsigned depth) {
    if (begin == end) return;
    if (end - begin <= most_items_) return add_leaf(begin);
    if (3 * depth == key_bits) sort_further(begin, end);
    if (depth == OctreeGrid::depth) return cut(begin, end);
    const auto first_leaf = static_cast<std::uint32_t>(cells_.first_item.size());
    for (unsigned octant = 0; octant < 8; ++octant) {
      const auto in_octant = [&](std::uint32_t item) { return OctreeGrid::octant(codes_[item], depth + 1) <= octant; };
      const auto next = std::partition_point(cells_.order.begin() + begin, cells_.order.begin() + end, in_octant);
      const auto after = static_cast<std::uint32_t>(next - cells_.order.begin());
      split(begin, after, depth + 1);
      begin = after;
    }
    cells_.inner.push_back({first_leaf, static_cast<std::uint32_t>(cells_.first_item.size())});
  }

  // The keys are used up.
  void sort_further(std::uint32_t begin, std::uint32_t end) {
    std::sort(cells_.order.begin() + begin, cells_.order.begin() + end,
              [&](std::uint32_t a, std::uint32_t b) { return codes_[a] != codes_[b] ? codes_[a] < codes_[b] : a < b; });
  }

  // Items that no cell separates.
  void cut(std::uint32_t begin, std::uint32_t end) {
    const auto first_leaf = static_cast<std::uint32_t>(cells_.first_item.size());
    while (begin < end) {
      add_leaf(begin);
      std::uint32_t next = std::min(end, begin + most_items_);
      if (next < end && !unit_of_.empty()) {
        std::uint32_t unit_begin = next;
        while (unit_begin > begin && unit(unit_begin - 1) == unit(next)) --unit_begin;
        if (unit_begin > begin) next = unit_begin;
      }
      begin = next;
    }
    cells_.inner.push_back({first_leaf, static_cast<std::uint32_t>(cells_.first_item.size())});
  }

  [[nodiscard]] std::uint32_t unit(std::uint32_t place) const { return unit_of_[cells_.order[place]]; }
  void add_leaf(std::uint32_t begin) { cells_.first_item.push_back(begin); }

  std::span<const std::uint64_t> codes_;
  std::uint32_t most_items_;
  std::span<const std::uint32_t> unit_of_;
  Cells cells_;
};

}  // namespace

Cells make_cells(std::span<const std::uint64_t> codes, std::uint32_t most_items, std::span<const std::uint32_t> unit_of,
                 unsigned threads) {
  return CellMaker(codes, most_items, unit_of, threads).run();
}

}  // namespace occlod::hlod
