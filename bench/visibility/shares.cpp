// Visible shares at many budgets, and whether occlusion ever made one smaller.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

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
    with.occluder_mode = mode;
    const Share software = measure_share(run.with, view, with, *run.software);
    table.add({{"scene", run.description.name},
               {"view", named.name},
               {"culling", name_of(culling)},
               {"budget", budget},
               {"mode", name_of(mode)},
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

Table shares_of_default_views(const Table& shares) {
  Table chosen = shares;
  std::erase_if(chosen.rows, [](const tool::Json& row) { return row["view"] != default_view; });
  return chosen;
}

Table shares_made_smaller(const Table& shares) {
  Table offenders = shares;
  offenders.name = "shares_made_smaller";
  std::erase_if(offenders.rows, [](const tool::Json& row) { return !is_smaller(row); });
  offenders.about =
      fmt::format("Where occlusion made the visible share smaller: {} of {} (all cameras, frames of paths).",
                  offenders.rows.size(), shares.rows.size());
  for (Column& column : offenders.columns)
    if (column.key == "camera") column.heading = "camera";
  return offenders;
}

Table shares_summary(const Table& shares) {
  Table table{"shares_summary",
              "Gain in points over all cameras and frames of paths: how often occlusion made the share smaller.",
              {{"scene", "scene"},
               {"culling", "culling"},
               {"budget", "budget"},
               {"mode", "mode"},
               {"views", "views"},
               {"smaller", "smaller"},
               {"least", "least gain"},
               {"mean", "mean gain"},
               {"most", "most"}},
              {}};
  std::vector<tool::Json>& rows = table.rows;
  const auto same = [](const tool::Json& a, const tool::Json& b) {
    const auto has_equal = [&](const char* key) { return a[key] == b[key]; };
    return has_equal("scene") && has_equal("culling") && has_equal("budget") && has_equal("mode");
  };
  for (const tool::Json& row : shares.rows) {
    const double gain = row["gain"].get<double>();
    auto found = std::find_if(rows.begin(), rows.end(), [&](const tool::Json& other) { return same(row, other); });
    if (found == rows.end()) {
      table.add({{"scene", row["scene"]},
                 {"culling", row["culling"]},
                 {"budget", row["budget"]},
                 {"mode", row["mode"]},
                 {"views", 0},
                 {"smaller", 0},
                 {"least", gain},
                 {"mean", 0.0},
                 {"most", gain}});
      found = std::prev(rows.end());
    }
    const int views = (*found)["views"].get<int>() + 1;
    const double mean = (*found)["mean"].get<double>();
    (*found)["views"] = views;
    (*found)["smaller"] = (*found)["smaller"].get<int>() + (is_smaller(row) ? 1 : 0);
    (*found)["least"] = std::min((*found)["least"].get<double>(), gain);
    (*found)["mean"] = mean + (gain - mean) / views;
    (*found)["most"] = std::max((*found)["most"].get<double>(), gain);
  }
  return table;
}

}  // namespace occlod::bench
