#include "recorded_occlusion.h"

namespace occlod::viewer {

void RecordedOcclusion::begin(bool keeps) {
  parts_.clear();
  keeps_ = keeps;
}

void RecordedOcclusion::begin_view(const View& view, std::span<const ObjectView> objects) {
  object_to_clip_.clear();
  for (const ObjectView& object : objects) object_to_clip_.push_back(object.object_to_clip());
  width_ = view.width();
  height_ = view.height();
  inner_.begin_view(view, objects);
}

void RecordedOcclusion::draw_occluder(std::span<const OccluderPart> parts) {
  inner_.draw_occluder(parts);
  if (!keeps_) return;
  parts_.resize(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts_[i].object = parts[i].object;
    parts_[i].corners.clear();
    parts_[i].corners.reserve(3 * parts[i].triangles.size());
    for (const Triangle& t : parts[i].triangles)
      for (int k = 0; k < 3; ++k) parts_[i].corners.push_back(parts[i].positions[t[k]]);
  }
}

std::shared_ptr<const DepthPyramid> RecordedOcclusion::depth() const {
  if (parts_.empty()) return nullptr;
  auto pyramid = std::make_shared<DepthPyramid>();
  const DepthImage image = pyramid->begin(width_, height_);
  PixelRect drawn;
  std::vector<Triangle> triangles;
  for (const Part& part : parts_) {
    triangles.clear();
    for (std::uint32_t i = 0; i < part.corners.size(); i += 3) triangles.emplace_back(i, i + 1, i + 2);
    drawn = united(drawn, draw_depth(image, part.corners, triangles, object_to_clip_[part.object]));
  }
  pyramid->finish(drawn);
  return pyramid;
}

}  // namespace occlod::viewer
