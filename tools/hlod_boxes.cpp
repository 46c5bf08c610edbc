#include "hlod_boxes.h"

#include <algorithm>
#include <vector>

namespace occlod::tool {
namespace {

// Linear: blue, magenta, red.
glm::vec3 color_of(float bias) {
  const float weaker = 1.0F - bias;
  return {std::min(2.0F * weaker, 1.0F), 0.02F, std::min(2.0F * bias, 1.0F)};
}

}  // namespace

Image picture_of_boxes(const Front& front, std::span<const hlod::PlacedHlod> placed, const View& view) {
  FrontMesh mesh;
  mesh.assign(front, placed);
  std::vector<MarkedObject> marks;
  for (const hlod::DrawnNode& draw : front.draws)
    marks.push_back({placed[draw.object].hlod->node(draw.node).box, color_of(draw.bias)});
  return birdseye_boxes(mesh.objects(), marks, view, View(birdseye_camera(mesh.objects(), view)));
}

}  // namespace occlod::tool
