// bench_cells: what is drawn for cells of a city, what it takes to find it, and how much of it is seen.
#include <fmt/format.h>

#include <vector>

#include "cell_sight.h"
#include "occlod/hierarchy/build.h"
#include "occlod/mesh/generate.h"
#include "occlod/viewcells/cell_builder.h"
#include "support/cpu_clock.h"

namespace occlod::bench {
namespace {

constexpr int image_size = 1024;  // of the images that decide what is seen, and of the tolerance of a pixel
constexpr int random_eyes = 116;  // 125 with the corners and the middle
constexpr double near = 0.1;

struct Place {
  const char* name;
  glm::dvec3 middle;
  double height;  // of cells, where they are no cubes
};

void run(const Hierarchy& hierarchy, const tool::FullScene& scene, const Place& place, double edge, double max_motion) {
  const RefineObject objects[] = {{.hierarchy = &hierarchy}};
  const CellOccluders occluders(objects, max_motion);
  const CellOptions options{.eyes = tool::cube_eyes(image_size, near)};
  CellBuilder without(objects, nullptr, options), builder(objects, &occluders, options);
  const glm::dvec3 half = 0.5 * glm::dvec3(edge, edge, place.height > 0.0 ? place.height : edge);
  const CellBox cell{place.middle - half, place.middle + half};
  const std::size_t drawn_without = without.build(cell).drawn_triangles;
  const double start = thread_cpu_ms();
  const CellCut& cut = builder.build(cell);
  const double ms = thread_cpu_ms() - start;
  const std::size_t seen = tool::count_seen(cell, objects, near, cut.objects, {random_eyes, image_size, 1});
  const tool::CellSight sight = tool::look_from(cell, scene, objects, options, cut.objects, {7, image_size / 4, 2});
  fmt::print("{},{},{},{},{},{},{},{},{},{},{},{:.0f},{}\n", place.name, edge, max_motion, occluders.triangle_count(),
             drawn_without, cut.triangles, cut.drawn_triangles, seen, cut.stats.queries, cut.stats.queries_hidden,
             cut.stats.flood_triangles, ms, sight.missing);
  static_cast<void>(std::fflush(stdout));
}

void run_all() {
  const Hierarchy city = build_hierarchy(generate_city({.blocks = 16, .facade_cells = 8}));
  const RefineObject objects[] = {{.hierarchy = &city}};
  const tool::FullScene scene(objects);
  fmt::print(
      "place,cell_edge,max_motion,occluder_triangles,drawn_without_occlusion,triangles,drawn_triangles,seen_by_125_"
      "eyes,"
      "queries,queries_hidden,flood_triangles,cpu_ms,missing_pixels\n");
  for (const Place& place : {Place{"crossing", {480, 480, 1.7}, 1.5}, Place{"street", {480, 510, 1.7}, 1.5},
                             Place{"12 m above a street", {480, 510, 12}, 0.0}})
    for (const double edge : {1.0, 4.0, 8.0}) run(city, scene, place, edge, 0.25);
  for (const double max_motion : {0.0, 1.0, 4.0}) run(city, scene, {"crossing", {480, 480, 1.7}, 1.5}, 4.0, max_motion);
}

}  // namespace
}  // namespace occlod::bench

int main() { occlod::bench::run_all(); }
