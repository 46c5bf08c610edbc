// The experiment of Birkholz & Rahn, sec. 4: what occlusion gains in views like those of their figures, and in random
// views in which as little is visible without occlusion as in theirs. That decides: what is visible cannot be gained.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "accuracy.h"
#include "backend.h"
#include "occlod/base.h"
#include "refine/tuning.h"
#include "visibility/subjects.h"
#include "visibility/views.h"

namespace occlod::bench {
namespace {

using tool::Json;

constexpr std::uint64_t seed = 1;
constexpr int max_tries_a_view = 4;
constexpr double max_difference = 0.1;  // from the paper's count without occlusion: where a view is as difficult
constexpr const char* figure = "figure";
constexpr const char* as_published = "as published";
constexpr const char* every_level = "every level";
constexpr const char* opengl = "OpenGL queries";

// A row of table 2: visible triangles of 10,000 in the view of a figure.
struct PaperRow {
  const char* scene;
  std::size_t without;
  std::size_t with;
  double improvement;  // percent
};
constexpr std::size_t paper_budget = 10'000;
constexpr PaperRow paper_table_2[] = {{"armadillo", 2277, 3642, 59.95},
                                      {"armadillo_group", 2231, 3733, 67.32},
                                      {"planet_full", 3546, 4781, 34.83},
                                      {"planet_near", 1888, 4623, 144.86}};

struct PaperVariant {
  Variant variant;
  Visibility* visibility;
};

// The paper's method first, then with one other choice each; without OpenGL's queries where there are none.
std::vector<PaperVariant> paper_variants(std::size_t budget, Visibility& software, Visibility* gl) {
  const RefineOptions published = refine_options(budget, Culling::subtree);
  std::vector<PaperVariant> variants = {{{as_published, published}, &software}};
  const auto add = [&](const char* name, Visibility* visibility, const auto& change) {
    RefineOptions options = published;
    change(tune(options));
    if (visibility != nullptr) variants.push_back({{name, std::move(options)}, visibility});
  };
  const auto ask_every_level = [](Tuning& t) { t.level_step = 1; };
  add(every_level, &software, ask_every_level);
  add(opengl, gl, [](Tuning&) {});
  add("OpenGL queries, every level", gl, ask_every_level);
  add("box", &software, [](Tuning& t) { t.proxy = Proxy::box; });
  add("sphere", &software, [](Tuning& t) { t.proxy = Proxy::sphere; });
  add("one occluder", &software, [](Tuning& t) { t.occluder_splits = {300}; });
  add("adaptive occluders", &software, [](Tuning& t) { t.occluder_splits.clear(); });
  add("no re-test", &software, [](Tuning& t) { t.retest_hidden = false; });
  return variants;
}

// What all variants show in one view, from which run.without has been refined.
void add_view(Table& views, SceneRun& run, const NamedView& named, const std::vector<PaperVariant>& variants) {
  const std::size_t without = run.without.visible_triangles();
  for (const auto& [variant, visibility] : variants) {
    const std::size_t with = measure_share(run.with, View(named.camera), variant.options, *visibility).visible;
    const RefineStats& stats = run.with.refinement().stats;
    views.add({{"scene", run.description.name},
               {"view", named.name},
               {"variant", variant.name},
               {"without", without},
               {"with", with},
               {"improvement_pct", improvement(with, without)},
               {"queries", stats.queries},
               {"candidates", stats.nodes - stats.culled_frustum - stats.culled_backface}});
  }
}

// Returns how many random views were looked at.
int add_random_views(Table& views, SceneRun& run, const VisibilityOptions& options, double wanted,
                     const std::vector<PaperVariant>& variants) {
  RandomCameras cameras(run, options.size, seed);
  int seen = 0;
  for (int tries = 0; seen < options.paper_views && tries < max_tries_a_view * options.paper_views; ++tries) {
    const NamedView named{fmt::format("random {}", tries), cameras.next()};
    const View view(named.camera);
    const auto visible = measure_share(run.without, view, variants.front().variant.options, run.none).visible;
    if (!is_fair(run, view, run.without.items(), run.without.objects())) continue;
    ++seen;
    if (std::abs(static_cast<double>(visible) - wanted) <= max_difference * wanted)
      add_view(views, run, named, variants);
  }
  return seen;
}

void add_scene(Table& table, Table& views, SceneRun& run, const VisibilityOptions& options, Visibility* gl) {
  const auto* const paper = std::find_if(std::begin(paper_table_2), std::end(paper_table_2),
                                         [&](const PaperRow& row) { return run.description.name == row.scene; });
  const std::size_t budget = options.table_budget;
  if (paper == std::end(paper_table_2) || !run.is_decided_by(budget)) return;

  const tool::FullMeshPicture full(run.objects, run.view);
  const auto depth_rms = [&full](const tool::Measurement& measured) {
    return full.distance_to(measured.items(), measured.objects()).depth_rms_px;
  };
  const std::vector<PaperVariant> variants = paper_variants(budget, *run.software, gl);
  const RefineOptions ours = refine_options(budget, Culling::star);
  Json row = {{"scene", run.description.name},
              {"budget", budget},
              {"paper_lod", paper->without},
              {"paper_oc", paper->with},
              {"paper_ir_pct", paper->improvement}};
  row["lod"] = measure_share(run.without, run.view, variants.front().variant.options, run.none).visible;
  row["lod_depth_rms_px"] = depth_rms(run.without);
  add_view(views, run, {figure, run.view.camera()}, variants);
  row["ours"] = measure_share(run.with, run.view, ours, run.none).visible;
  row["ours_oc"] = measure_share(run.with, run.view, ours, *run.software).visible;
  row["ours_oc_depth_rms_px"] = depth_rms(run.with);
  row["depth_rms_ratio"] = row["ours_oc_depth_rms_px"].get<double>() / row["lod_depth_rms_px"].get<double>();
  const double wanted = static_cast<double>(paper->without * budget) / static_cast<double>(paper_budget);
  row["views"] = add_random_views(views, run, options, wanted, variants);
  const std::pair<const char*, const char*> shown[] = {
      {as_published, ""}, {every_level, "every_level_"}, {opengl, "opengl_"}};
  for (const Json& choice : paper_choices(views).rows)
    for (const auto& [variant, prefix] : shown) {
      if (choice["scene"] != row["scene"] || choice["variant"] != variant) continue;
      row[prefix + std::string("oc")] = choice["with"];
      row[prefix + std::string("ir_pct")] = choice["improvement_pct"];
      row["kept"] = choice["kept"];
      if (choice.contains("median_pct")) row[prefix + std::string("median_ir_pct")] = choice["median_pct"];
    }
  table.add(std::move(row));
}

// Null where there are none.
std::shared_ptr<Visibility> gl_queries() try {
  return tool::make_backend({"gl-query", ""}).visibility;
} catch (const Error& error) {
  fmt::print(stderr, "OpenGL queries are left out: {}\n", error.what());
  return nullptr;
}

// Linear between neighbours, of at least one value.
double quantile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], place - static_cast<double>(below));
}

}  // namespace

Subject paper_subject(const VisibilityOptions& options, Table& views) {
  return {{"paper_table_2",
           fmt::format("Table 2 of Birkholz & Rahn: visible triangles of {} without occlusion (LOD) and with it (OC), "
                       "improvement (IR) in %; its medians in random views in which about as much is visible without "
                       "occlusion as in the paper's, of {} a scene; our own method, and its depth RMS over that of the "
                       "LOD.",
                       cell(options.table_budget, 0), options.paper_views),
           {{"scene", "scene"},
            {"budget", ""},
            {"paper_lod", "paper: LOD"},
            {"paper_oc", "OC"},
            {"paper_ir_pct", "IR", 0},
            {"lod", "as published, ours: LOD"},
            {"oc", "OC"},
            {"ir_pct", "IR", 0},
            {"every_level_oc", ""},
            {"every_level_ir_pct", "every level: IR", 0},
            {"opengl_oc", ""},
            {"opengl_ir_pct", "OpenGL queries: IR", 0},
            {"median_ir_pct", "equal difficulty: IR", 0},
            {"every_level_median_ir_pct", "every level", 0},
            {"opengl_median_ir_pct", ""},
            {"kept", "views"},
            {"views", ""},
            {"ours", "our method: no occlusion"},
            {"ours_oc", "OC"},
            {"lod_depth_rms_px", ""},
            {"ours_oc_depth_rms_px", ""},
            {"depth_rms_ratio", "depth RMS", 2}},
           {}},
          [&views, gl = gl_queries()](Table& table, SceneRun& run, const VisibilityOptions& o) {
            add_scene(table, views, run, o, gl.get());
          }};
}

Table paper_views() {
  Table table{"paper_views", "", {}, {}};
  for (const char* key : {"scene", "view", "variant", "without", "with", "improvement_pct", "queries", "candidates"})
    table.columns.push_back({key, ""});
  return table;
}

Table paper_choices(const Table& views) {
  Table table{"paper_choices", "", {}, {}};
  for (const char* key : {"scene", "variant", "queries", "candidates", "with", "improvement_pct", "kept", "lower_pct",
                          "median_pct", "upper_pct"})
    table.columns.push_back({key, ""});
  for (const Json& of_figure : views.rows) {
    if (of_figure["view"] != figure) continue;
    std::vector<double> improvements;
    for (const Json& row : views.rows)
      if (row["scene"] == of_figure["scene"] && row["variant"] == of_figure["variant"] && row["view"] != figure)
        improvements.push_back(row["improvement_pct"]);
    std::sort(improvements.begin(), improvements.end());
    Json choice = {{"kept", improvements.size()}};
    for (const char* key : {"scene", "variant", "queries", "candidates", "with", "improvement_pct"})
      choice[key] = of_figure[key];
    if (!improvements.empty())
      choice.update({{"lower_pct", quantile(improvements, 0.25)},
                     {"median_pct", quantile(improvements, 0.5)},
                     {"upper_pct", quantile(improvements, 0.75)}});
    table.add(std::move(choice));
  }
  return table;
}

Table paper_choices_by_scene(const Table& choices) {
  Table table{
      "paper_choices_by_scene",
      "The paper's method with one other choice each: IR in the figure's view; the quartiles of the random ones.",
      {{"variant", "variant"}},
      {}};
  for (const Json& choice : choices.rows) {
    const auto scene = choice["scene"].get<std::string>();
    if (table.columns.back().key != scene) table.columns.push_back({scene, scene});
    auto row = std::find_if(table.rows.begin(), table.rows.end(),
                            [&](const Json& other) { return other["variant"] == choice["variant"]; });
    if (row == table.rows.end()) {
      table.add({{"variant", choice["variant"]}});
      row = std::prev(table.rows.end());
    }
    (*row)[scene] = cell(choice["improvement_pct"], 0);
    if (choice.contains("median_pct"))
      (*row)[scene] = fmt::format("{}; {}, {}, {}", cell(choice["improvement_pct"], 0), cell(choice["lower_pct"], 0),
                                  cell(choice["median_pct"], 0), cell(choice["upper_pct"], 0));
  }
  return table;
}

Table paper_gains(const Table& scenes) {
  return {"paper_gains",
          "The same in short.",
          {{"scene", "scene"},
           {"lod", "the paper's LOD"},
           {"oc", "with its occlusion"},
           {"ir_pct", "gain, %", 0},
           {"paper_ir_pct", "in the paper", 0},
           {"ours", "ours, no occlusion"},
           {"ours_oc", "ours, with occlusion"},
           {"depth_rms_ratio", "depth RMS over the paper's LOD", 2}},
          scenes.rows};
}

}  // namespace occlod::bench
