#include "cells_bench.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "explain.h"
#include "occlod/base.h"
#include "occlod/picture.h"

namespace occlod::viewer {
namespace {

bool is_same_walk(const CellSettings& a, const CellSettings& b) {
  return a.prefetch == b.prefetch && a.memory_mb == b.memory_mb && a.disk_mb_s == b.disk_mb_s &&
         a.latency_ms == b.latency_ms;
}

tool::CellWalkOptions options_of(const CellSettings& settings) {
  tool::CellWalkOptions options;
  options.memory = static_cast<std::size_t>(settings.memory_mb * 1e6);
  options.prefetch = settings.prefetch;
  if (settings.disk_mb_s > 0.0) options.disk = tool::DiskSpeed{settings.disk_mb_s * 1e6, settings.latency_ms * 1e-3};
  return options;
}

// Resizing a window does not advance time.
Camera without_size(Camera camera) {
  camera.width = camera.height = 1;
  return camera;
}

}  // namespace

void CellsBench::forget() {
  walk_.reset();
  asked_.reset();
  cells_.reset();
}

void CellsBench::place(const RefineJob& job) {
  if (walk_ && job.cells == cells_ && is_same_walk(job.walk, settings_) && !job.from_scratch) return;
  forget();
  walk_.emplace(job.cells->file, refine_objects(*job.cells->objects), options_of(job.walk));
  cells_ = job.cells;
  settings_ = job.walk;
  told_ = {};
  told_.cells = cells_;
  changed_ = true;
}

void CellsBench::step(const RefineJob& job) {
  const bool is_first = told_.frames == 0;
  told_.walked = walk_->step_to(job.camera);
  for (const std::string& line : told_.walked.notes) note_ = {++notes_, line};
  told_.note = note_;
  const WalkedFrame& walked = told_.walked;
  ++told_.frames;
  told_.late += walked.late ? 1 : 0;
  told_.missing += walked.missing ? 1 : 0;
  told_.crossings += walked.crossed && !is_first ? 1 : 0;
  told_.bytes_read += walked.bytes_read;
  told_.loads += walked.loads;
  CellVisit& visit = told_.visits[walked.cell];
  ++visit.frames;
  visit.late += walked.late ? 1 : 0;
  changed_ = changed_ || walked.changed;
}

void CellsBench::read_splits() {
  std::vector<CellId> path;
  cells_->file->tree().path_to(told_.walked.shown, path);
  std::vector<CellAdditions> additions;
  additions.reserve(path.size());
  std::vector<const CellAdditions*> above;
  try {
    for (const CellId cell : path) above.push_back(&additions.emplace_back(cells_->file->read(cell, above)));
  } catch (const Error&) {
    return;
  }
  for (const CellAdditions& of_node : additions) {
    for (const ObjectAdditions& added : of_node.objects) {
      std::vector<SplitId>& splits = drawn_.objects[added.object].splits;
      splits.insert(splits.end(), added.splits.begin(), added.splits.end());
    }
  }
  for (RefinedObject& object : drawn_.objects) std::sort(object.splits.begin(), object.splits.end());
  has_splits_ = true;
}

void CellsBench::add_left_out() {
  if (told_.walked.late) return;
  std::vector<CellObjectCut> cuts;
  try {
    cuts = read_cell(*cells_->file, refine_objects(*cells_->objects), told_.walked.shown);
  } catch (const Error&) {
    return;
  }
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const LeftOut out = left_out_of(*cells_, told_.walked.shown, i, cuts[i]);
    std::vector<Triangle>& triangles = drawn_.objects[i].triangles;
    triangles.insert(triangles.end(), out.triangles.begin(), out.triangles.end());
    told_.left_out += out.triangles.size();
    kept_[i] = out.kept;
  }
}

void CellsBench::take_triangles(bool with_left_out) {
  const WalkedFrame& walked = walk_->walked();
  drawn_ = {};
  drawn_.objects.resize(walked.objects.size());
  kept_.assign(walked.objects.size(), {});
  told_.drawn.clear();
  told_.left_out = 0;
  for (std::size_t i = 0; i < walked.objects.size(); ++i) {
    const std::span<const Triangle> triangles = walked.objects[i].triangles;
    drawn_.objects[i].triangles.assign(triangles.begin(), triangles.end());
    told_.drawn.push_back(triangles.size());
  }
  drawn_.stats.triangles = walked.drawn_triangles;
  if (with_left_out) add_left_out();
  has_left_out_ = with_left_out;
  has_splits_ = false;
  changed_ = false;
}

std::size_t CellsBench::first_item(std::size_t object) const {
  return std::accumulate(told_.drawn.begin(), told_.drawn.begin() + static_cast<std::ptrdiff_t>(object),
                         std::size_t{0});
}

void CellsBench::count_visible(RefinedSide& side, const View& view) {
  std::vector<DrawObject> list;
  for (std::size_t i = 0; i < drawn_.objects.size(); ++i) {
    const PlacedObject& object = (*cells_->objects)[i];
    list.push_back({object.mesh->hierarchy->positions(),
                    {},
                    std::span(drawn_.objects[i].triangles).first(told_.drawn[i]),
                    object.object_to_world});
  }
  draw_items(items_, list, view);
  owns_pixel_ = visible_items(items_, told_.walked.drawn_triangles);
  side.visible_triangles = static_cast<std::size_t>(std::count(owns_pixel_.begin(), owns_pixel_.end(), true));
}

std::vector<glm::u8vec4> CellsBench::seen_colors(const View& view, std::size_t object) const {
  std::vector<glm::u8vec4> colors;
  const std::span<const Triangle> drawn = std::span(drawn_.objects[object].triangles).first(told_.drawn[object]);
  for (const Seen seen : classify((*cells_->objects)[object], drawn, view, owns_pixel_, first_item(object)))
    colors.push_back(color_of(seen));
  for (const CellKept kept : kept_[object]) colors.push_back(color_of(kept));
  return colors;
}

std::vector<glm::u8vec4> CellsBench::colors(const RefineJob& job, const RefinedSide& side, std::size_t object) const {
  const PlacedObject& placed = (*cells_->objects)[object];
  const RefinedObject& refined = side.refinement.objects[object];
  std::vector<glm::u8vec4> colors;
  colors.reserve(refined.triangles.size());
  if (job.walk.color_by == CellColorBy::level) {
    const double deepest = std::max(placed.mesh->level_count - 1, 1);
    for (const SplitId s : born_splits(*placed.mesh->hierarchy, refined.triangles))
      colors.push_back(s == no_id ? base_mesh_color : level_color(placed.mesh->levels[s] / deepest));
  } else if (job.walk.color_by == CellColorBy::error && has_splits_) {
    for (const double px : errors_px(placed, refined, View(job.camera))) colors.push_back(error_color(px));
  } else if (job.walk.color_by == CellColorBy::kept) {
    const std::size_t first = first_item(object);
    for (std::size_t t = 0; t < told_.drawn[object]; ++t)
      colors.push_back(color_of(owns_pixel_[first + t] ? CellKept::seen : CellKept::unseen));
    for (const CellKept kept : kept_[object]) colors.push_back(color_of(kept));
  }
  return colors;
}

void CellsBench::walk(RefinedFrame& frame, std::uint64_t& number) {
  const RefineJob& job = frame.job;
  place(job);
  const Camera seen = without_size(job.camera);
  if (job.again || asked_ != seen) {
    asked_.reset();  // in case this fails
    step(job);
    asked_ = seen;
  }
  if (changed_ || has_left_out_ != job.walk.left_out) {
    take_triangles(job.walk.left_out);
    number_ = ++number;
  }
  if (job.walk.color_by == CellColorBy::error && !has_splits_) read_splits();
  told_.unpromised = why_not_promised(*cells_, job.camera);
  RefinedSide side;
  side.refinement = drawn_;
  side.refinement.stats.max_error_px = told_.walked.error_px;
  side.number = number_;
  const View view(job.camera);
  if (job.count_visible || job.keep_seen || job.walk.color_by == CellColorBy::kept) count_visible(side, view);
  for (std::size_t i = 0; i < drawn_.objects.size(); ++i) {
    side.colors.push_back(colors(job, side, i));
    if (job.keep_seen) side.seen_colors.push_back(seen_colors(view, i));
  }
  frame.sides.push_back(std::move(side));
  frame.cells = std::make_shared<CellsFrame>(told_);
  frame.goes_on = told_.walked.late && !told_.walked.missing;
}

}  // namespace occlod::viewer
