// Tables 1 and 2 of Birkholz & Rahn for all scenes, what the picture gains, and what the paper's LOD would need for it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "accuracy.h"
#include "refine/tuning.h"
#include "visibility/subjects.h"

namespace occlod::bench {
namespace {

using tool::Json;

struct Way {
  const char* name;
  const char* key;
  Culling culling;
  bool occlusion;
};
constexpr std::array ways = {Way{"paper's LOD", "lod", Culling::subtree, false},
                             Way{"paper's LOD + occlusion", "lod_oc", Culling::subtree, true},
                             Way{"ours, no occlusion", "ours", Culling::star, false},
                             Way{"ours + occlusion", "ours_oc", Culling::star, true}};

Share measure(SceneRun& run, const Way& way, std::size_t budget) {
  Visibility& visibility = way.occlusion ? *run.software : run.none;
  return measure_share(run.with, run.view, refine_options(budget, way.culling), visibility);
}

void add_table_2(Table& table, SceneRun& run, const VisibilityOptions& options) {
  if (!run.is_decided_by(options.table_budget)) return;
  Json row = {{"scene", run.description.name}};
  std::size_t start = 0;
  for (const Way& way : ways) {
    const Share share = measure(run, way, options.table_budget);
    row[way.key] = share.visible;
    if (&way == ways.data())
      start = share.visible;
    else
      row[std::string(way.key) + "_ir"] = improvement(share.visible, start);
  }
  table.add(std::move(row));
}

void add_quality(Table& table, SceneRun& run, const VisibilityOptions& options) {
  if (!run.is_decided_by(options.table_budget)) return;
  const tool::FullMeshPicture full(run.objects, run.view);
  for (const Way& way : ways) {
    const Share share = measure(run, way, options.table_budget);
    const PictureDistance distance = full.distance_to(run.with.items(), run.with.objects());
    const RefineStats& stats = run.with.refinement().stats;
    table.add({{"scene", run.description.name},
               {"way", way.name},
               {"budget", options.table_budget},
               {"triangles", share.triangles},
               {"visible", share.visible},
               {"share", share.percent()},
               {"queries", stats.queries},
               {"depth_rms_px", distance.depth_rms_px},
               {"silhouette_mismatch", distance.silhouette_mismatch},
               {"psnr_y", distance.psnr_y},
               {"hash", share.hash}});
  }
}

double depth_rms(SceneRun& run, const tool::FullMeshPicture& full, const Way& way, std::size_t budget) {
  (void)measure(run, way, budget);
  return full.distance_to(run.with.items(), run.with.objects()).depth_rms_px;
}

// The smallest budget, to a hundredth, at which the way's error is no larger than `rms`, as if errors never grew with
// the budget; nothing when even a budget for all triangles leaves more.
std::optional<std::size_t> budget_for(SceneRun& run, const tool::FullMeshPicture& full, const Way& way, double rms) {
  std::size_t too_small = run.base_triangles();
  std::size_t enough = run.full_triangles();
  if (depth_rms(run, full, way, enough) > rms) return {};
  while (static_cast<double>(enough) > 1.01 * static_cast<double>(too_small) && enough - too_small > 1) {
    const auto middle =
        static_cast<std::size_t>(std::sqrt(static_cast<double>(too_small) * static_cast<double>(enough)));
    (depth_rms(run, full, way, middle) > rms ? too_small : enough) = middle;
  }
  return enough;
}

void add_equal_error(Table& table, SceneRun& run, const VisibilityOptions& options) {
  if (!run.is_decided_by(options.table_budget)) return;
  const tool::FullMeshPicture full(run.objects, run.view);
  const double ours = depth_rms(run, full, ways[3], options.table_budget);
  Json row = {{"scene", run.description.name}, {"budget", options.table_budget}, {"depth_rms_px", ours}};
  for (const Way& way : {ways[0], ways[1], ways[2]}) {
    const std::optional<std::size_t> budget = budget_for(run, full, way, ours);
    if (!budget) continue;
    row[way.key] = *budget;
    row[std::string(way.key) + "_times"] = static_cast<double>(*budget) / static_cast<double>(options.table_budget);
  }
  table.add(std::move(row));
}

void add_meshes(Table& table, SceneRun& run, const VisibilityOptions&) {
  std::size_t vertices = 0, bytes = 0;
  std::vector<const Hierarchy*> seen;  // objects may share one
  for (const LoadedObject& object : run.objects) {
    vertices += object.hierarchy->vertex_count();
    if (std::find(seen.begin(), seen.end(), object.hierarchy.get()) != seen.end()) continue;
    seen.push_back(object.hierarchy.get());
    bytes += object.hierarchy->bytes();
  }
  table.add({{"scene", run.description.name},
             {"objects", run.objects.size()},
             {"vertices", vertices},
             {"triangles", run.full_triangles()},
             {"base_triangles", run.base_triangles()},
             {"bytes", bytes},
             {"megabytes", static_cast<double>(bytes) / 1e6}});
}

std::string at_budget(const char* what, std::size_t budget) { return fmt::format(fmt::runtime(what), cell(budget, 0)); }

}  // namespace

Subject meshes_subject() {
  return {{"meshes",
           "Table 1: the scenes' meshes. MB: hierarchies in memory, each once however many objects share it.",
           {{"scene", "scene"},
            {"objects", "objects"},
            {"vertices", "vertices"},
            {"triangles", "triangles"},
            {"base_triangles", "base triangles"},
            {"bytes", ""},
            {"megabytes", "MB", 1}},
           {}},
          add_meshes};
}

Subject table_2_subject(const VisibilityOptions& options) {
  return {
      {"table_2",
       at_budget("Table 2: visible triangles of {}, which own a pixel; IR: improvement over the paper's LOD without "
                 "occlusion, %.",
                 options.table_budget),
       {{"scene", "scene"},
        {"lod", "paper's LOD"},
        {"lod_oc", "+ occlusion"},
        {"lod_oc_ir", "IR", 1},
        {"ours", "ours, no occlusion"},
        {"ours_ir", "IR", 1},
        {"ours_oc", "ours + occlusion"},
        {"ours_oc_ir", "IR", 1}},
       {}},
      add_table_2};
}

Subject quality_subject(const VisibilityOptions& options) {
  return {{"quality",
           at_budget(
               "The same {} triangles against the full mesh: depth RMS, px; silhouette mismatch, %; PSNR of luma, dB.",
               options.table_budget),
           {{"scene", "scene"},
            {"way", "way"},
            {"budget", ""},
            {"triangles", "triangles"},
            {"visible", "visible"},
            {"share", "share %", 1},
            {"queries", "queries"},
            {"depth_rms_px", "depth RMS", 3},
            {"silhouette_mismatch", "silhouette", 3},
            {"psnr_y", "PSNR", 1},
            {"hash", ""}},
           {}},
          add_quality};
}

Subject equal_error_subject(const VisibilityOptions& options) {
  return {
      {"equal_error",
       at_budget("Triangles that the others need for the depth RMS that ours + occlusion has with {} (bisection of the "
                 "budget to 1 %).",
                 options.table_budget),
       {{"scene", "scene"},
        {"budget", ""},
        {"depth_rms_px", "depth RMS", 3},
        {"lod", "paper's LOD"},
        {"lod_times", "times", 1},
        {"lod_oc", "+ occlusion"},
        {"lod_oc_times", "times", 1},
        {"ours", "ours, no occlusion"},
        {"ours_times", "times", 1}},
       {}},
      add_equal_error};
}

}  // namespace occlod::bench
