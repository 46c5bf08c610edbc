// The tables of bench_visibility. Each subject is asked for its empty table once and then for its rows of each scene.
#pragma once

#include <functional>
#include <vector>

#include "visibility/scene_run.h"
#include "visibility/table.h"

namespace occlod::bench {

struct Subject {
  Table table;
  std::function<void(Table& table, SceneRun& run, const VisibilityOptions& options)> add_rows;
};

// Birkholz & Rahn, table 1: what the meshes are.
[[nodiscard]] Subject meshes_subject();
// Table 2: visible triangles at the paper's budget.
[[nodiscard]] Subject table_2_subject(const VisibilityOptions& options);
// The same four ways: share, and distance from the picture of the full meshes.
[[nodiscard]] Subject quality_subject(const VisibilityOptions& options);
// Visible shares with and without occlusion at every budget that decides, from every camera and frames of every path.
[[nodiscard]] Subject shares_subject();
// The triangles that the paper's LOD needs for the depth error that ours has at the paper's budget.
[[nodiscard]] Subject equal_error_subject(const VisibilityOptions& options);
// Bounding volumes, levels and occluder steps.
[[nodiscard]] Subject variants_subject(const VisibilityOptions& options);
// Refinement, occlusion and drawing, with and without occlusion in turns.
[[nodiscard]] Subject times_subject();
// Pixels that occlusion hides wrongly: sums and maxima, a row for each mode; `views`: those with any, to be seen again.
[[nodiscard]] Subject wrongly_hidden_subject(Table& views);
[[nodiscard]] Table wrongly_hidden_views();

// Table 2 in views like those of the paper's figures, its own figures beside ours; scenes have its names. `views`:
// those and random views that are as difficult, refined in the paper's way and with one other choice each.
[[nodiscard]] Subject paper_subject(const VisibilityOptions& options, Table& views);
[[nodiscard]] Table paper_views();
// Of the table of these views: a row for each scene and choice, "candidates" being the nodes that neither the frustum
// nor cones culled. The same for people: a row for each choice.
[[nodiscard]] Table paper_choices(const Table& views);
[[nodiscard]] Table paper_choices_by_scene(const Table& choices);
// Of the table of paper_subject(): what our own method gains.
[[nodiscard]] Table paper_gains(const Table& scenes);

// Of the table of shares: the rows where occlusion made the share smaller, and a row for each scene, culling and
// budget.
[[nodiscard]] Table shares_made_smaller(const Table& shares);
[[nodiscard]] Table shares_summary(const Table& shares);

// Of the table of variants: one of their numbers, a row for each variant and a column for each scene.
[[nodiscard]] std::vector<Table> variants_by_scene(const Table& variants);

// SCENE_view.png and SCENE_birdseye.png in the folder: the paper's LOD left, with occlusion right: of this culling.
void write_pictures(SceneRun& run, const VisibilityOptions& options, Culling with);

}  // namespace occlod::bench
