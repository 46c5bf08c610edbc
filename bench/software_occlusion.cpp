// bench_software_occlusion: drawing occluders, reducing them and testing bounds on the CPU, by instruction set; and how
// many of the bounds that rays find hidden the tests find.
#include <fmt/format.h>
#include <hwy/targets.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/timing.h"
#include "occlod/build_hierarchy.h"
#include "occlod/refiner.h"
#include "occlod/visibility.h"
#include "oracle/ray_oracle.h"
#include "raster/depth_pyramid.h"
#include "refine/tuning.h"
#include "stopwatch.h"
#include "support/bench_meshes.h"
#include "support/planet_views.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

constexpr std::size_t bound_count = 5000;
constexpr std::size_t rays_bound_count = 2000;  // rays are slow

struct Kind {
  std::string_view name;
  std::vector<VisibilityQuery> queries;
};

struct Occluder {
  std::vector<Triangle> triangles;
};

struct Scene {
  std::string_view name;
  View view;
  ObjectView object;
  std::vector<glm::vec3> positions;
  std::vector<Occluder> occluders;
  std::vector<Kind> kinds;
};

// Bounds around points of the surface, 1 to 8 % of the planet's radius in size: those of subtrees after a few thousand
// splits. Points of hulls are kept in `hulls`.
std::vector<Kind> bounds_on(std::span<const glm::vec3> surface, std::vector<std::vector<glm::vec3>>& hulls) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F), log_size(std::log(0.01F), std::log(0.08F));
  std::vector<Kind> kinds = {{"box", {}}, {"sphere", {}}, {"cylinder", {}}, {"hull of 7 points", {}}};
  hulls.resize(bound_count);
  for (std::vector<glm::vec3>& hull : hulls) {
    const glm::vec3 center = surface[random() % surface.size()];
    const float size = std::exp(log_size(random));
    for (int i = 0; i < 7; ++i) hull.push_back(center + size * glm::vec3(unit(random), unit(random), unit(random)));
    kinds[0].queries.push_back({0, Box{center - size, center + size}});
    kinds[1].queries.push_back({0, Sphere{center, size}});
    kinds[2].queries.push_back({0, Cylinder{center, size, glm::normalize(center), -0.3F * size, 0.3F * size}});
    kinds[3].queries.push_back({0, PointHull{hull}});
  }
  return kinds;
}

std::vector<Scene> make_scenes(std::vector<std::vector<glm::vec3>>& hulls) {
  const Hierarchy hierarchy = build_hierarchy(load_bench_mesh("planet:8"));
  Refiner refiner(std::vector<RefineObject>{{&hierarchy, glm::dmat4(1.0), false}});
  std::vector<Scene> scenes;
  for (const NamedCamera& camera : planet_views()) {
    const View view(camera.camera);
    Scene& scene = scenes.emplace_back(Scene{camera.name, view, ObjectView(view, glm::dmat4(1.0)), {}, {}, {}});
    scene.positions.assign(hierarchy.positions().begin(), hierarchy.positions().end());
    for (const std::size_t budget : {300U, 2'500U, 10'000U}) {
      NoOcclusion none;
      RefineOptions options;
      options.budget = budget;
      tune(options).culling = Culling::subtree;
      scene.occluders.push_back({refiner.refine(view, options, none).objects[0].triangles});
    }
  }
  hulls.clear();
  const std::vector<Kind> kinds = bounds_on(scenes[0].positions, hulls);
  for (Scene& scene : scenes) scene.kinds = kinds;
  return scenes;
}

std::vector<std::int64_t> targets() {
  std::vector<std::int64_t> list;
  for (std::int64_t left = hwy::SupportedTargets() | HWY_SCALAR; left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    if ((target & (HWY_SCALAR | HWY_SSSE3 | HWY_AVX2 | HWY_AVX3)) != 0) list.push_back(target);
  }
  return list;
}

std::string_view name_of(std::int64_t target) {
  if (target == HWY_SCALAR) return "plain C++";
  if (target == HWY_AVX3) return "AVX-512";
  return hwy::TargetName(target);
}

// FNV-1a.
class Hash {
 public:
  void add(std::uint32_t value) { value_ = (value_ ^ value) * 1099511628211U; }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037U;
};

template <class Work>
double median_ms(int repeat, Work work) {
  std::vector<double> ms;
  for (int i = 0; i <= repeat; ++i) {
    const tool::Stopwatch stopwatch;
    work();
    if (i > 0) ms.push_back(stopwatch.milliseconds());
  }
  return median(ms);
}

// Answers of a batch, or of one query at a time.
void ask(Visibility& backend, const Kind& kind, bool together, std::vector<std::uint32_t>& answers) {
  answers.clear();
  for (const VisibilityQuery& query : kind.queries) {
    backend.submit(query);
    if (!together) answers.push_back(backend.collect());
  }
  while (answers.size() < kind.queries.size()) answers.push_back(backend.collect());
}

void measure_occluders(const Scene& scene, std::int64_t target, int repeat) {
  for (const Occluder& occluder : scene.occluders) {
    DepthPyramid pyramid;
    DepthImage image;
    PixelRect drawn;
    const double draw_ms = median_ms(repeat, [&] {
      image = pyramid.begin(scene.view.width(), scene.view.height());
      drawn = draw_depth(image, scene.positions, occluder.triangles, scene.object.object_to_clip());
    });
    const double reduce_ms = median_ms(repeat, [&] { pyramid.finish(drawn); });
    Hash hash;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) hash.add(std::bit_cast<std::uint32_t>(pyramid.farthest(0, x, y)));
    fmt::print("| {} | {} | {} | {:.3f} | {:.3f} | {:016x} |\n", scene.name, occluder.triangles.size(), name_of(target),
               draw_ms, reduce_ms, hash.value());
  }
}

void measure_tests(const Scene& scene, std::int64_t target, int repeat) {
  const auto backend = make_software_occlusion();
  backend->begin_view(scene.view, {&scene.object, 1});
  const std::vector<OccluderPart> parts = {{0, scene.positions, scene.occluders.back().triangles}};
  backend->draw_occluder(parts);
  std::vector<std::uint32_t> answers;
  for (const Kind& kind : scene.kinds) {
    const auto million_per_second = [&](bool together) {
      return bound_count / 1e3 / median_ms(repeat, [&] { ask(*backend, kind, together, answers); });
    };
    const double together = million_per_second(true), single = million_per_second(false);
    Hash hash;
    for (const std::uint32_t answer : answers) hash.add(answer);
    fmt::print("| {} | {} | {} | {:.1f} | {:.1f} | {} | {:016x} |\n", scene.name, kind.name, name_of(target), together,
               single, std::count(answers.begin(), answers.end(), 0U), hash.value());
  }
}

void measure_whole(const Scene& scene, std::int64_t target, int repeat) {
  const auto backend = make_software_occlusion();
  backend->begin_view(scene.view, {&scene.object, 1});
  std::vector<std::uint32_t> answers;
  const std::vector<OccluderPart> parts = {{0, scene.positions, scene.occluders.back().triangles}};
  const double ms = median_ms(repeat, [&] {
    backend->draw_occluder(parts);
    ask(*backend, scene.kinds[0], true, answers);
  });
  fmt::print("| {} | {} | {} | {:.3f} |\n", scene.name, name_of(target), scene.occluders.back().triangles.size(), ms);
}

// Bounds that cover no pixel centre say nothing and are left out.
void measure_tightness(const Scene& scene) {
  for (const Occluder& occluder : scene.occluders) {
    const auto backend = make_software_occlusion();
    backend->begin_view(scene.view, {&scene.object, 1});
    const std::vector<OccluderPart> parts = {{0, scene.positions, occluder.triangles}};
    const test::RayOracle rays(scene.view, std::array{glm::dmat4(1.0)}, parts);
    backend->draw_occluder(parts);
    for (const Kind& kind : scene.kinds) {
      std::size_t hidden = 0, found = 0, wrong = 0;
      for (const VisibilityQuery& query : std::span(kind.queries).first(rays_bound_count)) {
        const test::Sight sight = rays.look(query);
        if (sight.covered == 0 || sight.at_eye) continue;
        backend->submit(query);
        const bool says_hidden = backend->collect() == 0;
        hidden += sight.visible == 0 ? 1 : 0;
        found += sight.visible == 0 && says_hidden ? 1 : 0;
        wrong += sight.visible != 0 && says_hidden && rays.certainly_visible(query) ? 1U : 0U;
      }
      fmt::print("| {} | {} | {} | {} | {:.2f} | {} |\n", scene.name, occluder.triangles.size(), kind.name, hidden,
                 100.0 * static_cast<double>(found) / static_cast<double>(std::max<std::size_t>(hidden, 1)), wrong);
    }
  }
}

template <class Measure>
void for_each_row(const char* head, const char* rule, const std::vector<Scene>& scenes, Measure measure) {
  fmt::print("{}\n{}\n", head, rule);
  for (const Scene& scene : scenes)
    for (const std::int64_t target : targets()) {
      hwy::GetChosenTarget().Update(target);
      measure(scene, target);
    }
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  fmt::print("\n");
}

void run(int repeat) {
  std::vector<std::vector<glm::vec3>> hulls;
  const std::vector<Scene> scenes = make_scenes(hulls);
  for_each_row("| view | triangles | target | draw ms | pyramid ms | depth hash |", "|---|---|---|---|---|---|", scenes,
               [&](const Scene& scene, std::int64_t target) { measure_occluders(scene, target, repeat); });
  for_each_row("| view | bound | target | M tests/s | one by one | hidden | answers hash |",
               "|---|---|---|---|---|---|---|", scenes,
               [&](const Scene& scene, std::int64_t target) { measure_tests(scene, target, repeat); });
  for_each_row("| view | target | triangles | occluder, pyramid, 5,000 boxes: ms |", "|---|---|---|---|", scenes,
               [&](const Scene& scene, std::int64_t target) { measure_whole(scene, target, repeat); });
  fmt::print("| view | triangles | bound | hidden by rays | found % | wrongly hidden |\n|---|---|---|---|---|---|\n");
  for (const Scene& scene : scenes) measure_tightness(scene);
}

int run(int argc, char** argv) {
  CLI::App app("Occluders and tests on the CPU, by instruction set.", "bench_software_occlusion");
  int repeat = 51;
  add_repeat_option(app, repeat, "Runs after the first");
  return run_app(app, argc, argv, [&] { run(repeat); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
