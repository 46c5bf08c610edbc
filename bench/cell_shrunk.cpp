// bench_cell_shrunk: what is drawn for cells of a city where the hull test hides, and where what vLOD (2003) does
// hides: shrunk occluders from the middle of the cell and from the point of its quadratic programme, and its cull map.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <glm/common.hpp>
#include <string>
#include <vector>

#include "cell_sight.h"
#include "occlod/build_hierarchy.h"
#include "occlod/cell_builder.h"
#include "occlod/generate.h"
#include "papers/cull_map.h"
#include "papers/shrunk_occlusion.h"
#include "support/cpu_clock.h"
#include "support/mesh_parts.h"

namespace occlod::bench {
namespace {

constexpr double near = 0.1;
constexpr double window_depth = 0.6;  // of generate("city")
constexpr int map_pixels = 1024;
constexpr int random_eyes = 116;  // 125 with the corners and the middle

struct Place {
  const char* name;
  glm::dvec3 middle;
  double height;  // of cells, where they are no cubes
};

// The largest boxes inside all houses: what is best for convex occluders. Windows are set back, so the facades of these
// boxes are, too.
std::vector<paper::ConvexOccluder> inner_boxes(const TriangleMesh& city) {
  std::vector<paper::ConvexOccluder> occluders;
  for (const CellBox& box : parts_of(city).boxes) {
    if (box.max.z <= 0.0) continue;  // the ground
    const glm::dvec3 inwards(window_depth, window_depth, 0.0);
    occluders.push_back(paper::box_occluder({box.min + inwards, box.max - inwards}));
  }
  return occluders;
}

constexpr double pitch = 60.0;  // of generate("city"), from street to street

struct Options {
  int blocks = 16;
  std::vector<double> edges = {2.0, 4.0, 8.0, 16.0};
  bool sampled = false;
  int image_size = 1024;  // of the images that the tolerance is a pixel of
};

struct Scene {
  TriangleMesh mesh;
  Hierarchy hierarchy = build_hierarchy(mesh);
  std::vector<paper::ConvexOccluder> houses = inner_boxes(mesh);
  CellBox box;
  explicit Scene(int blocks) : mesh(generate("city", {{"blocks", blocks}, {"facade_cells", 8}})) {
    box = {glm::dvec3(hierarchy.data().box.min) - 1.0, glm::dvec3(hierarchy.data().box.max) + 1.0};
  }
};

// How many of the boxes are not hidden, and how long that takes.
template <typename Hides>
std::pair<std::size_t, double> count_drawn(const std::vector<CellBox>& boxes, const Hides& hides) {
  const double start = thread_cpu_ms();
  std::size_t drawn = 0;
  for (const CellBox& box : boxes) drawn += hides(box) ? 0U : 1U;
  return {drawn, thread_cpu_ms() - start};
}

// Boxes around triangles, grown as far as the input may be from them for an eye of the cell.
std::vector<CellBox> grown_boxes(const Hierarchy& hierarchy, const CellBox& cell, const CellOptions& options,
                                 const CellCut& cut) {
  const CellView view(cell, options.eyes, glm::dmat4(1.0));
  std::vector<CellBox> boxes;
  for (const Triangle& t : cut.objects[0].triangles) {
    const std::span<const glm::vec3> p = hierarchy.positions();
    const Box box = bounding_box(std::array{p[t.x], p[t.y], p[t.z]});
    const double error = static_cast<double>(hierarchy.error_bound());
    boxes.push_back(view.world_box(box, std::min(error, options.tolerance_px / view.smallest_scale_px(box))));
  }
  return boxes;
}

// What the builder draws where cubes of images decide what is hidden, and its ms; empty if it is not asked for.
std::string drawn_by_samples(std::span<const RefineObject> objects, CellOptions options, const CellBox& cell,
                             bool is_asked) {
  if (!is_asked) return ",";
  options.occlusion = CellOcclusion::sampled;
  const double start = thread_cpu_ms();
  const std::size_t drawn = CellBuilder(objects, nullptr, options).build(cell).drawn_triangles;
  return fmt::format("{},{:.0f}", drawn, thread_cpu_ms() - start);
}

void run(const Scene& scene, const CellOccluders& occluders, const Place& place, double edge, const Options& chosen) {
  const int image_size = chosen.image_size;
  const RefineObject objects[] = {{.hierarchy = &scene.hierarchy}};
  const CellOptions options{.eyes = tool::cube_eyes(image_size, near)};
  const glm::dvec3 half = 0.5 * glm::dvec3(edge, edge, place.height > 0.0 ? place.height : edge);
  const CellBox cell{place.middle - half, place.middle + half};
  CellBuilder without(objects, nullptr, options), with(objects, &occluders, options);

  const double start = thread_cpu_ms();
  const CellCut& cut = with.build(cell);
  const double ours_ms = thread_cpu_ms() - start;
  const std::size_t ours = cut.drawn_triangles;
  const std::size_t seen = tool::count_seen(cell, objects, near, cut.objects, {random_eyes, image_size, 1});
  const std::vector<CellBox> boxes = grown_boxes(scene.hierarchy, cell, options, without.build(cell));
  const double reach = options.eyes.near / options.eyes.cos_corner_angle;
  const auto hull = count_drawn(boxes, [&](const CellBox& box) { return occluders.hides(cell, box, reach); });

  const double before_map = thread_cpu_ms();
  paper::CullMap map(scene.box, map_pixels);
  for (const paper::ConvexOccluder& house : scene.houses)
    if (const auto frustum = paper::shadow_frustum(house, cell)) map.add(*frustum);
  const double map_ms = thread_cpu_ms() - before_map;
  const auto flat = count_drawn(boxes, [&](const CellBox& box) { return map.hides(box); });

  fmt::print("{},{},{},{},{},{},{:.0f},{},{:.0f},{},{:.0f}", place.name, edge, seen, boxes.size(),
             drawn_by_samples(objects, options, cell, chosen.sampled), ours, ours_ms, hull.first, hull.second,
             flat.first, flat.second + map_ms);
  for (const bool best_point : {false, true}) {
    const double before = thread_cpu_ms();
    const paper::ShrunkOcclusion shrunk(cell, scene.houses, scene.box, {best_point, image_size});
    const double shrink_ms = thread_cpu_ms() - before;
    const auto drawn = count_drawn(boxes, [&](const CellBox& box) { return shrunk.hides(box); });
    fmt::print(",{},{},{:.0f},{:.0f}", shrunk.occluder_count(), drawn.first, shrink_ms, drawn.second);
    if (best_point)
      fmt::print(",{:.3f},{:.3f}\n", static_cast<double>(ours) / static_cast<double>(drawn.first),
                 static_cast<double>(hull.first) / static_cast<double>(drawn.first));
  }
  static_cast<void>(std::fflush(stdout));
}

void run_all(const Options& chosen) {
  const Scene scene(chosen.blocks);
  const RefineObject objects[] = {{.hierarchy = &scene.hierarchy}};
  const CellOccluders occluders(objects, 0.25);
  fmt::print(
      "place,cell_edge,seen_by_125_eyes,drawn_without_occlusion,sampled_drawn,sampled_cpu_ms,hull_drawn,hull_cpu_ms,"
      "hull_on_that_cut_"
      "drawn,hull_on_that_cut_cpu_ms,"
      "cull_map_drawn,cull_map_cpu_ms,middle_occluders,middle_drawn,middle_shrink_cpu_ms,middle_query_cpu_ms,"
      "best_occluders,best_drawn,best_shrink_cpu_ms,best_query_cpu_ms,hull_over_best,hull_on_that_cut_over_best\n");
  const double middle = pitch * (chosen.blocks / 2);
  for (const Place& place :
       {Place{"crossing", {middle, middle, 1.7}, 1.5}, Place{"street", {middle, middle + 30.0, 1.7}, 1.5},
        Place{"12 m above a street", {middle, middle + 30.0, 12}, 0.0}})
    for (const double edge : chosen.edges) run(scene, occluders, place, edge, chosen);
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) {
  CLI::App app("What is drawn for cells of a city, by our hull test and by the methods of vLOD (2003).");
  occlod::bench::Options options;
  app.add_option("--blocks", options.blocks, "Blocks along each side of the city")->check(CLI::Range(2, 64));
  app.add_option("--edges", options.edges, "Edges of cells, m")->delimiter(',')->check(CLI::PositiveNumber);
  app.add_flag("--sampled", options.sampled, "Also by images from 125 eyes, which takes longest");
  app.add_option("--image-size", options.image_size, "Pixels along each side of images")->check(CLI::Range(16, 4096));
  CLI11_PARSE(app, argc, argv);
  occlod::bench::run_all(options);
  return 0;
}
