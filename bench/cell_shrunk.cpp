// bench_cell_shrunk: what is drawn for cells of a city where the hull test hides, and where what vLOD (2003) does
// hides: shrunk occluders from the middle of the cell and from the point of its quadratic programme, and its cull map.
#include <fmt/format.h>

#include <glm/common.hpp>
#include <map>
#include <numeric>
#include <vector>

#include "cell_sight.h"
#include "occlod/hierarchy/build.h"
#include "occlod/mesh/generate.h"
#include "occlod/viewcells/cell_builder.h"
#include "support/cpu_clock.h"
#include "viewcells/cell_geometry.h"
#include "viewcells/paper/cull_map.h"
#include "viewcells/paper/shrunk_occlusion.h"

namespace occlod::bench {
namespace {

constexpr int image_size = 1024;  // of the images that the tolerance is a pixel of
constexpr double near = 0.1;
constexpr double window_depth = 0.6;  // of generate_city()
constexpr int map_pixels = 1024;

struct Place {
  const char* name;
  glm::dvec3 middle;
  double height;  // of cells, where they are no cubes
};

// The largest boxes inside all houses: what is best for convex occluders. Windows are set back, so the facades of these
// boxes are, too.
std::vector<paper::ConvexOccluder> inner_boxes(const TriangleMesh& city) {
  std::vector<VertexId> parts(city.vertex_count());
  std::iota(parts.begin(), parts.end(), 0U);
  const auto part_of = [&](VertexId v) {
    while (parts[v] != v) v = parts[v] = parts[parts[v]];
    return v;
  };
  for (const Triangle& t : city.triangles) {
    parts[part_of(t.y)] = part_of(t.x);
    parts[part_of(t.z)] = part_of(t.x);
  }
  std::map<VertexId, CellBox> boxes;
  for (VertexId v = 0; v < city.vertex_count(); ++v) {
    const glm::dvec3 p(city.positions[v]);
    const auto [box, is_new] = boxes.try_emplace(part_of(v), CellBox{p, p});
    if (!is_new) box->second = unite(box->second, {p, p});
  }
  std::vector<paper::ConvexOccluder> occluders;
  for (const auto& [part, box] : boxes) {
    if (box.max.z <= 0.0) continue;  // the ground
    const glm::dvec3 inwards(window_depth, window_depth, 0.0);
    occluders.push_back(paper::box_occluder({box.min + inwards, box.max - inwards}));
  }
  return occluders;
}

struct Scene {
  TriangleMesh mesh = generate_city({.blocks = 16, .facade_cells = 8});
  Hierarchy hierarchy = build_hierarchy(mesh);
  std::vector<paper::ConvexOccluder> houses = inner_boxes(mesh);
  CellBox box;
  Scene() { box = {glm::dvec3(hierarchy.data().box.min) - 1.0, glm::dvec3(hierarchy.data().box.max) + 1.0}; }
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

void run(const Scene& scene, const CellOccluders& occluders, const Place& place, double edge) {
  const RefineObject objects[] = {{.hierarchy = &scene.hierarchy}};
  const CellOptions options{.eyes = tool::cube_eyes(image_size, near)};
  const glm::dvec3 half = 0.5 * glm::dvec3(edge, edge, place.height > 0.0 ? place.height : edge);
  const CellBox cell{place.middle - half, place.middle + half};
  CellBuilder without(objects, nullptr, options), with(objects, &occluders, options);

  const double start = thread_cpu_ms();
  const std::size_t ours = with.build(cell).drawn_triangles;
  const double ours_ms = thread_cpu_ms() - start;
  const std::vector<CellBox> boxes = grown_boxes(scene.hierarchy, cell, options, without.build(cell));
  const double reach = options.eyes.near / options.eyes.cos_corner_angle;
  const auto hull = count_drawn(boxes, [&](const CellBox& box) { return occluders.hides(cell, box, reach); });

  const double before_map = thread_cpu_ms();
  paper::CullMap map(scene.box, map_pixels);
  for (const paper::ConvexOccluder& house : scene.houses)
    if (const auto frustum = paper::shadow_frustum(house, cell)) map.add(*frustum);
  const double map_ms = thread_cpu_ms() - before_map;
  const auto flat = count_drawn(boxes, [&](const CellBox& box) { return map.hides(box); });

  fmt::print("{},{},{},{},{:.0f},{},{:.0f},{},{:.0f}", place.name, edge, boxes.size(), ours, ours_ms, hull.first,
             hull.second, flat.first, flat.second + map_ms);
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

void run_all() {
  const Scene scene;
  const RefineObject objects[] = {{.hierarchy = &scene.hierarchy}};
  const CellOccluders occluders(objects, 0.25);
  fmt::print(
      "place,cell_edge,drawn_without_occlusion,hull_drawn,hull_cpu_ms,hull_on_that_cut_drawn,hull_on_that_cut_cpu_ms,"
      "cull_map_drawn,cull_map_cpu_ms,middle_occluders,middle_drawn,middle_shrink_cpu_ms,middle_query_cpu_ms,"
      "best_occluders,best_drawn,best_shrink_cpu_ms,best_query_cpu_ms,hull_over_best,hull_on_that_cut_over_best\n");
  for (const Place& place : {Place{"crossing", {480, 480, 1.7}, 1.5}, Place{"street", {480, 510, 1.7}, 1.5},
                             Place{"12 m above a street", {480, 510, 12}, 0.0}})
    for (const double edge : {2.0, 4.0, 8.0, 16.0}) run(scene, occluders, place, edge);
}

}  // namespace
}  // namespace occlod::bench

int main() { occlod::bench::run_all(); }
