// bench_cell_rays: what is seen from cells of a city, as guided visibility sampling with Embree finds it, object by
// object, and as the hull test has it drawn: processor time against pixels that are missed, by eyes that none has used.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "cell_sight.h"
#include "occlod/build_hierarchy.h"
#include "occlod/cell_builder.h"
#include "occlod/generate.h"
#include "support/cpu_clock.h"
#include "support/guided_sampling.h"
#include "support/mesh_parts.h"

namespace occlod::bench {
namespace {

constexpr int image_size = 1024;                               // of the images that the tolerance is a pixel of
constexpr double near = 0.1, max_motion = 0.25, pitch = 60.0;  // of generate("city"), from street to street
constexpr std::array missed_shares{1.0, 0.1, 0.01, 0.001};     // %
constexpr std::array tolerances{1.0, 0.25};                    // px

struct Options {
  int blocks = 16, facade_cells = 8;
  std::vector<double> edges = {1.0, 4.0, 8.0};
  double seconds = 60.0;
  tool::CellEyes eyes = {41, 512, 77};  // that judge: 50
  GuidedOptions guided;
};

struct Place {
  const char* name;
  glm::dvec3 middle;
  double height;  // of cells, where they are no cubes
};

// Triangles in the order of the full scene, with what is made once for all cells.
struct City {
  Hierarchy hierarchy;
  std::array<RefineObject, 1> objects{RefineObject{.hierarchy = &hierarchy}};
  tool::FullScene scene{objects};
  TriangleMesh mesh;
  MeshParts parts;
  double rays_ms = 0.0, occluders_ms = 0.0;
  std::optional<test::RayScene> rays;
  std::optional<CellOccluders> occluders;

  explicit City(const Options& options)
      : hierarchy(
            build_hierarchy(generate("city", {{"blocks", options.blocks}, {"facade_cells", options.facade_cells}}))) {
    const std::span<const glm::vec3> positions = hierarchy.positions();
    mesh.positions.assign(positions.begin(), positions.end());
    for (std::uint32_t i = 0; i < scene.triangle_count(); ++i) mesh.triangles.push_back(scene.item(i).triangle);
    parts = parts_of(mesh);
    const double start = thread_cpu_ms();
    rays.emplace(mesh.positions, mesh.triangles);
    const double built = thread_cpu_ms();
    occluders.emplace(objects, max_motion);
    rays_ms = built - start;
    occluders_ms = thread_cpu_ms() - built;
  }
};

// Pixels of the eyes that judge, by what owns them.
struct Truth {
  std::vector<std::uint32_t> by_triangle, by_part;
  std::uint64_t pixels = 0;

  Truth(const City& city, const CellBox& cell, const tool::CellEyes& eyes)
      : by_triangle(tool::count_pixels(cell, city.scene, city.objects, near, eyes)),
        by_part(city.parts.boxes.size(), 0) {
    for (std::size_t i = 0; i < by_triangle.size(); ++i) {
      by_part[city.parts.of_triangle[i]] += by_triangle[i];
      pixels += by_triangle[i];
    }
  }
};

struct Row {
  std::string place;
  double edge = 0.0;
  std::uint64_t pixels = 0;

  // `within`: the share of missed pixels that was waited for, or "end".
  void print(const char* way, const std::string& within, double ms, std::uint64_t rays, std::size_t triangles,
             std::uint64_t missed) const {
    fmt::print("{},{},{},{},{:.1f},{},{},{},{},{:.5f}\n", place, edge, way, within, ms, rays, triangles, missed, pixels,
               100.0 * static_cast<double>(missed) / static_cast<double>(pixels));
    static_cast<void>(std::fflush(stdout));
  }
  void print_never(const char* way, double within) const {
    fmt::print("{},{},{},{:g},,,,,{},\n", place, edge, way, within, pixels);
  }
};

// Follows what has been found: `key` of a triangle is what is kept as a whole, with so many triangles and pixels.
template <typename Key>
void print_course(const Row& row, const char* way, std::span<const FoundTriangle> found, double end_ms,
                  std::uint64_t rays, const Key& key, std::span<const std::uint32_t> key_pixels,
                  std::span<const std::size_t> key_triangles) {
  std::vector<bool> is_kept(key_pixels.size(), false);
  std::uint64_t missed = row.pixels;
  std::size_t triangles = 0, next = 0;
  for (const FoundTriangle& f : found) {
    const std::size_t k = key(f.triangle);
    if (is_kept[k]) continue;
    is_kept[k] = true;
    missed -= key_pixels[k];
    triangles += key_triangles[k];
    for (; next < missed_shares.size() &&
           100.0 * static_cast<double>(missed) <= missed_shares[next] * static_cast<double>(row.pixels);
         ++next)
      row.print(way, fmt::format("{:g}", missed_shares[next]), f.ms, f.rays, triangles, missed);
  }
  for (; next < missed_shares.size(); ++next) row.print_never(way, missed_shares[next]);
  row.print(way, "end", end_ms, rays, triangles, missed);
}

void run_rays(const City& city, const Row& row, const Truth& truth, const CellBox& cell, const GuidedOptions& options) {
  GuidedSampling sampling(city.mesh.positions, city.mesh.triangles, *city.rays, cell, options);
  const std::span<const FoundTriangle> found = sampling.run();
  const std::vector<std::size_t> ones(truth.by_triangle.size(), 1);
  print_course(
      row, options.guided ? "gvs" : "random rays", found, options.max_ms, sampling.rays(),
      [](std::uint32_t t) { return t; }, truth.by_triangle, ones);
  if (options.guided)
    print_course(
        row, "objects by gvs", found, options.max_ms, sampling.rays(),
        [&](std::uint32_t t) { return city.parts.of_triangle[t]; }, truth.by_part, city.parts.triangles);
}

// Whole objects whose boxes the hull test does not hide.
void run_objects(const City& city, const Row& row, const Truth& truth, const CellBox& cell) {
  const double reach = near / tool::cube_eyes(image_size, near).cos_corner_angle, start = thread_cpu_ms();
  std::vector<bool> is_kept;
  for (const CellBox& box : city.parts.boxes) is_kept.push_back(!city.occluders->hides(cell, box, reach));
  const double ms = thread_cpu_ms() - start;
  std::size_t triangles = 0;
  std::uint64_t missed = 0;
  for (std::size_t part = 0; part < is_kept.size(); ++part) {
    triangles += is_kept[part] ? city.parts.triangles[part] : 0;
    missed += is_kept[part] ? 0 : truth.by_part[part];
  }
  row.print("objects by hull", "end", ms, 0, triangles, missed);
}

void run_builder(const City& city, const Row& row, const CellBox& cell, const Options& chosen, double tolerance_px) {
  CellOptions options{.eyes = tool::cube_eyes(image_size, near)};
  options.tolerance_px = tolerance_px;
  CellBuilder builder(city.objects, &*city.occluders, options);
  const double start = thread_cpu_ms();
  const CellCut& cut = builder.build(cell);
  const double ms = thread_cpu_ms() - start;
  const tool::CellSight sight = tool::look_from(cell, city.scene, city.objects, options, cut.objects, chosen.eyes);
  Row judged = row;
  judged.pixels = sight.pixels;
  judged.print(fmt::format("hull {:g} px", tolerance_px).c_str(), "end", ms, 0, cut.drawn_triangles, sight.missing);
}

void run(const City& city, const Place& place, double edge, const Options& options) {
  const glm::dvec3 half = 0.5 * glm::dvec3(edge, edge, place.height > 0.0 ? place.height : edge);
  const CellBox cell{place.middle - half, place.middle + half};
  const Truth truth(city, cell, options.eyes);
  const Row row{place.name, edge, truth.pixels};
  for (const double tolerance : tolerances) run_builder(city, row, cell, options, tolerance);
  run_objects(city, row, truth, cell);
  for (const bool is_guided : {true, false}) {
    GuidedOptions guided = options.guided;
    guided.guided = is_guided;
    guided.max_ms = 1e3 * options.seconds;
    run_rays(city, row, truth, cell, guided);
  }
  const auto seen = static_cast<std::size_t>(
      std::count_if(truth.by_triangle.begin(), truth.by_triangle.end(), [](std::uint32_t n) { return n > 0; }));
  row.print("seen by the judges", "end", 0.0, 0, seen, 0);
}

void run_all(const Options& options) {
  const City city(options);
  fmt::print(stderr,
             "bench_cell_rays: {} triangles, {} objects; once for all cells: Embree {:.0f} ms, occluders {:.0f} ms\n",
             city.mesh.triangles.size(), city.parts.boxes.size(), city.rays_ms, city.occluders_ms);
  fmt::print("place,cell_edge,way,within,cpu_ms,rays,triangles,missed_pixels,pixels,missed_pct\n");
  const double middle = pitch * (options.blocks / 2);
  for (const Place& place :
       {Place{"crossing", {middle, middle, 1.7}, 1.5}, Place{"street", {middle, middle + 30.0, 1.7}, 1.5},
        Place{"12 m above a street", {middle, middle + 30.0, 12}, 0.0}})
    for (const double edge : options.edges) run(city, place, edge, options);
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) {
  CLI::App app("What is seen from cells of a city: by guided visibility sampling, object by object, by the hull test.");
  occlod::bench::Options options;
  app.add_option("--blocks", options.blocks, "Blocks along each side of the city")->check(CLI::Range(2, 64));
  app.add_option("--facade-cells", options.facade_cells, "Grid cells along each edge of a wall")
      ->check(CLI::Range(1, 64));
  app.add_option("--edges", options.edges, "Edges of cells, m")->delimiter(',')->check(CLI::PositiveNumber);
  app.add_option("--seconds", options.seconds, "Processor time of rays for each cell")->check(CLI::PositiveNumber);
  app.add_option("--eyes", options.eyes.random, "Eyes that judge, besides 9 of corners and middle")
      ->check(CLI::Range(0, 10'000));
  app.add_option("--image-size", options.eyes.image_size, "Pixels along each side of their images")
      ->check(CLI::Range(16, 4096));
  app.add_option("--border", options.guided.border_rad, "How far beyond borders rays go, rad")
      ->check(CLI::PositiveNumber);
  app.add_option("--finest", options.guided.finest_rad, "Shortest part of a border that is divided, rad")
      ->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  occlod::bench::run_all(options);
  return 0;
}
