#include "refine/frames.h"

namespace occlod {
namespace {

// More than this part of the applied splits matters much less than what the budget goes to.
constexpr double lost_part = 0.25;
// More changes than this part of the nodes of the front: the mesh which hid things in this frame is not the one that is
// handed over.
constexpr double much_change = 0.03;

std::vector<DrawnMesh> meshes_of(std::span<const RefineObject> objects, std::span<RefinedObject> result) {
  std::vector<DrawnMesh> meshes;
  for (std::size_t i = 0; i < objects.size(); ++i) meshes.emplace_back(*objects[i].hierarchy, result[i].triangles);
  return meshes;
}

}  // namespace

Frames::Frames(std::span<const RefineObject> objects, std::span<RefinedObject> result)
    : evaluation_(objects),
      forest_(evaluation_),
      queries_(evaluation_),
      meshes_(meshes_of(objects, result)),
      exchange_(evaluation_, forest_, queries_, meshes_) {}

void Frames::begin() {
  ++frame_;
  for (DrawnMesh& mesh : meshes_) mesh.begin_frame();
}

void Frames::adopt(const RefinedScene& scene, float level, std::span<const Entry> hidden) {
  begin();
  at_rest_ = false;
  evaluation_.restart(scene);
  exchange_.adopt(level);
  for (std::uint32_t i = 0; i < meshes_.size(); ++i) {
    meshes_[i].assign((*scene.cuts)[i]);
    forest_.adopt_splits(i);
  }
  queries_.adopt(hidden);
  for (std::uint32_t i = 0; i < meshes_.size(); ++i) forest_.adopt_forest(i, level);
  before_ = evaluation_.count_applied(worthless_part * level);
}

bool Frames::move_to(const RefinedScene& scene) {
  begin();
  evaluation_.move_to(scene);
  const AppliedCount now = evaluation_.count_applied(worthless_part * exchange_.level());
  const double newly_lost = static_cast<double>(now.worthless) - static_cast<double>(before_.worthless);
  return newly_lost <= lost_part * static_cast<double>(now.all);
}

void Frames::advance(bool moved, Clock::time_point start, RefineStats& stats) {
  if (moved) moved_frame_ = frame_;
  queries_.begin_frame(frame_, moved);
  exchange_.begin_frame(frame_, start, stats);
  exchange_splits(moved, stats);
  exchange_.take_back_needless();
  before_ = evaluation_.count_applied(worthless_part * exchange_.level());
  const bool all_asked = !evaluation_.scene().queries->can_hide() || frame_ - moved_frame_ >= asking_rounds;
  at_rest_ = !stats.pending && all_asked;
  measure(stats);
}

// Hidden things give way; and once more where the mesh of this frame hides other things than that of the frame before.
void Frames::exchange_splits(bool moved, RefineStats& stats) {
  const RefinedScene& scene = evaluation_.scene();
  const bool can_hide = scene.queries->can_hide();
  if (can_hide)
    stats.readmitted += queries_.ask_again(exchange_.level(), false);
  else
    queries_.forget_hidden();
  exchange_.run();
  const bool changed_much =
      static_cast<double>(exchange_.changes()) > much_change * static_cast<double>(evaluation_.node_count());
  const RefineOptions* const options = scene.options;
  if (!(can_hide && moved && options->queries.final_check && changed_much)) return;
  stats.readmitted += queries_.ask_all_anew(exchange_.level());
  exchange_.run_again();
}

void Frames::measure(RefineStats& stats) {
  ScreenError left = exchange_.rejected_error();
  evaluation_.measure_errors(left);
  stats.triangles = evaluation_.scene().cuts->triangle_count();
  evaluation_.count_nodes(stats);
  stats.level_px = static_cast<double>(exchange_.level());
  stats.max_error_px = static_cast<double>(left.guaranteed_px);
  stats.max_quadric_error_px = static_cast<double>(left.quadric_px);
}

void Frames::emit(std::span<RefinedObject> out, RefineStats& stats) {
  const RefinedScene& scene = evaluation_.scene();
  const RefineOptions* const options = scene.options;
  for (std::uint32_t i = 0; i < meshes_.size(); ++i) {
    Front& front = evaluation_.front(i);
    for (const SplitId s : meshes_[i].born())
      if (const Front::Index k = front.find(s); k != Front::none) front.set(k, Front::is_new, false);
    meshes_[i].emit((*scene.cuts)[i], options->update.geomorph_frames, out[i], stats);
    for (const SplitId s : meshes_[i].born()) {
      const Front::Index k = front.find(s);
      if (front.is(k, Front::forced)) ++stats.forced_splits;
      if (front.is(k, Front::forced_unseen)) ++stats.forced_unseen_splits;
    }
    at_rest_ = at_rest_ && out[i].geomorphs.empty();
  }
  // A split may be given up in vain again and again, for what finds no room all the same.
  const bool same_mesh = stats.new_splits + stats.merged_splits == 0;
  same_frames_ = same_mesh && frame_ != moved_frame_ ? same_frames_ + 1 : 0;
  at_rest_ = at_rest_ && (exchange_.changes() == 0 || same_frames_ >= weighing_rounds);
}

}  // namespace occlod
