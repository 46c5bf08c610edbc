#include "cell_walk.h"

#include <algorithm>
#include <bit>
#include <ctime>
#include <utility>

#include "occlod/compare.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

double thread_cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace

std::uint64_t hash_of(const WalkedFrame& frame) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < frame.objects.size(); ++i)
    for (const Triangle& t : frame.objects[i].triangles) {
      std::uint64_t h = 14695981039346656037U + i;
      for (int k = 0; k < 9; ++k)
        h = (h ^ std::bit_cast<std::uint32_t>(frame.objects[i].positions[t[k / 3]][k % 3])) * 1099511628211U;
      sum += h ^ h >> 32U;
    }
  return sum;
}

CellWalk::CellWalk(std::shared_ptr<const VlodFile> file, std::span<const RefineObject> objects,
                   const CellWalkOptions& options)
    : file_(std::move(file)),
      objects_(objects.empty() ? placements(*file_) : std::vector<RefineObject>(objects.begin(), objects.end())) {
  walker_.emplace(file_, objects, WalkOptions{.memory = options.memory, .loaders = 0});
  WalkTrial trial{.prefetch = options.prefetch};
  if (options.disk) {
    const auto wait = [this](double seconds) { disk_clock_ += seconds; };
    trial.reader =
        throttled([this](CellId cell, std::span<const CellAdditions* const> above) { return file_->read(cell, above); },
                  *file_, *options.disk, wait);
    trial.before_geometry = throttled_geometry(*options.disk, wait);
  }
  walker_->set_trial(std::move(trial));
  loader_.emplace(*walker_);
  takes_time_ = options.disk.has_value();
  disk_clock_ = 0.0;  // the walker's first reads came before the walk
}

void CellWalk::run_loads() {
  now_ += walk_frame_seconds;
  while (disk_clock_ <= now_ || !takes_time_) {
    if (under_way_) loader_->finish();
    disk_clock_ = std::max(disk_clock_, now_ - walk_frame_seconds);
    const double start = thread_cpu_ms();
    under_way_ = loader_->begin();
    if (!under_way_) return;
    const double ms = thread_cpu_ms() - start;
    load_ms_ += ms;
    disk_clock_ += 1e-3 * ms;
  }
}

const WalkedFrame& CellWalk::step_to(const Camera& camera) {
  walked_ = &walker_->step(camera.eye, walk_frame_seconds);
  stepped_ = *walked_;
  stepped_.objects.clear();
  run_loads();
  return stepped_;
}

void CellWalk::stand(const Camera& camera, double seconds) {
  for (double done = 0.0; done < seconds; done += walk_frame_seconds) step_to(camera);
}

const CellWalkFrame& CellWalk::go_to(const Camera& camera) {
  const View view(camera);
  double start = thread_cpu_ms();
  const WalkedFrame& walked = walker_->step(camera.eye, walk_frame_seconds);
  walked_ = &walked;
  const double stepped = thread_cpu_ms();
  ranges_in_view(walked, objects_, view, ranges_);
  const double culled = thread_cpu_ms();
  drawn_.clear();
  std::size_t triangles = 0;
  for (const ObjectRange& range : ranges_) {
    const WalkedObject& object = walked.objects[range.object];
    drawn_.push_back({object.positions, object.colors, object.triangles.subspan(range.first, range.count),
                      objects_[range.object].object_to_world});
    triangles += range.count;
  }
  const Stopwatch drawing;
  draw_items(items_, drawn_, view);
  frame_ = {camera,
            walked,
            triangles,
            stepped - start,
            culled - stepped,
            drawing.milliseconds(),
            std::exchange(load_ms_, 0.0),
            walked.changed ? hash_of(walked) : frame_.hash};
  frame_.walked.objects.clear();
  run_loads();
  return frame_;
}

void WalkReference::set_view(const View& view) { full_.draw(items_, view); }

WalkReference::Distance WalkReference::compare(const View& view, const DepthBuffer& depth, double allowed_px) const {
  const Image blank{
      view.width(), view.height(),
      std::vector<glm::u8vec4>(static_cast<std::size_t>(view.width()) * static_cast<std::size_t>(view.height()))};
  return {count_unexplained_pixels(view, items_.depth, depth, allowed_px),
          compare_pictures(view, depth, blank, items_.depth, blank).depth_rms_px};
}

}  // namespace occlod::tool
