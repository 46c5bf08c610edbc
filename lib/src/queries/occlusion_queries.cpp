#include "queries/occlusion_queries.h"

#include <cassert>

#include "queries/query_shape.h"

namespace occlod {

void OcclusionQueries::begin(Visibility& visibility, const QueriedScene& scene) {
  visibility_ = &visibility;
  scene_ = scene;
  open_.clear();
  answered_ = 0;
  counts_ = {};
  const Clock::time_point start = Clock::now();
  visibility_->begin_view(*scene.view, scene.views);
  can_hide_ = visibility_->can_hide();
  flight_ = visibility_->flight();
  milliseconds_ = milliseconds_since(start);
}

bool OcclusionQueries::asks(const Entry& entry) const {
  const RefineOptions* const options = scene_.options;
  if (entry.kind == Entry::Kind::apply ? !asks_stars()
                                       : entry.level % options->queries.level_step != options->queries.level_step - 1)
    return false;
  return asks_in_region(entry.object, entry.split);
}

bool OcclusionQueries::asks_in_region(std::uint32_t object, SplitId s) const {
  return scene_.gate->asks(object, scene_.cuts->hierarchy(object).node(s).sphere.center);
}

bool OcclusionQueries::asks_stars() const {
  const RefineOptions* const options = scene_.options;
  return options->priority.culling == Culling::star && options->queries.ask_stars;
}

bool OcclusionQueries::asks_splits() const {
  const RefineOptions* const options = scene_.options;
  return options->priority.culling == Culling::subtree || asks_stars();
}

Entry::Kind OcclusionQueries::split_question() const {
  const RefineOptions* const options = scene_.options;
  return options->priority.culling == Culling::star ? Entry::Kind::apply : Entry::Kind::visit;
}

void OcclusionQueries::submit(const Entry& entry) {
  const RefineOptions* const options = scene_.options;
  ++counts_.asked;
  visibility_->submit(query_about(entry, scene_.cuts->hierarchy(entry.object), options->queries.proxy, star_));
}

bool OcclusionQueries::collect(const Entry& entry) {
  const bool visible = visibility_->collect() != 0;
  if (!visible) ++counts_.hidden;
  const glm::vec3& center = scene_.cuts->hierarchy(entry.object).node(entry.split).sphere.center;
  scene_.gate->answered(entry.object, entry.kind, center, entry.error.quadric_px, visible);
  return visible;
}

void OcclusionQueries::ask(const Entry& entry) {
  asked_ = Clock::now();
  submit(entry);
  if (in_flights()) milliseconds_ += milliseconds_since(asked_);
  // A flight that never empties moves those that are open to the front when they are the fewer: constant time for each.
  if (answered_ > open_.size() / 2) {
    open_.erase(open_.begin(), open_.begin() + static_cast<std::ptrdiff_t>(answered_));
    answered_ = 0;
  }
  open_.push_back(entry);
}

OcclusionQueries::Answer OcclusionQueries::take() {
  assert(!none_open());
  Answer answer{open_[answered_++]};
  // A clock costs as much as a test: a question that is answered at once is timed from asking to answering.
  const Clock::time_point start = in_flights() ? Clock::now() : asked_;
  answer.visible = collect(answer.entry);
  milliseconds_ += milliseconds_since(start);
  return answer;
}

void OcclusionQueries::draw_occluder(CutSet& cuts) {
  assert(none_open());
  const RefineOptions* const options = scene_.options;
  const std::span<const OccluderPart> parts =
      occluder_.build(scene_.objects, cuts, scene_.views, options->occluder.mode);
  const Clock::time_point start = Clock::now();
  visibility_->draw_occluder(parts);
  milliseconds_ += milliseconds_since(start);
  ++counts_.draws;
}

}  // namespace occlod
