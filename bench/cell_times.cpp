// bench_cell_times SCENE [--cells N]: processor time of N undivided cells that are spread evenly over the regions of a
// scene, what they draw and what finding it took, as CSV. The hashes of two builds tell whether cells are the same.
#include <fmt/format.h>
#include <xxhash.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "cells/cell_divider.h"
#include "drawing.h"
#include "occlod/base.h"
#include "occlod/cell_builder.h"
#include "occlod/scene.h"
#include "support/cpu_clock.h"

namespace occlod::bench {
namespace {

// 1024x768 pixels, 60 degrees from top to bottom, near plane at 0.1.
constexpr EyeModel eyes{.near = 0.1};

template <typename T>
std::uint64_t hash_of(const std::vector<T>& values, std::uint64_t seed) {
  return XXH3_64bits_withSeed(values.data(), values.size() * sizeof(T), seed);
}

std::uint64_t hash_of(const CellCut& cut) {
  std::uint64_t hash = 0;
  for (const CellObjectCut& object : cut.objects) hash = hash_of(object.triangles, hash_of(object.applied, hash));
  return hash;
}

void run(const std::filesystem::path& file, std::size_t cells) {
  const SceneDescription description = read_scene(file);
  if (!description.cells)
    throw Error({file.string(), "cells", "does not say where the eye may be", "give the scene regions"});
  const std::vector<LoadedObject> loaded = load_objects(description, file.parent_path());
  const std::vector<RefineObject> objects = tool::refine_objects(loaded);
  CellTreeOptions options;
  options.regions = description.cells->regions;
  options.root_cell = description.cells->root_cell.value_or(options.root_cell);
  options.smallest_cell = description.cells->smallest_cell.value_or(options.smallest_cell);
  options.cell.eyes = eyes;
  const std::vector<RootCell> roots = root_cells(options);
  cells = std::min(cells, roots.size());
  const double begun = thread_cpu_ms();
  const CellOccluders occluders(objects, options.smallest_cell / 4.0);
  const double occluders_ms = thread_cpu_ms() - begun;
  CellBuilder builder(objects, &occluders, options.cell);
  fmt::print(
      "cell,x,y,z,cpu_ms,triangles,drawn_triangles,nodes,seen_boxes,queries,queries_hidden,queries_boxed,floods,flood_"
      "triangles,hash\n");
  double sum = 0.0;
  for (std::size_t i = 0; i < cells; ++i) {
    const std::size_t root = (2 * i + 1) * roots.size() / (2 * cells);
    const CellBox& box = roots[root].box;
    const double start = thread_cpu_ms();
    const CellCut& cut = builder.build(box);
    const double ms = thread_cpu_ms() - start;
    sum += ms;
    const CellStats& stats = cut.stats;
    fmt::print("{},{},{},{},{:.1f},{},{},{},{},{},{},{},{},{},{:016x}\n", root, box.min.x, box.min.y, box.min.z, ms,
               cut.triangles, cut.drawn_triangles, stats.nodes, stats.seen_boxes, stats.queries, stats.queries_hidden,
               stats.queries_boxed, stats.floods, stats.flood_triangles, hash_of(cut));
    static_cast<void>(std::fflush(stdout));
  }
  fmt::print(stderr, "{} occluder triangles in {:.1f} s; {:.3f} s a cell\n", occluders.triangle_count(),
             1e-3 * occluders_ms, 1e-3 * sum / static_cast<double>(cells));
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) {
  CLI::App app("Processor time of cells that are spread over a scene");
  std::filesystem::path scene;
  std::size_t cells = 12;
  app.add_option("SCENE", scene)->required();
  app.add_option("--cells", cells)->check(CLI::PositiveNumber)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    occlod::bench::run(scene, cells);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
