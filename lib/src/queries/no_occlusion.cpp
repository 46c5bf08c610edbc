#include <cassert>

#include "occlod/refine/visibility.h"

namespace occlod {

void NoOcclusion::begin_view(const View& /*view*/, std::span<const ObjectView> /*objects*/) { unanswered_ = 0; }

void NoOcclusion::draw_occluder(std::span<const OccluderPart> /*parts*/) {}

void NoOcclusion::submit(const VisibilityQuery& /*query*/) { ++unanswered_; }

std::uint32_t NoOcclusion::collect() {
  assert(unanswered_ > 0);
  --unanswered_;
  return 1;
}

}  // namespace occlod
