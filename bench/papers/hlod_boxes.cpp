#include "papers/hlod_boxes.h"

#include <vector>

#include "bias_color.h"

namespace occlod::tool {

Image picture_of_boxes(const Front& front, std::span<const hlod::PlacedHlod> placed, const View& view) {
  FrontMesh mesh;
  mesh.assign(front, placed);
  std::vector<MarkedObject> marks;
  for (const hlod::DrawnNode& draw : front.draws)
    marks.push_back({placed[draw.object].hlod->node(draw.node).box, bias_color(draw.bias)});
  return birdseye_boxes(mesh.objects(), marks, view, View(birdseye_camera(mesh.objects(), view)));
}

}  // namespace occlod::tool
