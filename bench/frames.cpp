// Along camera paths: refinement from scratch and from frame to frame, side by side.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "accuracy.h"
#include "base/timing.h"
#include "drawing.h"
#include "frames_vdpm.h"
#include "json_output.h"
#include "occlod/base.h"
#include "occlod/refiner.h"
#include "occlod/scene.h"
#include "occlod/visibility.h"
#include "oracle/cut_error.h"
#include "refine/tuning.h"
#include "render_input.h"
#include "support/frame_log.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

struct Options {
  std::vector<std::string> scenes = {"armadillo", "armadillo_group", "planet_full", "planet_near",
                                     "sponza",    "sibenik",         "city",        "ww2_city"};
  std::vector<std::string> tables = {"scenes", "vdpm"};
  std::string path;
  std::vector<std::size_t> budgets = {10'000};
  int max_frames = 120;
  int repeat = 1;
  bool quality = true;
  std::filesystem::path json;
};

// What tells what is hidden: nothing, an occluder, or the picture of the frame before.
enum class Occlusion { none, software, picture };
constexpr std::array occlusions = {Occlusion::none, Occlusion::software, Occlusion::picture};

// What is compared: a path, a budget, and what is culled.
struct Subject {
  std::string scene, path_name;
  const CameraPath* path = nullptr;
  const std::vector<LoadedObject>* objects = nullptr;
  RefineOptions options;
  Occlusion occlusion = Occlusion::none;
};

// Of each frame of a path.
struct Comparison {
  std::vector<double> scratch_ms, scratch_cpu_ms;
  std::vector<FrameLog> rounds;  // from frame to frame
  std::vector<double> changed_triangles;
  // Empty where quality is not compared.
  std::vector<double> error_ratios;                  // from frame to frame / from scratch
  std::vector<double> scratch_shares, frame_shares;  // of triangles that own a pixel
  std::vector<double> scratch_rms_px, frame_rms_px;  // of depths, against the full mesh
};

// Errors below a tenth of a pixel are all alike; both may be unlimited, where the eye is inside bounds.
double ratio_of(double a, double b) {
  constexpr double nobody_sees = 0.1;
  if (std::isinf(a) && std::isinf(b)) return 1.0;
  return std::max(a, nobody_sees) / std::max(b, nobody_sees);
}

// The largest in medians.
std::string unevenness(const std::vector<double>& values) {
  const double middle = later_percentile(values, 0.5);
  return middle > 0.0 ? fmt::format("{:.1f}", later_percentile(values, 1.0) / middle) : "";
}

// Of the triangles those that own a pixel.
double visible_share(const ItemBuffer& items, const Refinement& refinement) {
  const std::size_t triangles = refinement.stats.triangles;
  return static_cast<double>(count_visible_items(items, triangles)) /
         static_cast<double>(std::max<std::size_t>(triangles, 1));
}

// A backend for one way to refine.
class Sight {
 public:
  explicit Sight(const Subject& subject) : subject_(subject) {}

  [[nodiscard]] Visibility& backend() {
    return subject_.occlusion == Occlusion::none ? static_cast<Visibility&>(none_) : *software_;
  }
  // Shows the backend the frame, if the subject wants that. The time counts, but not that of drawing; one thread draws,
  // as others, which go on to wait for work, would count in what is timed next.
  void show(const Refinement& frame, const View& view, FrameLog& log) {
    if (subject_.occlusion != Occlusion::picture) return;
    draw_items(items_, tool::draw_objects(*subject_.objects, frame), view, 1);
    const FrameTimer timer;
    software_->show(items_.depth);
    const FrameTime time = timer.elapsed();
    log.ms.back() += time.ms;
    log.cpu_ms.back() += time.cpu_ms;
  }

 private:
  const Subject& subject_;
  std::unique_ptr<SoftwareOcclusion> software_ = make_software_occlusion();
  NoOcclusion none_;
  ItemBuffer items_;
};

class PathComparison {
 public:
  PathComparison(const Options& options, const Subject& subject)
      : options_(options), subject_(subject), objects_(tool::refine_objects(*subject.objects)), judge_(subject) {}

  [[nodiscard]] Comparison run() {
    compare_both();
    for (int round = 1; round < options_.repeat; ++round) time_frames();
    return std::move(result_);
  }

 private:
  [[nodiscard]] int count() const { return std::min(subject_.path->frames, options_.max_frames); }
  [[nodiscard]] View view(int frame) const { return View(camera_at(*subject_.path, frame)); }

  // One and the other in turns, frame by frame.
  void compare_both() {
    RefinerLog scratch(objects_), frames(objects_);
    Sight scratch_sight(subject_), frame_sight(subject_);
    for (int i = 0; i < count(); ++i) {
      scratch.step(view(i), subject_.options, scratch_sight.backend(), false);
      frames.step(view(i), subject_.options, frame_sight.backend(), true);
      frame_sight.show(*frames.last, view(i), frames.log);
      result_.changed_triangles.push_back(static_cast<double>(frames.last->stats.changed_triangles));
      if (options_.quality) compare_quality(*scratch.last, *frames.last, view(i));
    }
    result_.scratch_ms = scratch.log.ms;
    result_.scratch_cpu_ms = scratch.log.cpu_ms;
    result_.rounds.push_back(frames.log);
  }

  void compare_quality(const Refinement& scratch, const Refinement& frame, const View& view) {
    result_.error_ratios.push_back(ratio_of(oracle::cut_error(objects_, frame, view, judge_.backend()).quadric_px,
                                            oracle::cut_error(objects_, scratch, view, judge_.backend()).quadric_px));
    const tool::FullMeshPicture full(*subject_.objects, view);
    for (const auto& [refinement, shares, depth_rms_px] :
         {std::tuple(&scratch, &result_.scratch_shares, &result_.scratch_rms_px),
          std::tuple(&frame, &result_.frame_shares, &result_.frame_rms_px)}) {
      const std::vector<DrawObject> drawn = tool::draw_objects(*subject_.objects, *refinement);
      draw_items(items_, drawn, view, 1);
      shares->push_back(visible_share(items_, *refinement));
      depth_rms_px->push_back(full.distance_to(items_, drawn).depth_rms_px);
    }
  }

  void time_frames() {
    RefinerLog frames(objects_);
    Sight sight(subject_);
    for (int i = 0; i < count(); ++i) {
      frames.step(view(i), subject_.options, sight.backend(), true);
      sight.show(*frames.last, view(i), frames.log);
    }
    result_.rounds.push_back(frames.log);
  }

  const Options& options_;
  const Subject& subject_;
  std::vector<RefineObject> objects_;
  Sight judge_;
  ItemBuffer items_;
  Comparison result_;
};

// Of each frame the least of all rounds: other programs can only add to a time.
std::vector<double> least_of(const std::vector<FrameLog>& rounds, std::vector<double> FrameLog::*times) {
  std::vector<double> least = rounds.front().*times;
  for (const FrameLog& round : rounds)
    for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], (round.*times)[i]);
  return least;
}

double mean_square_root(const std::vector<double>& values) {
  return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0) /
                   static_cast<double>(values.size()));
}

double mean_percent(const std::vector<double>& shares) {
  return 100.0 * std::accumulate(shares.begin(), shares.end(), 0.0) / static_cast<double>(shares.size());
}

const char* culling_name(const Subject& subject) {
  return tuning_of(subject.options).culling == Culling::star ? "star" : "subtree";
}
const char* occlusion_name(const Subject& subject) {
  return std::array{"none", "software", "picture"}[static_cast<std::size_t>(subject.occlusion)];
}

void print_row(const Subject& subject, const Comparison& result) {
  const std::vector<double> ms = least_of(result.rounds, &FrameLog::ms);
  const FrameLog& log = result.rounds.front();
  fmt::print(
      "| {} | {} | {} | {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {} | {:.1f} | {:.0f} | {} | {:.0f} | {} | "
      "{:016x} "
      "|\n",
      subject.scene, subject.path_name, subject.options.budget, culling_name(subject), occlusion_name(subject),
      median(result.scratch_ms), later_percentile(ms, 0.5), later_percentile(ms, 0.95), later_percentile(ms, 1.0),
      longest_run_above(least_of(result.rounds, &FrameLog::cpu_ms), 2.0),
      median(result.scratch_ms) / std::max(later_percentile(ms, 0.5), 1e-3), later_percentile(log.changes, 0.5),
      unevenness(log.changes), later_percentile(result.changed_triangles, 0.5),
      result.error_ratios.empty()
          ? "| | | | | "
          : fmt::format("{:.3f} | {:.3f} | {:.1f} | {:.1f} | {:.3f} | {:.3f}", median(result.error_ratios),
                        later_percentile(result.error_ratios, 0.95), mean_percent(result.scratch_shares),
                        mean_percent(result.frame_shares), mean_square_root(result.scratch_rms_px),
                        mean_square_root(result.frame_rms_px)),
      log.hash);
  std::fflush(stdout);
}

tool::Json json_row(const Subject& subject, const Comparison& result) {
  tool::Json rounds = tool::Json::array();
  for (const FrameLog& round : result.rounds) rounds.push_back(round.cpu_ms);
  return {{"scene", subject.scene},
          {"path", subject.path_name},
          {"budget", subject.options.budget},
          {"culling", culling_name(subject)},
          {"occlusion", occlusion_name(subject)},
          {"scratch_cpu_ms", result.scratch_cpu_ms},
          {"frame_cpu_ms", std::move(rounds)},
          {"error_ratios", result.error_ratios},
          {"scratch_shares", result.scratch_shares},
          {"frame_shares", result.frame_shares},
          {"scratch_depth_rms_px", result.scratch_rms_px},
          {"frame_depth_rms_px", result.frame_rms_px},
          {"hash", fmt::format("{:016x}", result.rounds.front().hash)}};
}

void compare_path(const Options& options, const std::string& scene, const tool::RenderInput& input, tool::Json& rows) {
  const std::size_t least = Refiner(tool::refine_objects(input.objects)).base_triangles();
  for (const std::size_t budget : options.budgets)
    for (const Culling culling : {Culling::subtree, Culling::star})
      for (const Occlusion occlusion : occlusions) {
        Subject subject{scene, input.path_name, &*input.path, &input.objects, {}, occlusion};
        subject.options.budget = std::max(budget, least);
        tune(subject.options).culling = culling;
        const Comparison result = PathComparison(options, subject).run();
        print_row(subject, result);
        rows.push_back(json_row(subject, result));
      }
}

void write_json(const std::filesystem::path& path, const tool::Json& rows) {
  std::ofstream file(path);
  file << rows.dump() << '\n' << std::flush;
  if (!file) throw std::runtime_error(path.string() + ": cannot be written");
}

void compare_scenes(const Options& options) {
  tool::Json rows = tool::Json::array();
  fmt::print(
      "| scene | path | budget | culling | occlusion | scratch ms | frame ms | p95 | largest | above | times faster | "
      "changes | largest "
      "| "
      "changed triangles | error ratio | p95 | scratch share % | frame share % | "
      "scratch depth RMS px | frame depth RMS px | hash |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& scene : options.scenes) {
    tool::RenderInputOptions input;
    input.file = std::filesystem::path(OCCLOD_SCENES) / (scene + ".json");
    for (const auto& [name, path] : read_scene(input.file).paths) {
      if (!options.path.empty() && name != options.path) continue;
      input.path = name;
      try {
        compare_path(options, scene, tool::load_render_input(input), rows);
      } catch (const Error& error) {
        fmt::print(stderr, "SKIPPED: {}\n", error.what());
      }
    }
  }
  if (!options.json.empty()) write_json(options.json, rows);
}

void run(const Options& options) {
  const auto asked = [&](const char* table) {
    return std::find(options.tables.begin(), options.tables.end(), table) != options.tables.end();
  };
  if (asked("scenes")) compare_scenes(options);
  if (!asked("vdpm")) return;
#ifdef OCCLOD_HAS_OPENMESH
  compare_with_vdpm();
#else
  fmt::print(stderr, "SKIPPED: OpenMesh was not there when this was built\n");
#endif
}

int run(int argc, char** argv) {
  CLI::App app("Refinement from frame to frame along the paths of scenes.", "bench_frames");
  Options options;
  app.add_option("SCENES", options.scenes, "Names of scenes in meshes/scenes")->capture_default_str();
  app.add_option("--tables", options.tables, "Paths of scenes, and OpenMesh's VDPM beside ours")
      ->capture_default_str()
      ->check(CLI::IsMember({"scenes", "vdpm"}));
  app.add_option("--path", options.path, "Only paths of this name");
  app.add_option("--budgets", options.budgets, "Triangles")->capture_default_str();
  app.add_option("--frames", options.max_frames, "Of each path at most")->capture_default_str();
  app.add_option("--repeat", options.repeat, "Rounds from frame to frame; of each frame the least time counts")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_flag("!--no-errors", options.quality,
               "Compare neither errors nor visible shares, which takes longer than all else");
  app.add_option("--json", options.json, "Write the scenes' table, with every frame, as JSON");
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
