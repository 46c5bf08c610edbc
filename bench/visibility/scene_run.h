// What all subjects of bench_visibility work on: a loaded scene in its default view.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "measurement.h"
#include "occlod/refiner.h"
#include "occlod/scene.h"
#include "occlod/view.h"
#include "refine/tuning.h"
#include "render_input.h"

namespace occlod::bench {

struct VisibilityOptions {
  std::vector<std::size_t> budgets = {1'000, 10'000, 100'000, 1'000'000};
  std::size_t table_budget = 10'000;      // the paper's
  int repeat = 5;                         // times are medians of so many rounds
  int share_frames = 8;                   // of each path at most, for shares
  int views = 200;                        // random ones, for wrongly hidden pixels
  int paper_views = 500;                  // random ones, among which those as difficult as the paper's are kept
  int path_frames = 40;                   // of each path at most, likewise
  std::optional<tool::ImageSize> size;    // of pictures instead of the cameras' own
  tool::ImageSize hidden_size{512, 384};  // for wrongly hidden pixels
  std::filesystem::path out;              // folder; empty = nothing is written
};

struct SceneRun {
  SceneDescription description;
  std::vector<LoadedObject> objects;
  View view;  // of the default camera
  tool::Measurement without;
  tool::Measurement with;
  NoOcclusion none;
  std::unique_ptr<Visibility> software;

  SceneRun(SceneDescription scene, tool::RenderInput input);
  SceneRun(const SceneRun&) = delete;  // the measurements refer to the objects
  SceneRun& operator=(const SceneRun&) = delete;

  [[nodiscard]] std::size_t base_triangles() const { return with.refiner().base_triangles(); }
  [[nodiscard]] std::size_t full_triangles() const { return with.refiner().full_triangles(); }
  // Larger than the base meshes and smaller than the full ones: the budget decides.
  [[nodiscard]] bool is_decided_by(std::size_t budget) const {
    return base_triangles() < budget && budget < full_triangles();
  }
};

// "planet_full" is a scene that comes with the project, anything that ends in .json a file.
[[nodiscard]] std::filesystem::path scene_file(const std::string& name);
// With pictures of `size` instead of the cameras' own. Nothing when a mesh is missing, with a line on standard error.
// Throws Error for a bad scene.
[[nodiscard]] std::unique_ptr<SceneRun> load_scene(const std::filesystem::path& file,
                                                   const std::optional<tool::ImageSize>& size);

// One of the ways to refine that are compared.
struct Variant {
  std::string name;
  RefineOptions options;
};

// Refines and draws once, and tells the share of triangles that own a pixel, in percent.
struct Share {
  std::size_t triangles = 0;
  std::size_t visible = 0;
  std::string hash;
  [[nodiscard]] double percent() const;
};
[[nodiscard]] Share measure_share(tool::Measurement& measurement, const View& view, const RefineOptions& options,
                                  Visibility& visibility);

// By how many percent more triangles are visible than at the start.
[[nodiscard]] double improvement(std::size_t visible, std::size_t start);

// With Culling::subtree the paper's own choices: cylinders, occluders after 300 and 2,500 splits, no final check.
[[nodiscard]] RefineOptions refine_options(std::size_t budget, Culling culling);

}  // namespace occlod::bench
