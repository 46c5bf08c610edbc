#include "full_mesh.h"

#include <algorithm>
#include <cmath>

#include "occlod/build_hierarchy.h"
#include "occlod/compare.h"
#include "palette.h"

namespace occlod::viewer {
namespace {

glm::u8vec4 color_at(const View& view, double shown, double full) {
  if (!(shown > 0.0) && !(full > 0.0)) return no_surface_color;
  if (!(shown > 0.0 && full > 0.0)) return one_surface_color;
  // As compare_pictures() measures it.
  return error_color(std::abs(view.distance_at(shown) - view.distance_at(full)) * view.scale_px_at(full));
}

}  // namespace

void FullMesh::set(std::shared_ptr<const Objects> objects) {
  if (objects == objects_) return;
  objects_ = std::move(objects);
  depth_ = {};
  std::erase_if(triangles_, [&](const auto& entry) {
    return std::none_of(objects_->begin(), objects_->end(),
                        [&](const PlacedObject& object) { return object.mesh == entry.first; });
  });
  for (const PlacedObject& object : *objects_)
    if (!triangles_.contains(object.mesh))
      triangles_[object.mesh] = wedge_triangles_of(*object.mesh->hierarchy, full_cut(*object.mesh->hierarchy));
}

const std::vector<Triangle>& FullMesh::triangles(std::size_t object) const {
  return triangles_.at((*objects_)[object].mesh);
}

std::size_t FullMesh::triangle_count() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < objects_->size(); ++i) count += triangles(i).size();
  return count;
}

std::shared_ptr<const DepthDifference> FullMesh::difference(const Camera& camera, const DepthBuffer& shown) {
  const View view(camera);
  if (depth_.nearness.empty() || camera_ != camera) {
    depth_.reset(view.width(), view.height());
    for (std::size_t i = 0; i < objects_->size(); ++i) {
      const PlacedObject& object = (*objects_)[i];
      draw_depth(depth_, object.mesh->hierarchy->positions(), triangles(i),
                 ObjectView(view, object.object_to_world).object_to_clip());
    }
    camera_ = camera;
  }
  auto result = std::make_shared<DepthDifference>();
  const PictureDistance distance = compare_pictures(view, shown, {}, depth_, {});
  result->rms_px = distance.depth_rms_px;
  result->silhouette_mismatch = distance.silhouette_mismatch;
  result->image = {view.width(), view.height(), {}};
  result->image.pixels.reserve(depth_.nearness.size());
  for (std::size_t i = 0; i < depth_.nearness.size(); ++i)
    result->image.pixels.push_back(
        color_at(view, static_cast<double>(shown.nearness[i]), static_cast<double>(depth_.nearness[i])));
  return result;
}

}  // namespace occlod::viewer
