#include "report/setting_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <limits>
#include <utility>

#include "base/timing.h"
#include "drawing.h"
#include "refine/tuning.h"
#include "report/coarse_occlusion.h"

namespace occlod::bench {
namespace {

constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

// FNV-1a, of words.
std::uint64_t combined(std::uint64_t hash, std::uint64_t word) { return (hash ^ word) * 1099511628211U; }

std::vector<LoadedObject> as_asked(std::vector<LoadedObject> objects, const Setting& setting) {
  for (LoadedObject& object : objects) object.attributes = object.attributes && setting.attributes;
  return objects;
}

}  // namespace

std::unique_ptr<Visibility> make_visibility(const Setting& setting) {
  if (!setting.occlusion) return std::make_unique<NoOcclusion>();
  return make_coarse_occlusion(setting.raster_divisor);
}

std::string what_hides(const Setting& setting) {
  const RefineOptions& o = setting.refine;
  if (!setting.occlusion) return {};
  return fmt::format("{} {} {} {} {} {} {} {} {} {} {} {}", setting.raster_divisor,
                     static_cast<int>(tuning_of(o).culling), tuning_of(o).visible_exponent,
                     tuning_of(o).grazing_exponent, tuning_of(o).forced_exponent, tuning_of(o).covered_factor,
                     fmt::join(tuning_of(o).occluder_splits, ","), tuning_of(o).retest_hidden, tuning_of(o).final_check,
                     static_cast<int>(o.mode), static_cast<int>(tuning_of(o).proxy), tuning_of(o).level_step);
}

SettingRun::SettingRun(const Setting& setting, std::vector<LoadedObject> objects)
    : setting_(setting),
      objects_(as_asked(std::move(objects), setting)),
      measurement_(objects_, setting.frame_to_frame ? tool::Following::frame_to_frame : tool::Following::none),
      visibility_(make_visibility(setting)) {}

void SettingRun::start(const View& view) {
  RefineOptions unlimited = setting_.refine;
  unlimited.max_changes = 0;
  unlimited.time_limit_ms = 0.0;
  measurement_.repeat(view, unlimited, *visibility_);
  record();
}

void SettingRun::record() { hash_ = combined(hash_, measurement_.refinement().hash()); }

void SettingRun::next(const View& view) {
  measurement_.begin();
  measurement_.repeat(view, setting_.refine, *visibility_);
  record();
  const tool::RenderTimes times = measurement_.times();
  refine_ms_.push_back(times.refine_ms);
  occlusion_ms_.push_back(times.occlusion_ms);
  ms_.push_back(times.refine_ms + times.occlusion_ms);
  draw_ms_.push_back(times.draw_ms);
  triangles_.push_back(static_cast<double>(measurement_.refinement().stats.triangles));
}

void SettingRun::next(const View& view, const tool::FullMeshPicture& full) {
  ItemBuffer before;
  draw_items(before, measurement_.objects(), view);
  next(view);
  const PictureDistance distance = full.distance_to(measurement_.items(), measurement_.objects());
  const double largest_px = largest_motion_px(view, full.items().depth, measurement_.items().depth);
  const Popping popping = measure_popping(view, before.depth, measurement_.items().depth);
  const Share share{measurement_.refinement().stats.triangles, measurement_.visible_triangles(), {}};
  pictures_.push_back({distance.depth_rms_px, largest_px, distance.psnr_y, distance.psnr_cb, distance.psnr_cr,
                       distance.silhouette_mismatch, share.percent(), not_measured, popping.rms_px, popping.largest_px,
                       measurement_.refinement().stats.max_error_px,
                       full.texture_slip_px(measurement_.items(), measurement_.objects()).value_or(not_measured)});
}

Outcome SettingRun::outcome() const {
  return {median(refine_ms_), median(occlusion_ms_), median(ms_), median(draw_ms_),
          median(triangles_), mean_of(pictures_),    hash_,       pictures_};
}

}  // namespace occlod::bench
