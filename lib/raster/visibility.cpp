#include "occlod/visibility.h"

#include <algorithm>
#include <cassert>

namespace occlod {

void Visibility::set_threads(unsigned /*threads*/) {}

void Visibility::find_visible_points(std::uint32_t /*object*/, std::span<const glm::vec3> points,
                                     std::span<std::uint8_t> visible) {
  assert(visible.size() >= points.size());
  std::fill_n(visible.begin(), points.size(), std::uint8_t{0});
}

void Visibility::answer(std::span<const VisibilityQuery> queries, std::span<std::uint32_t> answers) {
  assert(answers.size() >= queries.size());
  const std::size_t max_open = std::max<std::size_t>(flight(), 1);
  std::size_t answered = 0;
  for (std::size_t asked = 0; asked < queries.size(); ++asked) {
    if (asked - answered == max_open) answers[answered++] = collect();
    submit(queries[asked]);
  }
  while (answered < queries.size()) answers[answered++] = collect();
}

void NoOcclusion::begin_view(const View& /*view*/, std::span<const ObjectView> /*objects*/) { unanswered_ = 0; }

void NoOcclusion::draw_occluder(std::span<const OccluderPart> /*parts*/) {}

void NoOcclusion::submit(const VisibilityQuery& /*query*/) { ++unanswered_; }

std::uint32_t NoOcclusion::collect() {
  assert(unanswered_ > 0);
  --unanswered_;
  return 1;
}

}  // namespace occlod
