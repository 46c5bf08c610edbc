// Implements `occlod cells validate FILE.vlod SCENE`.
#include <fmt/format.h>
#include <xxhash.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/arithmetic.h"
#include "base/threads.h"
#include "cell_sight.h"
#include "cells.h"
#include "global_options.h"
#include "occlod/base.h"
#include "option_values.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

constexpr std::uint64_t max_eyes = 1'000'000, max_image = 8192;

struct Options {
  std::filesystem::path file, scene;
  std::uint64_t cells = 16;
  CellEyes eyes{50, 256, 1};
  int threads = 0;
  bool use_cache = true;
  bool json = false;
};

// Samples distinct leaves at random, ascending; all leaves if there are no more.
std::vector<CellId> sample(const CellTree& tree, std::uint64_t count, std::uint64_t seed) {
  std::vector<CellId> leaves;
  for (CellId n = 0; n < tree.nodes().size(); ++n)
    if (tree.is_leaf(n)) leaves.push_back(n);
  if (leaves.size() <= count) return leaves;
  RandomStream random(seed);
  std::set<CellId> chosen;
  while (chosen.size() < count)
    chosen.insert(leaves[static_cast<std::size_t>(random.below(static_cast<int>(leaves.size())))]);
  return {chosen.begin(), chosen.end()};
}

void print_header() {
  fmt::print("{:>8}  {:>10}  {:>10}  {:>10}  {:>11}\n", "cell", "drawn", "pixels", "backs", "unexplained");
}

struct Row {
  CellId cell = no_id;
  std::uint32_t drawn_triangles = 0;
  CellSight sight;
};

void print_row(const Row& row) {
  fmt::print("{:>8}  {:>10}  {:>10}  {:>10}  {:>11}\n", row.cell, row.drawn_triangles, row.sight.pixels,
             row.sight.backs, row.sight.missing);
}

Json to_json(const Row& row) {
  return {{"cell", row.cell},
          {"drawn_triangles", row.drawn_triangles},
          {"pixels", row.sight.pixels},
          {"backs", row.sight.backs},
          {"unexplained", row.sight.missing}};
}

// Prints rows for cells in their order, whichever thread is done first.
class Rows {
 public:
  Rows(std::size_t count, bool print) : rows_(count), print_(print) {}

  void set(std::size_t i, const Row& row) {
    const std::scoped_lock lock(mutex_);
    rows_[i] = row;
    for (; print_ && printed_ < rows_.size() && rows_[printed_]; ++printed_) print_row(*rows_[printed_]);
  }
  // Cells are begun in order and none is abandoned, so the first that fails is the same for any number of threads.
  void fail(std::size_t i) {
    const std::scoped_lock lock(mutex_);
    if (failed_ && *failed_ < i) return;
    failed_ = i;
    failure_ = std::current_exception();
  }
  [[nodiscard]] std::exception_ptr failure() const { return failure_; }
  [[nodiscard]] std::vector<Row> all() const {
    std::vector<Row> rows;
    for (const std::optional<Row>& row : rows_) rows.push_back(row.value());
    return rows;
  }

 private:
  std::mutex mutex_;
  std::vector<std::optional<Row>> rows_;
  bool print_;
  std::size_t printed_ = 0;
  std::optional<std::size_t> failed_;
  std::exception_ptr failure_;
};

Row look_from_cell(CellId cell, const VlodFile& file, const CellScene& scene, const FullScene& full, CellEyes eyes) {
  const CellNode& node = file.tree().node(cell);
  const std::vector<CellObjectCut> cut = read_cell(file, scene.objects, cell);
  eyes.seed += cell;
  return {cell, node.drawn_triangles, look_from(node.box, full, scene.objects, file.options().cell, cut, eyes)};
}

std::vector<Row> look_from_all(const std::vector<CellId>& cells, const VlodFile& file, const CellScene& scene,
                               const Options& options) {
  const FullScene full(scene.objects);
  Rows rows(cells.size(), !options.json);
  const auto look = [&](int, std::size_t i) {
    try {
      rows.set(i, look_from_cell(cells[i], file, scene, full, options.eyes));
    } catch (...) {
      rows.fail(i);
      throw;
    }
  };
  try {
    for_each_task(
        cells.size(), thread_count(options.threads), [] { return 0; }, look, [] {});
  } catch (...) {
    if (const std::exception_ptr first = rows.failure()) std::rethrow_exception(first);
    throw;
  }
  return rows.all();
}

CellSight sum_of(const std::vector<Row>& rows) {
  CellSight all;
  for (const Row& row : rows) {
    all.pixels += row.sight.pixels;
    all.backs += row.sight.backs;
    all.missing += row.sight.missing;
  }
  return all;
}

void run(const Options& options) {
  const SceneDescription description = describe_file(options.scene);
  static_cast<void>(open_vlod(options.file));  // first, because the scene takes longer
  const CellScene scene = load_cell_scene(description, options.scene, options.use_cache);
  const auto file = open_vlod(options.file, scene.objects, scene.names);
  const Stopwatch stopwatch;
  if (!options.json) print_header();
  const std::vector<Row> rows =
      look_from_all(sample(file->tree(), options.cells, options.eyes.seed), *file, scene, options);
  const CellSight all = sum_of(rows);
  Json cells = Json::array();
  for (const Row& row : rows) cells.push_back(to_json(row));
  const std::string text = cells.dump();
  Json result = {{"file", options.file.string()},
                 {"scene", options.scene.string()},
                 {"cells_checked", rows.size()},
                 {"eyes_a_cell", 9 + options.eyes.random},
                 {"image_size", options.eyes.image_size},
                 {"seed", options.eyes.seed},
                 {"pixels", all.pixels},
                 {"backs", all.backs},
                 {"unexplained", all.missing},
                 {"hash", fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()))},
                 {"check_ms", stopwatch.milliseconds()}};
  if (options.json) {
    result["cells"] = std::move(cells);
    print_json(result);
  } else {
    fmt::print("\n");
    print_lines(result);
  }
  if (all.missing > 0)
    throw Error({options.file.string(), "",
                 fmt::format("{} of {} pixels show what is not drawn", all.missing, all.pixels),
                 "build the cells again, of a hierarchy with accumulated error bounds"});
}

}  // namespace

void add_cells_validate(CLI::App& cells) {
  CLI::App& command =
      *cells.add_subcommand("validate", "Look from random eyes of random cells: is all that they see drawn?");
  const auto options = std::make_shared<Options>();
  add_file(command, "FILE", options->file, "File to check, .vlod")->required();
  add_file(command, "SCENE", options->scene, "What it was built of: a scene (.json), a mesh or an .olod file")
      ->required();
  add_number(command, "--cells", options->cells, WholeRange{1, max_eyes}, "Number of cells")->capture_default_str();
  add_number(command, "--eyes", options->eyes.random, WholeRange{0, max_eyes},
             "Random eyes of each, besides its corners and its middle; each looks to all six sides")
      ->capture_default_str();
  add_number(command, "--image-size", options->eyes.image_size, WholeRange{1, max_image},
             "Pixels along each side of an image")
      ->capture_default_str();
  add_number(command, "--seed", options->eyes.seed, WholeRange{}, "Random seed")->capture_default_str();
  command.callback([options, &command] {
    read_global_options(command,
                        {.json = &options->json, .threads = &options->threads, .use_cache = &options->use_cache});
    run(*options);
  });
}

}  // namespace occlod::tool
