// bench_limit: what the parts of refinement from scratch take by themselves, each done once and in its best order,
// beside what the whole takes.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "base/timing.h"
#include "occlod/refiner.h"
#include "occlod/visibility.h"
#include "refine/cut.h"
#include "refine/star_visibility.h"
#include "refine/tuning.h"
#include "refine/weigh.h"
#include "render_input.h"
#include "stopwatch.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

struct Options {
  std::string scene = "armadillo";
  std::string path = "orbit";
  std::size_t budget = 10'000;
  int frames = 24;  // of the path, evenly
  int repeat = 9;
};

// Passes everything on to the software backend, and keeps what it was given in this view.
class RecordingVisibility final : public Visibility {
 public:
  struct Draw {
    std::uint32_t object = 0;
    std::span<const glm::vec3> positions;  // of the hierarchy
    std::vector<Triangle> triangles;
  };
  struct Points {
    std::uint32_t object = 0;
    std::vector<glm::vec3> points;
  };
  // Between one occluder and the next.
  struct Era {
    std::vector<Draw> parts;
    std::vector<std::vector<VisibilityQuery>> batches;
    std::vector<Points> points;
  };

  [[nodiscard]] std::string_view name() const noexcept override { return software_->name(); }
  void begin_view(const View& view, std::span<const ObjectView> objects) override {
    eras_.clear();
    hulls_.clear();
    software_->begin_view(view, objects);
  }
  void draw_occluder(std::span<const OccluderPart> parts) override {
    Era& era = eras_.emplace_back();
    for (const OccluderPart& part : parts)
      era.parts.push_back({part.object, part.positions, {part.triangles.begin(), part.triangles.end()}});
    software_->draw_occluder(parts);
  }
  void submit(const VisibilityQuery& query) override { software_->submit(query); }
  [[nodiscard]] std::uint32_t collect() override { return software_->collect(); }
  void answer(std::span<const VisibilityQuery> queries, std::span<std::uint32_t> answers) override {
    std::vector<VisibilityQuery>& batch = eras_.back().batches.emplace_back(queries.begin(), queries.end());
    for (VisibilityQuery& query : batch)
      if (auto* const hull = std::get_if<PointHull>(&query.shape)) {
        hulls_.push_back(std::make_unique<std::vector<glm::vec3>>(hull->points.begin(), hull->points.end()));
        hull->points = *hulls_.back();
      }
    software_->answer(queries, answers);
  }
  [[nodiscard]] bool tests_points() const noexcept override { return software_->tests_points(); }
  void find_visible_points(std::uint32_t object, std::span<const glm::vec3> points,
                           std::span<std::uint8_t> visible) override {
    eras_.back().points.push_back({object, {points.begin(), points.end()}});
    software_->find_visible_points(object, points, visible);
  }

  [[nodiscard]] const std::vector<Era>& eras() const noexcept { return eras_; }

 private:
  std::unique_ptr<Visibility> software_ = make_software_occlusion();
  std::vector<Era> eras_;
  std::vector<std::unique_ptr<std::vector<glm::vec3>>> hulls_;
};

// One kind of work: how much of it, and the least time of all rounds, for each frame.
struct Part {
  const char* what;
  const char* unit;
  std::vector<double> count = {}, ms = {};

  void add(std::size_t frame, double many, double milliseconds) {
    if (frame == count.size()) {
      count.push_back(many);
      ms.push_back(std::numeric_limits<double>::infinity());
    }
    ms[frame] = std::min(ms[frame], milliseconds);
  }
};

struct Parts {
  Part nodes{"testing nodes", "nodes"};
  Part stars{"looking at stars", "stars"};
  Part points{"testing vertices", "vertices"};
  Part questions{"testing bounds", "questions"};
  Part drawing{"drawing occluders", "triangles"};
  Part splits{"applying splits", "splits"};
  Part whole{"refinement", "triangles"};
};

struct Scene {
  std::vector<RefineObject> objects;
  const CameraPath* path = nullptr;
};

// The splits that a mesh has, and their children in the forest, which refinement must have looked at: in the order of
// memory.
std::vector<SplitId> reached(const Hierarchy& hierarchy, std::span<const SplitId> splits) {
  std::vector<SplitId> nodes(splits.begin(), splits.end());
  for (const SplitId s : splits)
    for (const SplitId child : {hierarchy.node(s).child_u, hierarchy.node(s).child_v})
      if (child != no_id) nodes.push_back(child);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

void time_nodes_and_splits(const Scene& scene, const View& view, const Refinement& refined, std::size_t frame,
                           Parts& parts) {
  double node_ms = 0.0, star_ms = 0.0, split_ms = 0.0;
  std::size_t nodes = 0, splits = 0;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const RefineObject& object = scene.objects[i];
    const ObjectView object_view(view, object.object_to_world);
    const std::vector<SplitId> ids = reached(*object.hierarchy, refined.objects[i].splits);
    std::vector<float> scales(ids.size());
    std::vector<StarView> stars(ids.size());
    StarVisibility visibility;
    Cut cut(*object.hierarchy);
    cut.clear();
    const tool::Stopwatch node_watch;
    weigh_splits(*object.hierarchy, ids, object_view, !object.two_sided, scales);
    node_ms += node_watch.milliseconds();
    const tool::Stopwatch star_watch;
    visibility.evaluate(*object.hierarchy, ids, object_view, object.two_sided, stars);
    star_ms += star_watch.milliseconds();
    const tool::Stopwatch split_watch;
    for (const SplitId s : refined.objects[i].splits) {
      static_cast<void>(cut.closure(s));
      cut.apply_closure();
    }
    std::vector<Triangle> triangles;
    cut.active_triangles(triangles, true);
    split_ms += split_watch.milliseconds();
    nodes += ids.size();
    splits += refined.objects[i].splits.size();
  }
  parts.nodes.add(frame, static_cast<double>(nodes), node_ms);
  parts.stars.add(frame, static_cast<double>(nodes), star_ms);
  parts.splits.add(frame, static_cast<double>(splits), split_ms);
}

void time_occlusion(const Scene& scene, const View& view, const RecordingVisibility& recorded, std::size_t frame,
                    Parts& parts) {
  const std::unique_ptr<Visibility> software = make_software_occlusion();
  std::vector<ObjectView> views;
  for (const RefineObject& object : scene.objects) views.emplace_back(view, object.object_to_world);
  double draw_ms = 0.0, question_ms = 0.0, point_ms = 0.0;
  std::size_t triangles = 0, questions = 0, points = 0;
  for (int pass = 0; pass < 2; ++pass) {  // the first one touches memory
    draw_ms = question_ms = point_ms = 0.0;
    triangles = questions = points = 0;
    software->begin_view(view, views);
    for (const RecordingVisibility::Era& era : recorded.eras()) {
      std::vector<OccluderPart> occluder;
      for (const RecordingVisibility::Draw& part : era.parts) {
        occluder.push_back({part.object, part.positions, part.triangles});
        triangles += part.triangles.size();
      }
      const tool::Stopwatch draw_watch;
      software->draw_occluder(occluder);
      draw_ms += draw_watch.milliseconds();
      std::vector<std::uint32_t> answers;
      for (const std::vector<VisibilityQuery>& batch : era.batches) {
        answers.resize(batch.size());
        const tool::Stopwatch question_watch;
        software->answer(batch, answers);
        question_ms += question_watch.milliseconds();
        questions += batch.size();
      }
      std::vector<std::uint8_t> visible;
      for (const RecordingVisibility::Points& batch : era.points) {
        visible.resize(batch.points.size());
        const tool::Stopwatch point_watch;
        software->find_visible_points(batch.object, batch.points, visible);
        point_ms += point_watch.milliseconds();
        points += batch.points.size();
      }
    }
  }
  parts.drawing.add(frame, static_cast<double>(triangles), draw_ms);
  parts.questions.add(frame, static_cast<double>(questions), question_ms);
  parts.points.add(frame, static_cast<double>(points), point_ms);
}

void print(const char* way, const Parts& parts) {
  const double whole = median(parts.whole.ms);
  double sum = 0.0;
  const auto row = [&](const Part& part, double ms) {
    const double count = median(part.count);
    fmt::print("| {} | {} | {:.0f} {} | {:.0f} | {:.3f} | {:.0f} |\n", way, part.what, count, part.unit,
               count > 0.0 ? 1e6 * ms / count : 0.0, ms, 100.0 * ms / whole);
  };
  for (const Part* const part :
       {&parts.nodes, &parts.stars, &parts.points, &parts.questions, &parts.drawing, &parts.splits}) {
    if (part->count.empty() || median(part->count) == 0.0) continue;
    const double ms = median(part->ms);
    row(*part, ms);
    sum += ms;
  }
  fmt::print("| {} | all of these | | | {:.3f} | {:.0f} |\n", way, sum, 100.0 * sum / whole);
  row(parts.whole, whole);
}

void compare(const Options& options, const Scene& scene, const char* way, Culling culling, bool occlusion) {
  Parts parts;
  RefineOptions refine;
  refine.budget = options.budget;
  tune(refine).culling = culling;
  const std::unique_ptr<Visibility> software = make_software_occlusion();
  NoOcclusion none;
  RecordingVisibility recording;
  Refiner timed(scene.objects), recorded(scene.objects);
  for (int round = 0; round < options.repeat; ++round)
    for (int i = 0; i < options.frames; ++i) {
      const auto frame = static_cast<std::size_t>(i);
      const View view(camera_at(*scene.path, i * scene.path->frames / options.frames));
      const tool::Stopwatch watch;
      const Refinement& refined = timed.refine(view, refine, occlusion ? *software : static_cast<Visibility&>(none));
      parts.whole.add(frame, static_cast<double>(refined.stats.triangles), watch.milliseconds());
      time_nodes_and_splits(scene, view, refined, frame, parts);
      if (!occlusion) continue;
      static_cast<void>(recorded.refine(view, refine, recording));
      time_occlusion(scene, view, recording, frame, parts);
    }
  if (culling == Culling::subtree) parts.stars = {"", ""};
  print(way, parts);
}

void run(const Options& options) {
  tool::RenderInputOptions input_options;
  input_options.file = std::filesystem::path(OCCLOD_SCENES) / (options.scene + ".json");
  input_options.path = options.path;
  const tool::RenderInput input = tool::load_render_input(input_options);
  Scene scene{{}, &*input.path};
  for (const LoadedObject& object : input.objects)
    scene.objects.push_back({object.hierarchy.get(), object.object_to_world, object.two_sided});
  fmt::print("| way | what | how much | ns each | ms | % |\n|---|---|---|---|---|---|\n");
  compare(options, scene, "subtree", Culling::subtree, false);
  compare(options, scene, "star", Culling::star, false);
  compare(options, scene, "subtree+software", Culling::subtree, true);
  compare(options, scene, "star+software", Culling::star, true);
}

int run(int argc, char** argv) {
  CLI::App app("How far refinement from scratch is from the sum of its parts.", "bench_limit");
  Options options;
  app.add_option("--scene", options.scene, "A name in meshes/scenes")->capture_default_str();
  app.add_option("--path", options.path, "A path of the scene")->capture_default_str();
  app.add_option("--budget", options.budget, "Triangles")->capture_default_str();
  app.add_option("--frames", options.frames, "Frames of the path, evenly")->capture_default_str();
  add_repeat_option(app, options.repeat, "Rounds, of which the least time of each part counts");
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
