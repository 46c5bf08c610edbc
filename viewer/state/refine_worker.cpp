#include "refine_worker.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <exception>
#include <map>

#include "cells_bench.h"
#include "explain.h"
#include "hlod_bench.h"
#include "occlod/item_buffer.h"
#include "occlod/picture.h"
#include "side_refiner.h"

namespace occlod::viewer {
namespace {

// After this many frames that change nothing, the work that is left over is given up: a frame's time does not suffice.
constexpr int max_idle_frames = 8;

std::vector<DrawObject> draw_objects(const Objects& objects, const SideRefiner& refiner, const Refinement& refinement) {
  std::vector<DrawObject> result;
  for (std::size_t i = 0; i < objects.size(); ++i)
    result.push_back({refiner.positions(i), {}, refinement.objects[i].triangles, objects[i].object_to_world});
  return result;
}

bool is_pending(const RefinedSide& side) { return side.refinement.stats.pending; }
bool has_changed(const RefinedSide& side) {
  return side.refinement.stats.new_splits + side.refinement.stats.merged_splits > 0;
}
bool is_sliding(const RefinedSide& side) {
  return std::any_of(side.refinement.objects.begin(), side.refinement.objects.end(),
                     [](const RefinedObject& object) { return !object.geomorphs.empty(); });
}

std::vector<glm::u8vec4> level_colors(const ViewMesh& mesh, const RefinedObject& refined) {
  const double deepest = std::max(mesh.level_count - 1, 1);
  std::vector<glm::u8vec4> colors;
  for (const SplitId s : born_splits(*mesh.hierarchy, refined.triangles))
    colors.push_back(s == no_id ? base_mesh_color : level_color(mesh.levels[s] / deepest));
  return colors;
}

// `ages` are those of refined.splits.
std::vector<glm::u8vec4> age_colors(const Hierarchy& hierarchy, const RefinedObject& refined,
                                    std::span<const std::uint32_t> ages) {
  std::vector<glm::u8vec4> colors;
  for (const SplitId s : born_splits(hierarchy, refined.triangles)) {
    const auto place = std::lower_bound(refined.splits.begin(), refined.splits.end(), s) - refined.splits.begin();
    colors.push_back(s == no_id ? base_mesh_color : age_color(ages[static_cast<std::size_t>(place)]));
  }
  return colors;
}

template <class Values, class Color>
std::vector<glm::u8vec4> colored(const Values& values, const Color& color) {
  std::vector<glm::u8vec4> colors;
  colors.reserve(values.size());
  for (const auto& value : values) colors.push_back(color(value));
  return colors;
}

// Holds what lives as long as the thread.
class Bench {
 public:
  // The references must outlive the bench.
  Bench(const MakeVisibility& make, const MakeDevice& make_device, std::optional<Calibration>& calibration)
      : make_(make), calibration_(calibration), hlods_(make_device, calibration) {}

  [[nodiscard]] RefinedFrame work(RefineJob job) {
    RefinedFrame frame;
    frame.job = std::move(job);
    try {
      if (are_hlods(*frame.job.objects))
        hlods_.draw(frame);
      else if (frame.job.cells)
        walk(frame);
      else
        refine(frame);
    } catch (const std::exception& error) {
      frame.sides.clear();
      frame.hlod_sides.clear();
      frame.cells.reset();
      frame.error = error.what();
      forget();  // do not continue from what failed
      backends_.clear();
      hlods_.forget();
      cells_.forget();
    }
    return frame;
  }

 private:
  void refine(RefinedFrame& frame) {
    RefineJob& job = frame.job;
    cells_.forget();
    place(job, job.compare && job.beside == Beside::other ? 2 : 1);
    job.options.budget = std::max(job.options.budget, refiners_[0].base_triangles());
    frame.sides.push_back(side(refiners_[0], job, job.occlusion));
    frame.hash = frame.sides[0].refinement.hash();
    if (job.compare) frame.sides.push_back(side_beside(job));
    frame.goes_on = job.frame_to_frame && goes_on(frame);
  }

  // Continues from no mesh and no picture.
  void forget() {
    refiners_.clear();
    pictured_ = make_software_occlusion();
  }

  // Call it after side() of what it stands beside.
  [[nodiscard]] RefinedSide side_beside(const RefineJob& job) {
    if (job.beside == Beside::other) return side(refiners_[1], job, Occlusion::none);
    full_.set(objects_);
    if (full_of_ != objects_) {
      full_of_ = objects_;
      full_number_ = ++refinements_;
    }
    RefinedSide result;
    result.refinement.objects.resize(objects_->size());
    result.colors.resize(objects_->size());
    result.refinement.stats.triangles = full_.triangle_count();
    if (job.beside == Beside::difference) {
      result.number = ++refinements_;
      result.difference = full_.difference(job.camera, items_.depth);  // side() has drawn them
      return result;
    }
    result.number = full_number_;
    for (std::size_t i = 0; i < objects_->size(); ++i) result.refinement.objects[i].triangles = full_.triangles(i);
    return result;
  }

  // Walks through cells, and refines beside them to compare.
  void walk(RefinedFrame& frame) {
    cells_.walk(frame, refinements_);
    RefineJob& job = frame.job;
    frame.hash = frame.sides[0].refinement.hash();
    if (!job.compare) return refiners_.clear();
    place(job, 1);
    job.options.budget = std::max(job.options.budget, refiners_[0].base_triangles());
    frame.sides.push_back(side(refiners_[0], job, job.occlusion));
  }

  // Makes one refiner for each side that is refined.
  void place(const RefineJob& job, std::size_t count) {
    const bool chooses = job.occlusion == Occlusion::automatic;
    if (job.objects != objects_ || job.from_scratch || chooses != chooses_) forget();
    objects_ = job.objects;
    chooses_ = chooses;
    while (refiners_.size() > count) refiners_.pop_back();
    if (refiners_.size() == count) return;
    const std::vector<RefineObject> list = refine_objects(*objects_);
    while (refiners_.size() < count)
      if (chooses && refiners_.empty())
        refiners_.emplace_back(list, calibration(), visibility(Occlusion::software));
      else
        refiners_.emplace_back(list);
  }

  [[nodiscard]] const Calibration& calibration() {
    if (!calibration_) {
      std::vector<std::unique_ptr<Visibility>> backends;
      backends.push_back(make_(Occlusion::software));
      calibration_ = measure_calibration(backends);
    }
    return *calibration_;
  }

  [[nodiscard]] bool goes_on(const RefinedFrame& frame) {
    const auto any = [&](auto is) { return std::any_of(frame.sides.begin(), frame.sides.end(), is); };
    idle_frames_ = frame.job.again && !any(has_changed) ? idle_frames_ + 1 : 0;
    return any(is_sliding) || (any(is_pending) && idle_frames_ < max_idle_frames);
  }

  [[nodiscard]] RefinedSide side(SideRefiner& refiner, const RefineJob& job, Occlusion occlusion) {
    RefinedSide result;
    refiner.refine(result, job, occlusion, visibility(occlusion), ++refinements_);
    explain(result, job, refiner);
    if (occlusion == Occlusion::picture) pictured_->show(items_.depth);
    return result;
  }

  [[nodiscard]] Visibility& visibility(Occlusion occlusion) {
    if (occlusion == Occlusion::picture) return *pictured_;
    if (occlusion == Occlusion::automatic) occlusion = Occlusion::software;
    std::unique_ptr<Visibility>& backend = backends_[occlusion];
    if (!backend) backend = make_(occlusion);
    return *backend;
  }

  void explain(RefinedSide& side, const RefineJob& job, const SideRefiner& refiner) {
    const View view(job.camera);
    const Objects& objects = *job.objects;
    std::vector<bool> owns_pixel;
    if (job.count_visible || job.keep_seen || job.color_by == ColorBy::visibility ||
        job.occlusion == Occlusion::picture) {
      items_.reset(view.width(), view.height());
      draw_items(items_, draw_objects(objects, refiner, side.refinement), view);
      owns_pixel = visible_items(items_, side.refinement.stats.triangles);
      side.visible_triangles = static_cast<std::size_t>(std::count(owns_pixel.begin(), owns_pixel.end(), true));
    }
    std::size_t first_item = 0;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const RefinedObject& refined = side.refinement.objects[i];
      if (job.keep_seen || job.color_by == ColorBy::visibility)
        side.seen_colors.push_back(seen_colors(view, objects[i], refined, owns_pixel, first_item));
      side.colors.push_back(colors(job, view, i, side, refiner));
      first_item += refined.triangles.size();
    }
  }

  [[nodiscard]] static std::vector<glm::u8vec4> seen_colors(const View& view, const PlacedObject& object,
                                                            const RefinedObject& refined,
                                                            const std::vector<bool>& owns_pixel,
                                                            std::size_t first_item) {
    return colored(classify(object, refined.triangles, view, owns_pixel, first_item),
                   [](Seen seen) { return color_of(seen); });
  }

  // Returns the colours of one object of a side whose seen_colors and occluder are set as far as the job asks for them.
  [[nodiscard]] static std::vector<glm::u8vec4> colors(const RefineJob& job, const View& view, std::size_t i,
                                                       const RefinedSide& side, const SideRefiner& refiner) {
    const PlacedObject& object = (*job.objects)[i];
    const RefinedObject& refined = side.refinement.objects[i];
    switch (job.color_by) {
      case ColorBy::plain:
      case ColorBy::vertices:
      case ColorBy::texture:
        return {};
      case ColorBy::level:
        return level_colors(*object.mesh, refined);
      case ColorBy::error:
        return colored(errors_px(object, refined, view), [](double px) { return error_color(px); });
      case ColorBy::slip:
        return colored(errors_px(object, refined, view, ErrorOf::attributes),
                       [](double px) { return error_color(px); });
      case ColorBy::visibility:
        return side.seen_colors[i];
      case ColorBy::outcome:
        return colored(outcomes(object, refined, view, side.occluder.get()),
                       [](Outcome outcome) { return color_of(outcome); });
      case ColorBy::age:
        return age_colors(*object.mesh->hierarchy, refined, refiner.visibility_ages(i));
    }
    return {};
  }

  const MakeVisibility& make_;
  std::optional<Calibration>& calibration_;
  bool chooses_ = false;
  std::shared_ptr<const Objects> objects_;
  std::map<Occlusion, std::unique_ptr<Visibility>> backends_;
  std::unique_ptr<SoftwareOcclusion> pictured_ = make_software_occlusion();  // of Occlusion::picture
  std::deque<SideRefiner> refiners_;  // a deque, because neither they nor their backends may move
  std::uint64_t refinements_ = 0;
  int idle_frames_ = 0;
  ItemBuffer items_;
  FullMesh full_;
  std::shared_ptr<const Objects> full_of_;  // the objects of full_number_
  std::uint64_t full_number_ = 0;           // of the refinement that the full meshes are taken for
  HlodBench hlods_;
  CellsBench cells_;
};

}  // namespace

RefineWorker::RefineWorker(MakeVisibility make_visibility, std::optional<Calibration> calibration,
                           MakeDevice make_device)
    : make_visibility_(std::move(make_visibility)),
      make_device_(std::move(make_device)),
      calibration_(std::move(calibration)),
      thread_([this] { run(); }) {}

RefineWorker::~RefineWorker() {
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void RefineWorker::request(RefineJob job) {
  {
    const std::lock_guard lock(mutex_);
    job.from_scratch = job.from_scratch || (next_ && next_->from_scratch);
    next_ = std::move(job);
  }
  changed_.notify_all();
}

std::shared_ptr<const RefinedFrame> RefineWorker::latest() const {
  const std::lock_guard lock(mutex_);
  return latest_;
}

void RefineWorker::wait_for(std::uint64_t number, double milliseconds) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double, std::milli>(milliseconds),
                    [&] { return latest_ && latest_->job.number >= number; });
}

void RefineWorker::run() {
  Bench bench(make_visibility_, make_device_, calibration_);
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return end_ || next_; });
    if (end_) return;
    RefineJob job = std::move(*next_);
    next_.reset();
    lock.unlock();
    auto frame = std::make_shared<const RefinedFrame>(bench.work(std::move(job)));
    lock.lock();
    latest_ = std::move(frame);
    changed_.notify_all();
  }
}

}  // namespace occlod::viewer
