// bench_cells: what is drawn for cells of a city, what it takes to find it, and how much of it is seen.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "cell_sight.h"
#include "occlod/build_hierarchy.h"
#include "occlod/cell_builder.h"
#include "occlod/generate.h"
#include "support/cpu_clock.h"

namespace occlod::bench {
namespace {

constexpr int image_size = 1024;  // of the images that decide what is seen, and of the tolerance of a pixel
constexpr int random_eyes = 116;  // 125 with the corners and the middle
constexpr double near = 0.1;

constexpr const char* names[] = {"none", "hull", "sampled"};  // by CellOcclusion

struct Place {
  const char* name;
  glm::dvec3 middle;
  double height;  // of cells, where they are no cubes
};

void run(const Hierarchy& hierarchy, const tool::FullScene& scene, const Place& place, double edge, double max_motion,
         CellOcclusion occlusion = CellOcclusion::hull, std::size_t budget = 0) {
  const RefineObject objects[] = {{.hierarchy = &hierarchy}};
  const CellOccluders occluders(objects, max_motion);
  CellOptions options{.eyes = tool::cube_eyes(image_size, near)};
  CellBuilder without(objects, nullptr, options);
  options.occlusion = occlusion;
  options.budget = budget;
  CellBuilder builder(objects, &occluders, options);
  const glm::dvec3 half = 0.5 * glm::dvec3(edge, edge, place.height > 0.0 ? place.height : edge);
  const CellBox cell{place.middle - half, place.middle + half};
  const std::size_t drawn_without = without.build(cell).drawn_triangles;
  const double start = thread_cpu_ms();
  const CellCut& cut = builder.build(cell);
  const double ms = thread_cpu_ms() - start;
  const std::size_t seen = tool::count_seen(cell, objects, near, cut.objects, {random_eyes, image_size, 1});
  options.tolerance_px = std::max(options.tolerance_px, cut.error_px);
  const tool::CellSight sight = tool::look_from(cell, scene, objects, options, cut.objects, {7, image_size / 4, 2});
  fmt::print("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{:.0f},{:.2f},{},{}\n", place.name,
             names[static_cast<std::size_t>(occlusion)], budget, edge, max_motion, occluders.triangle_count(),
             drawn_without, cut.triangles, cut.drawn_triangles, seen, cut.stats.seen_boxes, cut.stats.queries,
             cut.stats.queries_hidden, cut.stats.queries_boxed, cut.stats.flood_triangles, ms, cut.error_px,
             sight.pixels, sight.missing);
  static_cast<void>(std::fflush(stdout));
}

void run_all() {
  const Hierarchy city = build_hierarchy(generate("city", {{"blocks", 16}, {"facade_cells", 8}}));
  const RefineObject objects[] = {{.hierarchy = &city}};
  const tool::FullScene scene(objects);
  fmt::print(
      "place,occlusion,budget,cell_edge,max_motion,occluder_triangles,drawn_without_occlusion,triangles,"
      "drawn_triangles,seen_by_125_eyes,seen_boxes,queries,queries_hidden,queries_boxed,flood_triangles,cpu_ms,error_"
      "px,pixels,"
      "missing_pixels\n");
  for (const Place& place : {Place{"crossing", {480, 480, 1.7}, 1.5}, Place{"street", {480, 510, 1.7}, 1.5},
                             Place{"12 m above a street", {480, 510, 12}, 0.0}})
    for (const double edge : {1.0, 4.0, 8.0}) run(city, scene, place, edge, 0.25);
  const Place crossing{"crossing", {480, 480, 1.7}, 1.5};
  for (const double max_motion : {0.0, 1.0, 4.0}) run(city, scene, crossing, 4.0, max_motion);
  for (const std::size_t budget : {10'000U, 20'000U})
    run(city, scene, crossing, 4.0, 0.25, CellOcclusion::hull, budget);
  run(city, scene, crossing, 4.0, 0.25, CellOcclusion::sampled);
}

}  // namespace
}  // namespace occlod::bench

int main() { occlod::bench::run_all(); }
