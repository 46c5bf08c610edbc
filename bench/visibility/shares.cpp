// Visible shares at many budgets, and whether occlusion ever made one smaller.
#include <algorithm>

#include "visibility/subjects.h"

namespace occlod::bench {
namespace {

void add_shares(Table& table, SceneRun& run, const VisibilityOptions& options) {
  for (const Culling culling : {Culling::subtree, Culling::star})
    for (const std::size_t budget : options.budgets) {
      if (!run.is_decided_by(budget)) continue;
      const RefineOptions without = refine_options(budget, culling);
      const Share none = measure_share(run, run.without, without, run.none);
      for (const OccluderMode mode : {OccluderMode::paper, OccluderMode::conservative}) {
        RefineOptions with = without;
        with.occluder_mode = mode;
        const Share software = measure_share(run, run.with, with, *run.software);
        table.add({{"scene", run.description.name},
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
                   {"hash", software.hash}});
      }
    }
}

}  // namespace

Subject shares_subject() {
  return {{"shares",
           "Share of visible triangles, %, without and with occlusion, at every budget between the base meshes and the "
           "full ones. Gain in points.",
           {{"scene", "scene"},
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
            {"hash", ""}},
           {}},
          add_shares};
}

Table shares_made_smaller(const Table& shares) {
  Table offenders = shares;
  offenders.name = "shares_made_smaller";
  offenders.about = "Where occlusion made the visible share smaller:";
  std::erase_if(offenders.rows, [](const tool::Json& row) { return row["gain"].get<double>() >= 0.0; });
  return offenders;
}

}  // namespace occlod::bench
