// Visible shares at many budgets, and whether occlusion ever made one smaller.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "option_names.h"
#include "refine/tuning.h"
#include "visibility/subjects.h"
#include "visibility/views.h"

namespace occlod::bench {
namespace {

constexpr const char* default_view = "default";

// Rows of one view and culling; nothing where the budget does not decide.
void add_shares_of(Table& table, SceneRun& run, const NamedView& named, std::size_t budget, Culling culling) {
  if (!run.is_decided_by(budget)) return;
  const View view(named.camera);
  const RefineOptions without = refine_options(budget, culling);
  const Share none = measure_share(run.without, view, without, run.none);
  for (const OccluderMode mode : {OccluderMode::paper, OccluderMode::conservative}) {
    RefineOptions with = without;
    with.mode = mode;
    const Share software = measure_share(run.with, view, with, *run.software);
    table.add({{"scene", run.description.name},
               {"view", named.name},
               {"culling", name_of(culling)},
               {"budget", budget},
               {"mode", tool::name_of(mode)},
               {"triangles_without", none.triangles},
               {"triangles", software.triangles},
               {"visible_without", none.visible},
               {"visible", software.visible},
               {"share_without", none.percent()},
               {"share", software.percent()},
               {"gain", software.percent() - none.percent()},
               {"hash", software.hash},
               {"camera", tool::to_json(named.camera)}});
  }
}

// The default camera first; paths may pass through cameras that were there before.
std::vector<NamedView> views_of(const SceneRun& run, const VisibilityOptions& options) {
  std::vector<NamedView> views = {{default_view, run.view.camera()}};
  std::vector<NamedView> others;
  for (const auto& [name, camera] : run.description.cameras) others.push_back({name, sized(camera, options.size)});
  for (NamedView& view : path_views(run, options.share_frames, options.size)) others.push_back(std::move(view));
  for (NamedView& other : others) {
    const auto is_same = [&](const NamedView& view) {
      return tool::to_json(view.camera) == tool::to_json(other.camera);
    };
    if (std::none_of(views.begin(), views.end(), is_same)) views.push_back(std::move(other));
  }
  return views;
}

void add_shares(Table& table, SceneRun& run, const VisibilityOptions& options) {
  for (const NamedView& view : views_of(run, options))
    for (const Culling culling : {Culling::subtree, Culling::star})
      for (const std::size_t budget : options.budgets) add_shares_of(table, run, view, budget, culling);
}

bool is_smaller(const tool::Json& row) { return row["gain"].get<double>() < 0.0; }

// The row of the summary that a row of the shares counts for; a new one when it is the first.
tool::Json& summary_row(Table& summary, const tool::Json& row) {
  for (tool::Json& found : summary.rows)
    if (found["scene"] == row["scene"] && found["culling"] == row["culling"] && found["budget"] == row["budget"])
      return found;
  summary.add({{"scene", row["scene"]},
               {"culling", row["culling"]},
               {"budget", row["budget"]},
               {"views", 0},
               {"mean_paper", 0.0},
               {"smaller_paper", 0},
               {"mean_conservative", 0.0},
               {"smaller_conservative", 0}});
  return summary.rows.back();
}

void add_to_summary(Table& summary, const tool::Json& row) {
  tool::Json& target = summary_row(summary, row);
  const auto mode = row["mode"].get<std::string>();
  const bool is_first = mode == tool::name_of(OccluderMode::paper);  // of the rows of one view
  const int views = target["views"].get<int>() + (is_first ? 1 : 0);
  target["views"] = views;
  tool::Json& mean = target["mean_" + mode];
  mean = mean.get<double>() + (row["gain"].get<double>() - mean.get<double>()) / views;
  tool::Json& smaller = target["smaller_" + mode];
  smaller = smaller.get<int>() + (is_smaller(row) ? 1 : 0);
  if (row["view"] != default_view) return;
  target["default_without"] = row["share_without"];
  target["default_" + mode] = row["share"];
}

}  // namespace

Subject shares_subject() {
  return {{"shares",
           "Share of visible triangles, %, without and with occlusion, at every budget between the base meshes and the "
           "full ones. Gain in points.",
           {{"scene", "scene"},
            {"view", "view"},
            {"culling", "culling"},
            {"budget", "budget"},
            {"mode", "mode"},
            {"triangles_without", ""},
            {"triangles", ""},
            {"visible_without", "visible without"},
            {"visible", "with"},
            {"share_without", "share without", 1},
            {"share", "with", 1},
            {"gain", "gain", 2},
            {"hash", ""},
            {"camera", ""}},
           {}},
          add_shares};
}

Table shares_made_smaller(const Table& shares) {
  Table offenders = shares;
  offenders.name = "shares_made_smaller";
  std::erase_if(offenders.rows, [](const tool::Json& row) { return !is_smaller(row); });
  offenders.about = fmt::format(
      "Where occlusion made the visible share smaller: {} of {} measurements (all cameras, frames of paths).",
      offenders.rows.size(), shares.rows.size());
  return offenders;
}

Table shares_summary(const Table& shares) {
  Table table{"shares_summary",
              "Share of visible triangles, %, in the default view without occlusion, with it and with conservative "
              "occluders; then over all cameras and frames of paths the mean gain in points and how often the share "
              "became smaller.",
              {{"scene", "scene"},
               {"culling", "culling"},
               {"budget", "budget"},
               {"default_without", "without", 1},
               {"default_paper", "with", 1},
               {"default_conservative", "conservative", 1},
               {"views", "views"},
               {"mean_paper", "mean gain"},
               {"smaller_paper", "smaller"},
               {"mean_conservative", "conservative: mean gain"},
               {"smaller_conservative", "smaller"}},
              {}};
  for (const tool::Json& row : shares.rows) add_to_summary(table, row);
  return table;
}

}  // namespace occlod::bench
