#include "queries/questions.h"

#include <cassert>

namespace occlod {

void Questions::begin(Visibility& visibility, const View& view, std::span<const ObjectView> objects) {
  visibility_ = &visibility;
  open_.clear();
  answered_ = 0;
  const Clock::time_point start = Clock::now();
  visibility_->begin_view(view, objects);
  can_hide_ = visibility_->can_hide();
  flight_ = visibility_->flight();
  milliseconds_ = milliseconds_since(start);
}

void Questions::ask(const Entry& entry, const VisibilityQuery& query) {
  asked_ = Clock::now();
  visibility_->submit(query);
  if (in_flights()) milliseconds_ += milliseconds_since(asked_);
  // A flight that never empties moves those that are open to the front when they are the fewer: constant time for each.
  if (answered_ > open_.size() / 2) {
    open_.erase(open_.begin(), open_.begin() + static_cast<std::ptrdiff_t>(answered_));
    answered_ = 0;
  }
  open_.push_back(entry);
}

Questions::Answer Questions::take() {
  assert(!none_open());
  Answer answer{open_[answered_++]};
  // A clock costs as much as a test: a question that is answered at once is timed from asking to answering.
  const Clock::time_point start = in_flights() ? Clock::now() : asked_;
  answer.visible = visibility_->collect() != 0;
  milliseconds_ += milliseconds_since(start);
  return answer;
}

void Questions::draw_occluder(std::span<const OccluderPart> parts) {
  assert(none_open());
  const Clock::time_point start = Clock::now();
  visibility_->draw_occluder(parts);
  milliseconds_ += milliseconds_since(start);
}

}  // namespace occlod
