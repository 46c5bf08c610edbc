#include "frames_vdpm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/trigonometric.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/timing.h"
#include "occlod/build_hierarchy.h"
#include "occlod/refiner.h"
#include "peers/openmesh_vdpm.h"
#include "refine/tuning.h"
#include "support/bench_meshes.h"
#include "support/frame_log.h"

namespace occlod::bench {
namespace {

constexpr std::size_t base_triangles = 1'000;
constexpr std::size_t wanted_triangles = 10'000;
constexpr int steps = 60;

// Around the planet, all of which is in the square image.
View view_at(int degrees) {
  const double angle = glm::radians(static_cast<double>(degrees));
  Camera camera;
  camera.eye = 3.0 * glm::dvec3(std::sin(angle), 0.0, std::cos(angle));
  camera.width = camera.height = 1024;
  return View(camera);
}

// Each triangle from its smallest vertex on, all in order.
std::vector<Triangle> in_order(std::vector<Triangle> triangles) {
  const auto less = [](const Triangle& a, const Triangle& b) {
    return std::lexicographical_compare(&a.x, &a.x + 3, &b.x, &b.x + 3);
  };
  for (Triangle& t : triangles) t = std::min({t, Triangle(t.y, t.z, t.x), Triangle(t.z, t.x, t.y)}, less);
  std::sort(triangles.begin(), triangles.end(), less);
  return triangles;
}

void check_that_all_splits_restore(const TriangleMesh& input, VdpmRefiner& refiner) {
  refiner.refine_all();
  if (in_order(refiner.mesh().triangles) != in_order(input.triangles))
    throw std::runtime_error("OpenMesh's VDPM: refined everywhere it is not the input mesh");
}

// Gives about the wanted number of triangles in the first view. By bisection of its logarithm.
double find_tolerance(VdpmRefiner& refiner) {
  double low = -12.0, high = -1.0;
  for (int i = 0; i < 32; ++i) {
    const double middle = 0.5 * (low + high);
    refiner.restart();
    refiner.refine(view_at(0), std::pow(10.0, middle));
    const std::size_t triangles = refiner.triangles();
    if (triangles > wanted_triangles * 99 / 100 && triangles < wanted_triangles * 101 / 100)
      return std::pow(10.0, middle);
    (triangles > wanted_triangles ? low : high) = middle;
  }
  throw std::runtime_error("OpenMesh's VDPM: no tolerance gives the wanted number of triangles");
}

void step(VdpmRefiner& refiner, const View& view, double tolerance, FrameLog& log) {
  const FrameTimer timer;
  const VdpmChanges changes = refiner.refine(view, tolerance);
  const FrameTime time = timer.elapsed();
  log.add(time, changes.splits + changes.merges, refiner.triangles(), refiner.hash());
}

// From scratch and along the path.
struct Pair {
  const FrameLog& scratch;
  const FrameLog& path;
};

void print_row(const std::string& way, const Pair& times, const Pair& vdpm) {
  const double scratch_ms = median(times.scratch.cpu_ms), path_ms = later_percentile(times.path.cpu_ms, 0.5);
  fmt::print("| {} | {} | {} | {:.0f} | {:.2f} | {:.0f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:016x} | {:016x} |\n",
             way, times.scratch.triangles, times.path.triangles, median(times.scratch.changes), scratch_ms,
             later_percentile(times.path.changes, 0.5), path_ms, later_percentile(times.path.cpu_ms, 0.95),
             median(vdpm.scratch.cpu_ms) / scratch_ms, later_percentile(vdpm.path.cpu_ms, 0.5) / path_ms,
             times.scratch.hash, times.path.hash);
}

struct Ours {
  Ours(const std::vector<RefineObject>& objects, Culling culling, std::size_t budget)
      : scratch(objects), path(objects) {
    tune(options).culling = culling;
    options.budget = budget;
  }

  RefinerLog scratch, path;
  RefineOptions options;
};

void print_head(std::size_t budget) {
  fmt::print(
      "\nAgainst OpenMesh's VDPM: planet:8, both from {} triangles up; VDPM's tolerance and our budget give {} in the "
      "first view; then {} views, 1 degree apart.\n"
      "Times are the processor's, medians, view by view in turns on one thread. What VDPM needs to start from "
      "scratch, a copy of its base mesh, is not in its times; what ours needs is.\n"
      "Debian compiles libOpenMesh with its assertions on, which takes VDPM some 2 times as long from scratch and 2.5 "
      "times along a path as the same source with -DNDEBUG: compare with that, by LD_LIBRARY_PATH.\n\n"
      "| way | triangles, scratch | path | splits | scratch ms | changes a view | ms a view | p95 | VDPM / this, "
      "scratch | path | hash, scratch | path |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n",
      base_triangles, budget, steps);
}

}  // namespace

void compare_with_vdpm() {
  const TriangleMesh mesh = load_bench_mesh("planet:8");
  const VdpmForest forest(mesh, base_triangles);
  VdpmRefiner scratch(forest), path(forest);
  check_that_all_splits_restore(mesh, scratch);
  const double tolerance = find_tolerance(scratch);
  const std::size_t budget = scratch.triangles();

  BuildOptions build;
  build.base_triangles = base_triangles;
  const Hierarchy hierarchy = build_hierarchy(mesh, build);
  const std::vector<RefineObject> objects = {{&hierarchy}};
  Ours subtree(objects, Culling::subtree, budget), star(objects, Culling::star, budget);

  NoOcclusion none;
  FrameLog vdpm_scratch, vdpm_path;
  for (int i = 0; i <= steps; ++i) {
    const View view = view_at(i);
    scratch.restart();
    step(scratch, view, tolerance, vdpm_scratch);
    for (Ours* ours : {&subtree, &star}) ours->scratch.step(view, ours->options, none, false);
  }
  // In a loop of its own: copying VDPM's base mesh would empty the caches.
  for (int i = 0; i <= steps; ++i) {
    const View view = view_at(i);
    step(path, view, tolerance, vdpm_path);
    for (Ours* ours : {&subtree, &star}) ours->path.step(view, ours->options, none, true);
  }
  print_head(budget);
  const Pair vdpm{vdpm_scratch, vdpm_path};
  print_row("VDPM", vdpm, vdpm);
  print_row("ours, subtree", {subtree.scratch.log, subtree.path.log}, vdpm);
  print_row("ours, star", {star.scratch.log, star.path.log}, vdpm);
  std::fflush(stdout);
}

}  // namespace occlod::bench
