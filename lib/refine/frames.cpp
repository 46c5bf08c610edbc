#include "refine/frames.h"

#include <algorithm>

namespace occlod {
namespace {

// More than this part of the applied splits matters much less than what the budget goes to.
constexpr double lost_part = 0.25;

// In a view that does not move: what is exchanged after so many frames goes to and fro.
constexpr std::uint32_t most_restless_frames = 4 * weighing_rounds;

// What the mesh of a frame turns out to show matters when its error is this many times the level.
constexpr float much_error = 4.0F;
// After so many checks in a row that found nothing of the kind, one frame in so many is checked.
constexpr std::uint32_t most_useless_checks = 16, rare_checks = 4;

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
  at_rest_ = !stats.pending && all_asked && exchange_.has_settled();
  measure(stats);
}

// Hidden things give way. The mesh of this frame hides less than that of the frame before where that bulged: what turns
// out to be visible comes in after all.
void Frames::exchange_splits(bool moved, RefineStats& stats) {
  const RefinedScene& scene = evaluation_.scene();
  const bool can_hide = scene.queries->can_hide();
  if (can_hide)
    stats.readmitted += queries_.ask_again(exchange_.level());
  else
    queries_.forget_hidden();
  exchange_.run();
  if (!can_hide || !moved || !scene.options->queries.final_check || exchange_.changes() == 0) return;
  if (checks_since_useful_ > most_useless_checks && frame_ % rare_checks != 0) return;
  const std::span<const Entry> shown = queries_.check_hidden(exchange_.level());
  stats.readmitted += shown.size();
  note_check(shown);
  exchange_.run_on(shown);
}

void Frames::note_check(std::span<const Entry> shown) {
  const auto matters = [&](const Entry& entry) { return entry.error.quadric_px > much_error * exchange_.level(); };
  checks_since_useful_ = std::any_of(shown.begin(), shown.end(), matters) ? 1 : checks_since_useful_ + 1;
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
  at_rest_ = at_rest_ && (exchange_.changes() == 0 || same_frames_ >= weighing_rounds ||
                          frame_ - moved_frame_ >= most_restless_frames);
}

}  // namespace occlod
