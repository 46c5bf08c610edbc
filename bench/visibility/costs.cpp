// What the parts of occlusion are worth and what they cost.
#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <iterator>
#include <string>
#include <vector>

#include "accuracy.h"
#include "refine/tuning.h"
#include "visibility/subjects.h"

namespace occlod::bench {
namespace {

using tool::Json;

template <typename Change>
RefineOptions with(RefineOptions options, const Change& change) {
  change(options);
  return options;
}

// One row each: the default, and what differs from it.
std::vector<Variant> variants(const RefineOptions& base) {
  using O = RefineOptions;
  return {
      {"as it is", base},
      {"proxy box", with(base, [](O& o) { tune(o).proxy = Proxy::box; })},
      {"proxy sphere", with(base, [](O& o) { tune(o).proxy = Proxy::sphere; })},
      {"proxy cylinder", with(base, [](O& o) { tune(o).proxy = Proxy::cylinder; })},
      {"levels 1", with(base, [](O& o) { tune(o).level_step = 1; })},
      {"levels 3", with(base, [](O& o) { tune(o).level_step = 3; })},
      {"levels 4", with(base, [](O& o) { tune(o).level_step = 4; })},
      {"steps adaptive", with(base, [](O& o) { tune(o).occluder_splits.clear(); })},
      {"no occluder", with(base, [](O& o) { tune(o).occluder_splits = {no_id}; })},  // so many splits there are never
      {"steps 300", with(base, [](O& o) { tune(o).occluder_splits = {300}; })},
      {"steps 300,2500", with(base,
                              [](O& o) {
                                tune(o).occluder_splits = {300, 2500};
                              })},
      {"steps 300,1000,2500,5000", with(base,
                                        [](O& o) {
                                          tune(o).occluder_splits = {300, 1000, 2500, 5000};
                                        })},
      {"no retest", with(base, [](O& o) { tune(o).retest_hidden = false; })},
      {"no final check", with(base, [](O& o) { tune(o).final_check = false; })},
      {"no weight of the visible share", with(base, [](O& o) { tune(o).visible_exponent = 0.0; })},
      {"no weight of grazing faces", with(base, [](O& o) { tune(o).grazing_exponent = 0.0; })},
      {"no weight of what is forced", with(base, [](O& o) { tune(o).forced_exponent = 0.0; })},
      {"no weight of what is covered", with(base, [](O& o) { tune(o).covered_factor = 1.0; })},
      {"visible share ^ 3/2", with(base, [](O& o) { tune(o).visible_exponent = 1.5; })},
      {"grazing ^ 1/2", with(base, [](O& o) { tune(o).grazing_exponent = 0.5; })},
      {"forced ^ 3/4", with(base, [](O& o) { tune(o).forced_exponent = 0.75; })},
      {"covered 1/2", with(base, [](O& o) { tune(o).covered_factor = 0.5; })},
      {"conservative", with(base, [](O& o) { o.mode = OccluderMode::conservative; })},
  };
}

void add_variants_of(Table& table, SceneRun& run, const VisibilityOptions& options, Culling culling) {
  const std::vector<Variant> all = variants(refine_options(options.table_budget, culling));
  std::deque<tool::Measurement> measurements;  // one a variant, as rounds go through all of them
  for (std::size_t i = 0; i < all.size(); ++i) measurements.emplace_back(run.objects);
  for (int round = 0; round < options.repeat; ++round)
    for (std::size_t i = 0; i < all.size(); ++i) measurements[i].repeat(run.view, all[i].options, *run.software);

  const tool::FullMeshPicture full(run.objects, run.view);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const RefineStats& stats = measurements[i].refinement().stats;
    const tool::RenderTimes times = measurements[i].times();
    const Share share{stats.triangles, measurements[i].visible_triangles(), {}};
    const PictureDistance distance = full.distance_to(measurements[i].items(), measurements[i].objects());
    table.add({{"scene", run.description.name},
               {"culling", name_of(culling)},
               {"variant", all[i].name},
               {"budget", options.table_budget},
               {"triangles", stats.triangles},
               {"visible", share.visible},
               {"share", share.percent()},
               {"depth_rms_px", distance.depth_rms_px},
               {"silhouette_mismatch", distance.silhouette_mismatch},
               {"queries", stats.queries},
               {"hidden", stats.queries_hidden},
               {"wasted", stats.queries - stats.queries_hidden},
               {"occluder_draws", stats.occluder_draws},
               {"refine_ms", times.refine_ms},
               {"occlusion_ms", times.occlusion_ms},
               {"both_ms", times.refine_ms + times.occlusion_ms},
               {"hash", fmt::format("{:016x}", measurements[i].refinement().hash())}});
  }
}

void add_variants(Table& table, SceneRun& run, const VisibilityOptions& options) {
  if (!run.is_decided_by(options.table_budget)) return;
  for (const Culling culling : {Culling::subtree, Culling::star}) add_variants_of(table, run, options, culling);
}

void add_times(Table& table, SceneRun& run, const VisibilityOptions& options) {
  for (const Culling culling : {Culling::subtree, Culling::star})
    for (const std::size_t budget : options.budgets) {
      if (!run.is_decided_by(budget)) continue;
      const RefineOptions refine = refine_options(budget, culling);
      run.without.begin();
      run.with.begin();
      for (int round = 0; round < options.repeat; ++round) {
        run.without.repeat(run.view, refine, run.none);
        run.with.repeat(run.view, refine, *run.software);
      }
      const tool::RenderTimes without = run.without.times(), with = run.with.times();
      table.add({{"scene", run.description.name},
                 {"culling", name_of(culling)},
                 {"budget", budget},
                 {"refine_ms_without", without.refine_ms},
                 {"draw_ms_without", without.draw_ms},
                 {"frame_ms_without", without.frame_ms()},
                 {"refine_ms", with.refine_ms},
                 {"occlusion_ms", with.occlusion_ms},
                 {"draw_ms", with.draw_ms},
                 {"frame_ms", with.frame_ms()},
                 {"ratio", with.frame_ms() / without.frame_ms()}});
    }
}

// A row for each culling and variant, a column for each scene.
Table by_scene(const Table& variants, const std::string& key, const std::string& what, int digits) {
  Table table{"variants_" + key, "Variants: " + what, {{"culling", "culling"}, {"variant", "variant"}}, {}};
  for (const Json& row : variants.rows) {
    const auto scene = row["scene"].get<std::string>();
    if (table.columns.back().key != scene) table.columns.push_back({scene, scene, digits});
    auto found = std::find_if(table.rows.begin(), table.rows.end(), [&](const Json& other) {
      return other["culling"] == row["culling"] && other["variant"] == row["variant"];
    });
    if (found == table.rows.end()) {
      table.add({{"culling", row["culling"]}, {"variant", row["variant"]}});
      found = std::prev(table.rows.end());
    }
    (*found)[scene] = row[key];
  }
  return table;
}

}  // namespace

Subject variants_subject(const VisibilityOptions& options) {
  return {
      {"variants",
       fmt::format("Bounding volumes, levels that are asked about, occluder steps: {} triangles, software occlusion, "
                   "the default (cylinder, levels 2, steps 300,2500) and what differs from it. Wasted: queries "
                   "answered visible. Medians of {} interleaved rounds, ms.",
                   cell(options.table_budget, 0), options.repeat),
       {{"scene", "scene"},
        {"culling", "culling"},
        {"variant", "variant"},
        {"budget", ""},
        {"triangles", ""},
        {"visible", "visible"},
        {"share", "share %", 1},
        {"depth_rms_px", "depth RMS px", 3},
        {"silhouette_mismatch", "silhouette %", 3},
        {"queries", "queries"},
        {"hidden", "hidden"},
        {"wasted", "wasted"},
        {"occluder_draws", "occluder draws"},
        {"refine_ms", "refine"},
        {"occlusion_ms", "occlusion"},
        {"both_ms", "both"},
        {"hash", ""}},
       {}},
      add_variants};
}

std::vector<Table> variants_by_scene(const Table& variants) {
  return {by_scene(variants, "share", "share of visible triangles, %", 1),
          by_scene(variants, "depth_rms_px", "depth RMS against the full meshes, px", 3),
          by_scene(variants, "silhouette_mismatch", "pixels where the silhouette differs, %", 3),
          by_scene(variants, "queries", "queries", 0),
          by_scene(variants, "wasted", "of them answered visible", 0),
          by_scene(variants, "occlusion_ms", "occlusion, ms", 1),
          by_scene(variants, "both_ms", "refinement and occlusion, ms", 1)};
}

Subject times_subject() {
  return {
      {"times",
       "Times, ms: the whole frame is refinement, occlusion and drawing (the item buffer on the CPU). Without and with "
       "software occlusion at equal budgets, in turns; medians.",
       {{"scene", "scene"},
        {"culling", "culling"},
        {"budget", "budget"},
        {"refine_ms_without", "refine"},
        {"draw_ms_without", "draw"},
        {"frame_ms_without", "frame without"},
        {"refine_ms", "refine"},
        {"occlusion_ms", "occlusion"},
        {"draw_ms", "draw"},
        {"frame_ms", "frame with"},
        {"ratio", "with / without"}},
       {}},
      add_times};
}

}  // namespace occlod::bench
