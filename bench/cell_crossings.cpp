// bench_cell_crossings FILE...: what is read when the eye goes from a cell to the next, in .vlod files as built and
// packed, beside neighbours' deltas in the code of vLOD (2003). One row of CSV for each file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "cells/packed_geometry.h"
#include "cells/vlod_format.h"
#include "cells/vlod_payload.h"
#include "occlod/vlod_file.h"
#include "papers/delimiter_code.h"
#include "papers/id_lists.h"

namespace occlod::bench {
namespace {

using paper::Ids;

std::size_t whole_bytes(std::size_t bits) { return (bits + 7) / 8; }

// The delimiter code of gaps, or of runs where that is shorter.
std::size_t paper_bits(const Ids& list) {
  return std::min(paper::encode_delimited(paper::gaps_of(list)).size(),
                  paper::encode_delimited(paper::runs_of(list)).size());
}

// The tree of a file without hidden faces: the splits alone.
class SplitsOf {
 public:
  explicit SplitsOf(const VlodFile& file) : file_(file), ids_(file.objects(), "the file") {
    const std::size_t count = file.tree().nodes().size();
    bytes_.resize(count);
    cells_.resize(count);
    frames_.resize(count);
    read_below(0, {}, {});
  }

  // Bytes of the splits that a node adds, as a file has them.
  [[nodiscard]] std::size_t bytes(CellId cell) const { return bytes_[cell]; }
  // All that a leaf applies, by the numbers of the file.
  [[nodiscard]] const Ids& cell(CellId leaf) const { return cells_[leaf]; }
  // Of a packed file those that a leaf needs.
  [[nodiscard]] const Ids& frames(CellId leaf) const { return frames_[leaf]; }
  [[nodiscard]] std::size_t ids() const { return added_; }
  [[nodiscard]] std::size_t paper_bits_of_tree() const { return paper_bits_; }

 private:
  void read_below(CellId cell, std::vector<const CellAdditions*> above, Ids applied) {
    const CellAdditions additions = file_.read(cell, above);
    vlod::Additions splits;
    std::vector<std::uint64_t> known;
    if (!above.empty()) known.assign(above.back()->candidates.begin(), above.back()->candidates.end());
    for (const ObjectAdditions& object : additions.objects)
      for (const SplitId s : object.splits) splits.splits.push_back(ids_.split(object.object, s));
    splits.candidates.assign(additions.candidates.begin(), additions.candidates.end());
    bytes_[cell] =
        vlod::encode(splits, known, file_.is_packed() ? vlod::max_packed_ids_per_byte : vlod::max_ids_per_byte).size();
    const Ids list(splits.splits.begin(), splits.splits.end());
    added_ += list.size();
    if (!list.empty()) paper_bits_ += paper_bits(list);
    applied.insert(applied.end(), list.begin(), list.end());
    above.push_back(&additions);
    if (file_.tree().is_leaf(cell)) {
      std::sort(applied.begin(), applied.end());
      if (file_.is_packed()) frames_[cell] = frames_of(applied);
      cells_[cell] = std::move(applied);
      return;
    }
    for (CellId child = cell + 1; child < file_.tree().node(cell).end; child = file_.tree().node(child).end)
      read_below(child, above, applied);
  }

  [[nodiscard]] Ids frames_of(const Ids& applied) const {
    Ids frames;
    for (const std::uint32_t id : applied) {
      const vlod::GlobalIds::Place place = ids_.place_of_split(id);
      frames.push_back(file_.geometry()->piece_of(file_.geometry()->mesh_of(place.object), place.split).frame);
    }
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    return frames;
  }

  const VlodFile& file_;
  vlod::GlobalIds ids_;
  std::vector<std::size_t> bytes_;
  std::vector<Ids> cells_, frames_;
  std::size_t added_ = 0, paper_bits_ = 0;
};

// Sums over all crossings, there and back.
struct Crossings {
  std::size_t count = 0, deltas = 0, tree = 0, added = 0, frames = 0, reads = 0;
};

Crossings crossings_of(const VlodFile& file, const SplitsOf& splits) {
  const CellTree& tree = file.tree();
  Crossings sum;
  std::vector<CellId> neighbours;
  for (CellId from = 0; from < tree.nodes().size(); ++from) {
    if (!tree.is_leaf(from)) continue;
    tree.neighbours(from, neighbours);
    for (const CellId to : neighbours) {
      ++sum.count;
      const paper::Delta delta = paper::delta(splits.cell(from), splits.cell(to));
      for (const Ids* list : {&delta.added, &delta.removed})
        if (!list->empty()) sum.deltas += whole_bytes(paper_bits(*list));
      sum.added += delta.added.size();
      for (CellId n = to; n != no_id && !(n <= from && from < tree.node(n).end); n = tree.node(n).parent)
        sum.tree += splits.bytes(n);
      const Ids frames = paper::delta(splits.frames(from), splits.frames(to)).added;
      for (const std::uint32_t frame : frames) sum.frames += file.geometry()->frames()[frame].bytes;
      sum.reads += frames.size();
    }
  }
  return sum;
}

void print_row(const std::filesystem::path& path) {
  const auto file = open_vlod(path);
  const SplitsOf splits(*file);
  const Crossings sum = crossings_of(*file, splits);
  std::size_t tree_bytes = 0;
  for (CellId n = 0; n < file->tree().nodes().size(); ++n) tree_bytes += splits.bytes(n);
  const PackedCounts packed = file->packed_counts();
  const auto ratio = [](std::size_t a, std::size_t b) {
    return b == 0 ? 0.0 : static_cast<double>(a) / static_cast<double>(b);
  };
  const double split_bytes = ratio(packed.bytes, packed.splits);
  fmt::print("{},{},{},{},{:.0f},{:.0f},{:.3f},{},{:.3f},{:.3f},{:.3f},{:.1f},{:.0f},{:.0f},{:.0f},{:.1f}\n",
             path.stem().string(), file->is_packed() ? "packed" : "as built", file->tree().leaf_count(), sum.count,
             ratio(sum.deltas, sum.count), ratio(sum.tree, sum.count), ratio(sum.tree, sum.deltas), splits.ids(),
             8.0 * ratio(tree_bytes, splits.ids()), ratio(splits.paper_bits_of_tree(), splits.ids()),
             ratio(8 * tree_bytes, splits.paper_bits_of_tree()), split_bytes, ratio(sum.added, sum.count),
             ratio(sum.added, sum.count) * split_bytes, ratio(sum.frames, sum.count), ratio(sum.reads, sum.count));
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) try {
  CLI::App app("Bytes a crossing of .vlod files, beside neighbours' deltas in the code of vLOD (2003).");
  std::vector<std::filesystem::path> files;
  app.add_option("FILE", files, "Files of view cells, as built or packed")->required();
  CLI11_PARSE(app, argc, argv);
  fmt::print(
      "scene,order,cells,crossings,bytes_a_crossing_deltas,bytes_a_crossing_tree,ratio,ids,bits_an_id_tree,bits_an_id_"
      "paper,"
      "bits_ratio,geometry_bytes_a_split,splits_a_crossing,geometry_of_these_bytes,geometry_read_bytes,frames_a_"
      "crossing\n");
  for (const std::filesystem::path& file : files) occlod::bench::print_row(file);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "bench_cell_crossings: {}\n", error.what());
  return 1;
}
