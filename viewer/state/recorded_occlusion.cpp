#include "recorded_occlusion.h"

namespace occlod::viewer {

void RecordedOcclusion::begin_view(const View& view, std::span<const ObjectView> objects) {
  object_to_clip_.clear();
  for (const ObjectView& object : objects) object_to_clip_.push_back(object.object_to_clip());
  width_ = view.width();
  height_ = view.height();
  parts_.clear();
  inner_.begin_view(view, objects);
}

void RecordedOcclusion::draw_occluder(std::span<const OccluderPart> parts) {
  parts_.clear();
  for (const OccluderPart& part : parts)
    parts_.push_back({object_to_clip_[part.object],
                      {part.positions.begin(), part.positions.end()},
                      {part.triangles.begin(), part.triangles.end()}});
  inner_.draw_occluder(parts);
}

std::shared_ptr<const DepthPyramid> RecordedOcclusion::depth() const {
  if (parts_.empty()) return nullptr;
  auto pyramid = std::make_shared<DepthPyramid>();
  const DepthImage image = pyramid->begin(width_, height_);
  PixelRect drawn;
  for (const Part& part : parts_)
    drawn = united(drawn, draw_depth(image, part.positions, part.triangles, part.object_to_clip));
  pyramid->finish(drawn);
  return pyramid;
}

}  // namespace occlod::viewer
