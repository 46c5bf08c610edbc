#include "gl/batched_visibility.h"

#include <cassert>

namespace occlod::gl {

void BatchedVisibility::begin_view(const View& view, std::span<const ObjectView> objects) {
  answers_.clear();
  start_view(view, objects);
}

void BatchedVisibility::draw_occluder(std::span<const OccluderPart> parts) {
  assert(answers_.empty());
  start_occluder(parts);
}

void BatchedVisibility::submit(const VisibilityQuery& query) { answers_.push_back(ask(query)); }

std::uint32_t BatchedVisibility::collect() {
  assert(!answers_.empty());
  if (!answers_.front()) {
    answer_all(batch_);
    auto next = batch_.begin();
    for (std::optional<std::uint32_t>& answer : answers_)
      if (!answer) answer = *next++;
    assert(next == batch_.end());
  }
  const std::uint32_t oldest = *answers_.front();
  answers_.pop_front();
  return oldest;
}

}  // namespace occlod::gl
