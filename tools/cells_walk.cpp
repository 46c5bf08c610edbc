// Implements `occlod cells walk FILE.vlod SCENE --path NAME`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/timing.h"
#include "cell_walk.h"
#include "cells.h"
#include "chosen_views.h"
#include "command_files.h"
#include "global_options.h"
#include "object_textures.h"
#include "occlod/base.h"
#include "occlod/visibility.h"
#include "option_values.h"
#include "peak_bytes.h"
#include "standard_streams.h"

namespace occlod::tool {
namespace {

constexpr std::size_t most_refined = 1'000'000;  // maximum for refinement, even if the tolerance needs more
constexpr std::uint64_t max_compared = 1'000'000;

struct Options {
  std::filesystem::path file, scene, png;
  ViewOptions view;
  CellWalkOptions walk;
  int compared_frames = 0;
  bool use_cache = true;
  bool json = false;
};

// Compares with the full mesh, and with refinement to the same tolerance.
class Comparison {
 public:
  Comparison(std::span<const RefineObject> objects, double tolerance_px)
      : objects_(objects), reference_(objects), refiner_(objects), visibility_(make_software_occlusion()) {
    options_.tolerance_px = tolerance_px;
  }

  // Refines this frame, so that the next one can follow it.
  void follow(const View& view) { static_cast<void>(refiner_.update(view, options_, *visibility_)); }

  [[nodiscard]] Json compare(const View& view, const ItemBuffer& items, double error_px) {
    reference_.set_view(view);
    const auto walked = reference_.compare(view, items.depth, error_px);
    const Refinement& refined = refiner_.update(view, options_, *visibility_);
    std::vector<DrawObject> drawn;
    for (std::size_t i = 0; i < objects_.size(); ++i)
      drawn.push_back(
          {objects_[i].hierarchy->positions(), {}, refined.objects[i].triangles, objects_[i].object_to_world});
    draw_items(items_, drawn, view);
    const auto by_refiner = reference_.compare(view, items_.depth, options_.tolerance_px);
    return {{"unexplained_px", walked.unexplained_px},
            {"depth_rms_px", walked.depth_rms_px},
            {"update",
             {{"triangles", refined.stats.triangles},
              {"refine_ms", refined.stats.refine_ms},
              {"occlusion_ms", refined.stats.occlusion_ms},
              {"unexplained_px", by_refiner.unexplained_px},
              {"depth_rms_px", by_refiner.depth_rms_px}}}};
  }

 private:
  std::span<const RefineObject> objects_;
  WalkReference reference_;
  Refiner refiner_;
  std::unique_ptr<Visibility> visibility_;
  RefineOptions options_{.budget = most_refined};
  ItemBuffer items_;
};

Json to_json(int number, const CellWalkFrame& frame) {
  const WalkedFrame& walked = frame.walked;
  return {{"frame", number},
          {"cell", walked.cell},
          {"shown", walked.shown},
          {"outside", walked.outside},
          {"crossed", walked.crossed},
          {"changed", walked.changed},
          {"late", walked.late},
          {"missing", walked.missing},
          {"error_px", walked.error_px},
          {"triangles", walked.drawn_triangles},
          {"drawn_triangles", frame.view_triangles},
          {"hash", fmt::format("{:016x}", frame.hash)},
          {"loads", walked.loads},
          {"bytes_read", walked.bytes_read},
          {"resident_bytes", walked.resident_bytes},
          {"step_ms", frame.step_ms},
          {"cull_ms", frame.cull_ms},
          {"draw_ms", frame.draw_ms},
          {"load_ms", frame.load_ms}};
}

void print_header() {
  fmt::print("{:>6} {:>7} {:>7} {:>5} {:>9} {:>9} {:>9} {:>10} {:>10} {:>8} {:>8} {:>8}\n", "frame", "cell", "shown",
             "late", "error px", "triangles", "drawn", "read", "resident", "step ms", "cull ms", "draw ms");
}

void print_row(const Json& frame) {
  fmt::print("{:>6} {:>7} {:>7} {:>5} {:>9.3g} {:>9} {:>9} {:>10} {:>10} {:>8.3f} {:>8.3f} {:>8.2f}\n",
             frame["frame"].get<int>(), frame["cell"].get<CellId>(), frame["shown"].get<CellId>(),
             frame["missing"].get<bool>() ? "never"
             : frame["late"].get<bool>()  ? "late"
                                          : "",
             frame["error_px"].get<double>(), frame["triangles"].get<std::size_t>(),
             frame["drawn_triangles"].get<std::size_t>(), frame["bytes_read"].get<std::uint64_t>(),
             frame["resident_bytes"].get<std::size_t>(), frame["step_ms"].get<double>(), frame["cull_ms"].get<double>(),
             frame["draw_ms"].get<double>());
}

std::size_t count_of(const Json& frames, const char* key) {
  return static_cast<std::size_t>(
      std::count_if(frames.begin(), frames.end(), [&](const Json& frame) { return frame[key].get<bool>(); }));
}

double median_of(const Json& frames, const char* key) {
  std::vector<double> values;
  for (const Json& frame : frames) values.push_back(frame[key].get<double>());
  return median(values);
}

double largest_of(const Json& frames, const char* key) {
  double largest = 0.0;
  for (const Json& frame : frames) largest = std::max(largest, frame[key].get<double>());
  return largest;
}

Json summary_of(const Json& frames) {
  std::uint64_t bytes = 0, unexplained = 0, compared = 0;
  for (const Json& frame : frames) {
    bytes += frame["bytes_read"].get<std::uint64_t>();
    if (!frame.contains("unexplained_px")) continue;
    ++compared;
    unexplained += frame["unexplained_px"].get<std::uint64_t>();
  }
  Json summary = {{"frames", frames.size()},
                  {"crossings", count_of(frames, "crossed")},
                  {"late", count_of(frames, "late")},
                  {"missing", count_of(frames, "missing")},
                  {"outside", count_of(frames, "outside")},
                  {"error_px_max", largest_of(frames, "error_px")},
                  {"triangles_median", median_of(frames, "triangles")},
                  {"drawn_triangles_median", median_of(frames, "drawn_triangles")},
                  {"drawn_triangles_max", largest_of(frames, "drawn_triangles")},
                  {"bytes_read", bytes},
                  {"resident_bytes_max", largest_of(frames, "resident_bytes")},
                  {"step_ms_median", median_of(frames, "step_ms")},
                  {"step_ms_max", largest_of(frames, "step_ms")},
                  {"draw_ms_median", median_of(frames, "draw_ms")}};
  if (compared > 0) {
    summary["frames_compared"] = compared;
    summary["unexplained_px"] = unexplained;
  }
  return summary;
}

CameraPath walked_path(const Options& options, const SceneDescription& scene) {
  const CameraPath path = chosen_path(scene, options.view);
  for (int i = 0; i < path.frames; ++i)
    if (View(camera_at(path, i)).is_orthographic())
      throw Error({options.scene.string(), "/paths/" + options.view.path, "has no eye in an orthographic frame",
                   "name a path in perspective"});
  return path;
}

// Returns, per object, where names of images start.
std::vector<std::filesystem::path> mesh_folders(const SceneDescription& scene, const std::filesystem::path& file) {
  std::vector<std::filesystem::path> folders;
  for (const SceneObject& object : scene.objects) {
    std::filesystem::path& folder = folders.emplace_back();
    const auto* const mesh = std::get_if<MeshFile>(&object.source);
    if (mesh == nullptr) continue;
    for (const std::string& name : mesh->names)
      if (folder.empty()) folder = find_mesh(name, file.parent_path()).parent_path();
  }
  return folders;
}

void run(Options options) {
  const SceneDescription description = describe_file(options.scene);
  CommandFiles files;
  files.add_input("the cells", options.file);
  files.add_input("the scene", options.scene);
  if (!options.png.empty()) files.add_output("--png", options.png, ".png");
  const CameraPath path = walked_path(options, description);
  auto file = open_vlod(options.file);  // first, because the scene takes longer
  CellScene scene;
  if (!file->is_packed() || options.compared_frames > 0) {
    scene = load_cell_scene(description, options.scene, options.use_cache);
    auto with_objects = open_vlod(options.file, scene.objects, scene.names);
    if (!file->is_packed()) file = std::move(with_objects);
  }
  CellWalk walk(file, file->is_packed() ? std::span<const RefineObject>() : scene.objects, options.walk);
  std::optional<Comparison> comparison;
  if (options.compared_frames > 0) comparison.emplace(scene.objects, file->options().cell.tolerance_px);
  Json frames = Json::array();
  if (!options.json) print_header();
  for (int i = 0; i < path.frames; ++i) {
    const CellWalkFrame& frame = walk.go_to(camera_at(path, i));
    for (const std::string& line : frame.walked.notes) print_note(line);
    frames.push_back(to_json(i, frame));
    const View view(frame.camera);
    if (is_compared(i, options.compared_frames, path.frames))
      frames.back().update(
          comparison->compare(view, walk.items(), std::max(file->options().cell.tolerance_px, frame.walked.error_px)));
    else if (is_compared(i + 1, options.compared_frames, path.frames))
      comparison->follow(view);
    if (!options.json) print_row(frames.back());
  }
  if (!options.png.empty()) {
    const WalkTextures textures(walk.walked(), mesh_folders(description, options.scene));
    write_png(options.png, shade(walk.items(), walk.drawn(), View(camera_at(path, path.frames - 1)),
                                 {.textures = textures.of(walk.ranges())}));
  }
  Json result = {{"file", options.file.string()},
                 {"scene", options.scene.string()},
                 {"path", options.view.path},
                 {"cells", file->tree().leaf_count()},
                 {"packed", file->is_packed()}};
  result.update(summary_of(frames));
  result["peak_bytes"] = peak_bytes();
  if (options.json) {
    result["frame"] = std::move(frames);
    print_json(result);
  } else {
    fmt::print("\n");
    print_lines(result);
  }
}

}  // namespace

void add_cells_walk(CLI::App& cells) {
  CLI::App& command = *cells.add_subcommand("walk", "Walk along a camera path, and tell of each frame");
  const auto options = std::make_shared<Options>();
  add_file(command, "FILE", options->file, "Cells to walk through, .vlod")->required();
  add_file(command, "SCENE", options->scene, "Scene (.json) that they were built of; of a packed file only its path")
      ->required();
  add_name(command, "--path", options->view.path, "Camera path of the scene; a frame is a sixtieth of a second")
      ->required();
  add_size_option(command, options->view);
  add_memory(command, options->walk.memory, "1", "Keep no more than so many bytes of cells in memory")
      ->default_str("256M");
  command.add_flag_callback(
      "--no-prefetch", [options] { options->walk.prefetch = false; }, "Load cells only when the eye is in them");
  add_number(
      command, "--reference", options->compared_frames, WholeRange{0, max_compared},
      "Compare so many frames, spread evenly, with the full mesh, and with refinement from frame to frame to the "
      "same tolerance; 0: none")
      ->capture_default_str();
  add_file(command, "--png", options->png, "Write a picture of the last frame");
  command.callback([options, &command] {
    read_global_options(command, {.json = &options->json, .use_cache = &options->use_cache});
    run(*options);
  });
}

}  // namespace occlod::tool
