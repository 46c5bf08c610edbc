#include "hlod_bench.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hlod_cache.h"
#include "occlod/base.h"
#include "occlod/device.h"

namespace occlod::viewer {
namespace {

// A static view is drawn until this many frames in succession have drawn the same, or this many in all.
constexpr int min_repeats = 3;
constexpr int max_frames_at_rest = 24;
// With a limit on triangles, a large HLOD begins with this tolerance, and gets finer by a factor from frame to frame:
// in a moving view while so many times as many triangles would still do, in one that stands still as long as it can.
constexpr double first_px = 64.0;
constexpr double finer = 0.8;
constexpr double room = 1.5;
// Below the one a tolerance is what was asked for, beyond the other it is raised no more.
constexpr double finest_px = 1.0 / 64.0;
constexpr double coarsest_px = 1e5;

bool are_same_hlods(const Objects& a, const Objects& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const PlacedObject& x, const PlacedObject& y) {
    return x.hlod == y.hlod && x.two_sided == y.two_sided;
  });
}

std::size_t input_triangles(const Objects& objects) {
  std::size_t sum = 0;
  for (const PlacedObject& object : objects) sum += object.hlod->hlod->data().input_triangle_count;
  return sum;
}

}  // namespace

std::unique_ptr<hlod::RenderDevice> make_portable_device(HlodDevice device) {
  if (device == HlodDevice::gl) throw Error({"device", "gl", "needs a window", "choose software"});
  return std::make_unique<hlod::SoftwareDevice>();
}

void HlodBench::draw(RefinedFrame& frame) {
  const RefineJob& job = frame.job;
  place(job);
  frame.hlod_sides.push_back(draw(sides_[0], job, job.hlod.traverse.strategy));
  if (job.compare) frame.hlod_sides.push_back(draw(sides_[1], job, job.hlod.other_strategy));
  frame.hash = frame.hlod_sides[0].front->frame.front_hash;
  frame.device_costs = costs(job.hlod.device, false);
  frame.goes_on = goes_on(job);
  const std::vector<hlod::PlacedHlod> placed = placed_hlods(*objects_);
  frame.cache = tool::store_stats(placed);
  if (frame.cache && frame.cache->loading_bytes > 0) frame.goes_on = true;
  tool::print_failures(placed);
}

void HlodBench::forget() {
  sides_.clear();
  pictures_ = {};
  objects_.reset();
  devices_.clear();
}

// Makes one traverser for each side. What is known of nodes is kept while objects only move.
void HlodBench::place(const RefineJob& job) {
  const bool keeps = objects_ && !job.from_scratch && are_same_hlods(*objects_, *job.objects);
  if (!keeps) {
    sides_.clear();
    pictures_ = {};  // of HLODs that may be gone
  }
  const bool moved = std::exchange(objects_, job.objects) != job.objects;
  const std::size_t count = job.compare ? 2 : 1;
  while (sides_.size() > count) sides_.pop_back();
  for (Side& side : sides_) {
    if (!moved) break;
    for (std::size_t i = 0; i < objects_->size(); ++i) side.traverser.set_transform(i, (*objects_)[i].object_to_world);
    side.asked.reset();
  }
  const std::vector<hlod::PlacedHlod> placed = placed_hlods(*objects_);
  while (sides_.size() < count) sides_.push_back({hlod::Traverser(placed), std::nullopt, nullptr, 0, 0.0, 0.0});
}

HlodSide HlodBench::draw(Side& side, const RefineJob& job, hlod::Strategy strategy) {
  const View view(job.camera);
  const Asked asked{job.camera, options_of(job, strategy), job.hlod.device, job.hlod.most_triangles};
  if (job.again || side.asked != asked) {
    side.asked.reset();  // in case this fails
    const hlod::Frame& frame = draw_within(side, view, asked, job);
    const bool repeats = side.front && job.again && side.front->frame.front_hash == frame.front_hash;
    side.repeats = repeats ? side.repeats + 1 : 0;
    side.front = make_front(frame, *job.objects, ++fronts_);
    side.asked = asked;
  }
  HlodSide drawn{strategy, side.front, side.tolerance_px, colors_of(*side.front, *job.objects, view, job.hlod), {}};
  if (job.hlod.color_by == HlodColorBy::texture)
    drawn.images = pictures_.of(side.front->frame.draws, placed_hlods(*job.objects));
  return drawn;
}

std::optional<double> HlodBench::finer_px(const Side& side, double wanted_px) {
  if (!side.front || !(side.tolerance_px > wanted_px)) return std::nullopt;
  double px = std::max(finer * side.tolerance_px, wanted_px);
  if (px < finest_px) px = wanted_px;
  return px > side.too_fine_px ? std::optional(px) : std::nullopt;
}

// Raises the tolerance until the frame has no more triangles than it may have. What is too coarse gets finer in the
// next frames, so that the first frame of a large HLOD does not take long.
const hlod::Frame& HlodBench::draw_within(Side& side, const View& view, const Asked& asked, const RefineJob& job) {
  hlod::TraverseOptions options = asked.options;
  const bool is_limited = asked.most_triangles > 0 && input_triangles(*job.objects) > asked.most_triangles;
  if (!job.again) side.too_fine_px = 0.0;
  if (is_limited && !side.front && job.hlod.settle && !job.from_scratch) side.tolerance_px = first_px;
  const bool has_room = side.front && room * static_cast<double>(side.front->frame.stats.drawn_triangles) <
                                          static_cast<double>(asked.most_triangles);
  if (job.again || has_room) side.tolerance_px = finer_px(side, options.tolerance_px).value_or(side.tolerance_px);
  side.tolerance_px = is_limited ? std::max(side.tolerance_px, asked.options.tolerance_px) : options.tolerance_px;
  while (true) {
    options.tolerance_px = side.tolerance_px;
    const hlod::Frame& frame = side.traverser.draw_frame(view, device(asked.device), options);
    const std::size_t drawn = frame.stats.drawn_triangles;
    if (!is_limited || drawn <= asked.most_triangles || side.tolerance_px >= coarsest_px) return frame;
    side.too_fine_px = side.tolerance_px;
    const double excess = std::sqrt(static_cast<double>(drawn) / static_cast<double>(asked.most_triangles));
    side.tolerance_px = std::max(side.tolerance_px, finest_px) * std::clamp(excess, 1.1, 4.0);
  }
}

hlod::TraverseOptions HlodBench::options_of(const RefineJob& job, hlod::Strategy strategy) {
  hlod::TraverseOptions options = job.hlod.traverse;
  options.strategy = strategy;
  options.geomorph = job.hlod.between == HlodBetween::geomorph;
  options.within = job.hlod.between == HlodBetween::within;
  if (hlod::needs_costs(strategy)) options.costs = *costs(job.hlod.device, true);
  return options;
}

hlod::RenderDevice& HlodBench::device(HlodDevice device) {
  std::unique_ptr<hlod::RenderDevice>& made = devices_[device];
  if (!made) made = make_(device);
  return *made;
}

std::optional<hlod::DeviceCosts> HlodBench::costs(HlodDevice device, bool needed) {
  if (const auto known = costs_.find(device); known != costs_.end()) return known->second;
  if (calibration_)
    for (const hlod::DeviceCosts& known : calibration_->devices)
      if (known.name == name_of(device)) return costs_[device] = known;
  if (!needed) return std::nullopt;
  return costs_[device] = hlod::measure_costs(this->device(device));
}

bool HlodBench::goes_on(const RefineJob& job) {
  frames_at_rest_ = job.again ? frames_at_rest_ + 1 : 1;
  const auto gets_finer = [&](const Side& side) { return finer_px(side, job.hlod.traverse.tolerance_px).has_value(); };
  if (job.hlod.settle && std::ranges::any_of(sides_, gets_finer)) return true;
  if (!job.hlod.settle || frames_at_rest_ >= max_frames_at_rest) return false;
  return std::any_of(sides_.begin(), sides_.end(), [](const Side& side) { return side.repeats < min_repeats; });
}

}  // namespace occlod::viewer
