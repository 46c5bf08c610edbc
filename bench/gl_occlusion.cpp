// bench_gl_occlusion: measures what 5,000 questions cost software occlusion and gl-query, about the triangles of a
// rough planet that is its own occluder.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "base/timing.h"
#include "gl/backend_options.h"
#include "occlod/base.h"
#include "occlod/gl.h"
#include "occlod/visibility.h"
#include "stopwatch.h"
#include "support/bench_meshes.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

constexpr std::array<const char*, 3> shape_names{"box", "sphere", "cylinder"};

struct Options {
  std::string platform = "egl";
  int level = 5;
  int questions = 5000;
  int width = 1024;
  int height = 768;
  int repeat = 7;
};

struct Scene {
  TriangleMesh planet;
  View view;
  std::array<std::vector<VisibilityQuery>, 3> questions;  // by shape, about the same triangles
};

// Around one triangle: its box, the sphere around that, and a cylinder of the triangle's height along its normal.
std::array<VisibilityQuery, 3> bounds_of(const TriangleMesh& mesh, const Triangle& triangle) {
  const glm::vec3 a = mesh.positions[triangle.x], b = mesh.positions[triangle.y], c = mesh.positions[triangle.z];
  const glm::vec3 low = glm::min(glm::min(a, b), c), high = glm::max(glm::max(a, b), c);
  const glm::vec3 center = (a + b + c) / 3.0F;
  const float radius = glm::max(glm::max(glm::distance(center, a), glm::distance(center, b)), glm::distance(center, c));
  const glm::vec3 normal = glm::normalize(glm::cross(b - a, c - a));
  return {{{0, Box{low, high}},
           {0, Sphere{(low + high) / 2.0F, glm::distance(low, high) / 2.0F}},
           {0, Cylinder{center, radius, normal, -radius / 8.0F, radius / 8.0F}}}};
}

Scene make_scene(const Options& options) {
  Camera camera;
  camera.eye = {0.0, 0.0, 3.0};
  camera.width = options.width;
  camera.height = options.height;
  camera.near = 0.1;
  camera.far = 10.0;
  Scene scene{load_bench_mesh(fmt::format("planet:{}", options.level)), View(camera), {}};
  std::mt19937 random(1);
  for (int i = 0; i < options.questions; ++i) {
    const auto bounds = bounds_of(scene.planet, scene.planet.triangles[random() % scene.planet.triangles.size()]);
    for (std::size_t shape = 0; shape < bounds.size(); ++shape) scene.questions[shape].push_back(bounds[shape]);
  }
  return scene;
}

struct Contestant {
  std::string name;
  std::string settings;
  std::unique_ptr<Visibility> visibility;
  std::vector<double> occluder_ms;
  std::array<std::vector<double>, 3> ms;
  std::array<int, 3> hidden{};
};

Contestant query(const std::shared_ptr<gl::Context>& context, std::size_t flight, std::size_t window, int divisor,
                 gl::QueryTarget target = gl::QueryTarget::any) {
  constexpr std::array<const char*, 3> target_names{"", ", conservative", ", counting"};
  return {"gl-query",
          fmt::format("flight {}, window {}{}{}", flight, window == 0 ? "measured" : std::to_string(window),
                      divisor == 1 ? "" : fmt::format(", divisor {}", divisor),
                      target_names[static_cast<std::size_t>(target)]),
          gl::make_query_occlusion(context, {flight, window, target, divisor}),
          {},
          {},
          {}};
}

std::vector<Contestant> contestants(const std::shared_ptr<gl::Context>& context) {
  std::vector<Contestant> list;
  list.push_back({"software", "", make_software_occlusion(), {}, {}, {}});
  for (const std::size_t window : {1U, 8U, 64U}) list.push_back(query(context, window, window, 1));
  for (const std::size_t window : {1U, 8U, 0U}) list.push_back(query(context, 64, window, 1));
  for (const int divisor : {2, 4}) list.push_back(query(context, 64, 0, divisor));
  list.push_back(query(context, 64, 0, 1, gl::QueryTarget::any_conservative));
  list.push_back(query(context, 64, 0, 1, gl::QueryTarget::count));
  return list;
}

// As refinement asks: a flight under way, the oldest collected when it is full.
int ask(Visibility& visibility, const std::vector<VisibilityQuery>& questions) {
  int hidden = 0;
  std::size_t under_way = 0;
  const auto collect = [&] {
    hidden += visibility.collect() == 0 ? 1 : 0;
    --under_way;
  };
  for (const VisibilityQuery& question : questions) {
    if (under_way >= visibility.flight()) collect();
    visibility.submit(question);
    ++under_way;
  }
  while (under_way > 0) collect();
  return hidden;
}

void measure(Contestant& contestant, const Scene& scene, bool keep) {
  const std::array<ObjectView, 1> objects{ObjectView(scene.view, glm::dmat4(1.0))};
  const std::array<OccluderPart, 1> parts{{{0, scene.planet.positions, scene.planet.triangles}}};
  Visibility& visibility = *contestant.visibility;
  visibility.begin_view(scene.view, objects);
  const tool::Stopwatch drawing;
  visibility.draw_occluder(parts);
  // OpenGL draws when somebody wants to know: the first answer waits for the occluder.
  ask(visibility, {scene.questions[0].front()});
  if (keep) contestant.occluder_ms.push_back(drawing.milliseconds());
  for (std::size_t shape = 0; shape < contestant.ms.size(); ++shape) {
    const tool::Stopwatch asking;
    contestant.hidden[shape] = ask(visibility, scene.questions[shape]);
    if (keep) contestant.ms[shape].push_back(asking.milliseconds());
  }
}

void run(const Options& options) {
  const std::shared_ptr<gl::Context> context =
      gl::create_context(options.platform == "egl" ? gl::Platform::egl : gl::Platform::osmesa);
  const Scene scene = make_scene(options);
  std::vector<Contestant> list = contestants(context);
  // Rounds in which each has its turn, so that a change of the machine's pace meets all.
  for (int round = 0; round <= options.repeat; ++round)
    for (Contestant& contestant : list) measure(contestant, scene, round > 0);
  fmt::print("{}, {}, OpenGL {}; {} triangles, {} questions, {}x{}\n\n", context->platform_name(), context->renderer(),
             context->version(), scene.planet.triangles.size(), options.questions, options.width, options.height);
  fmt::print(
      "| backend | settings | occluder ms | box ms | sphere ms | cylinder ms | box hidden % | sphere % | cylinder % "
      "|\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|\n");
  for (const Contestant& contestant : list) {
    fmt::print("| {} | {} | {:.2f} |", contestant.name, contestant.settings, median(contestant.occluder_ms));
    for (const auto& ms : contestant.ms) fmt::print(" {:.2f} |", median(ms));
    for (const int hidden : contestant.hidden) fmt::print(" {:.1f} |", 100.0 * hidden / options.questions);
    fmt::print("\n");
  }
}

int run(int argc, char** argv) {
  CLI::App app("What questions about occlusion cost.", "bench_gl_occlusion");
  Options options;
  app.add_option("--platform", options.platform, "egl or osmesa")
      ->capture_default_str()
      ->check(CLI::IsMember({"egl", "osmesa"}));
  app.add_option("--level", options.level, "Of the planet: 8 * 4^level triangles")->capture_default_str();
  app.add_option("--questions", options.questions, "Bounds of each kind")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--width", options.width, "Pixels")->capture_default_str();
  app.add_option("--height", options.height, "Pixels")->capture_default_str();
  add_repeat_option(app, options.repeat, "Rounds after the first");
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
