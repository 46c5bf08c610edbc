#include "hlod_reference.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "drawing.h"
#include "hlod/draw/trial.h"
#include "raster/clip.h"
#include "scene/shading.h"

namespace occlod::tool {
namespace {

hlod::TraverseOptions without_occlusion(hlod::TraverseOptions options) {
  options.strategy = hlod::Strategy::vfc;
  return options;
}

PictureDistance distance(const View& view, const ItemBuffer& items, const Image& image, const ItemBuffer& other,
                         const Image& other_image) {
  return compare_pictures(view, items.depth, image, other.depth, other_image);
}

// Returns whether no triangle of the node can be inside the frustum.
bool is_outside(const hlod::DrawnNode& draw, std::span<const hlod::PlacedHlod> placed, const View& view) {
  const hlod::PlacedHlod& object = placed[draw.object];
  return !ObjectView(view, object.object_to_world).may_be_inside(object.hlod->node(draw.node).sphere);
}

// Returns fragments of the input per pixel that it covers. `objects` are those of its nodes.
double depth_complexity(const Front& input, std::span<const DrawObject> objects,
                        std::span<const hlod::PlacedHlod> placed, const ItemBuffer& items, const View& view) {
  double layers = 0.0;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const DrawObject& object = objects[i];
    if (is_outside(input.draws[i], placed, view)) continue;
    layers += count_fragments(object.positions, object.triangles, ObjectView(view, object.object_to_world), true, 1)
                  .all.layers;
  }
  const auto covered = std::count_if(items.depth.nearness.begin(), items.depth.nearness.end(),
                                     [](float nearness) { return nearness > 0.0F; });
  return covered > 0 ? layers * view.width() * view.height() / static_cast<double>(covered) : 0.0;
}

// Draws as draw_items() does, but for what is beyond the far plane, which our rasteriser draws in perspective.
void redraw_to_far_plane(ItemBuffer& items, std::span<const DrawObject> objects, const View& view) {
  draw_items(items, objects, view);
  for (std::size_t i = 0; i < items.items.size(); ++i) {
    float& nearness = items.depth.nearness[i];
    if (items.items[i] == no_item || view.distance_at(nearness) <= view.camera().far) continue;
    nearness = 0.0F;
    items.items[i] = no_item;
  }
}

// Computes the point of the world that a pixel shows.
class PixelPoints {
 public:
  explicit PixelPoints(const View& view) : view_(view), to_world_(glm::inverse(view.world_to_clip())) {}

  [[nodiscard]] glm::dvec3 at(int x, int y, double nearness) const {
    const glm::dvec3 near = on_ray(x, y, -1.0), along = on_ray(x, y, 1.0) - near;
    const double start = glm::dot(near - view_.camera().eye, view_.direction());
    return near + along * ((view_.distance_at(nearness) - start) / glm::dot(along, view_.direction()));
  }

 private:
  [[nodiscard]] glm::dvec3 on_ray(int x, int y, double z) const {
    const glm::dvec4 clip(2.0 * (x + 0.5) / view_.width() - 1.0, 1.0 - 2.0 * (y + 0.5) / view_.height(), z, 1.0);
    const glm::dvec4 p = to_world_ * clip;
    return glm::dvec3(p) / p.w;
  }

  const View& view_;
  glm::dmat4 to_world_;
};

// Returns whether the view, which has these depths, shows the point to within 2 px.
bool shows(const View& view, const DepthBuffer& depth, const glm::dvec3& point) {
  const glm::dvec4 clip = view.world_to_clip() * glm::dvec4(point, 1.0);
  if (!(clip.w > 0.0) || std::abs(clip.x) >= clip.w || std::abs(clip.y) >= clip.w) return false;
  const auto x = static_cast<std::size_t>((clip.x / clip.w + 1.0) / 2.0 * view.width());
  const auto y = static_cast<std::size_t>((1.0 - clip.y / clip.w) / 2.0 * view.height());
  const double nearness = depth.nearness[y * static_cast<std::size_t>(view.width()) + x];
  if (!(nearness > 0.0)) return false;
  const double distance = glm::dot(point - view.camera().eye, view.direction());
  return std::abs(view.distance_at(nearness) - distance) * view.scale_px_at(nearness) <= 2.0;
}

// Returns, per pixel of `depth`, whether the other view shows the same point.
std::vector<bool> shown_in(const View& view, const DepthBuffer& depth, const View& other,
                           const DepthBuffer& other_depth) {
  const PixelPoints points(view);
  std::vector<bool> shown;
  shown.reserve(depth.nearness.size());
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const double nearness = depth.nearness[shown.size()];
      shown.push_back(nearness > 0.0 && shows(other, other_depth, points.at(x, y, nearness)));
    }
  return shown;
}

// Returns `depth` where the point is shown and `other` elsewhere, so that those pixels count as unchanged.
DepthBuffer where_shown(DepthBuffer depth, const DepthBuffer& other, const std::vector<bool>& shown) {
  for (std::size_t i = 0; i < shown.size(); ++i)
    if (!shown[i]) depth.nearness[i] = other.nearness[i];
  return depth;
}

}  // namespace

HlodReference::HlodReference(std::span<const hlod::PlacedHlod> placed, const hlod::TraverseOptions& options,
                             const hlod::Trial* trial)
    : placed_(placed),
      options_(without_occlusion(options)),
      unculled_(placed),
      input_(full_front(placed)),
      normals_(placed) {
  full_.mesh.assign(input_, placed_);
  if (trial == nullptr) return;
  hlod::Trial without_rival = *trial;
  without_rival.rival = nullptr;
  unculled_.set_trial(without_rival);
}

// `front` is what picture.mesh has.
void HlodReference::draw(Picture& picture, const Front& front) {
  const std::span<const DrawObject> objects = picture.mesh.objects();
  redraw_to_far_plane(picture.items, objects, *view_);
  picture.image =
      picture::shade_smooth(picture.items, objects, *view_, [&](const DrawObject& object, const glm::vec3& position) {
        return normals_.at(front.draws[static_cast<std::size_t>(&object - objects.data())].object, position);
      });
}

void HlodReference::set_view(const View& view, const View& last) {
  view_ = &view;
  draw(full_, input_);
  redraw_to_far_plane(before_items_, full_.mesh.objects(), last);
  shown_before_ = shown_in(view, full_.items.depth, last, before_items_.depth);
  depth_complexity_ = depth_complexity(input_, full_.mesh.objects(), placed_, full_.items, view);
  if (options_.tolerance_px == 0.0) {  // the input itself, which no box of a node decides about
    plain_.items = full_.items;
    plain_.image = full_.image;
    return;
  }
  const Front plain = front_of(unculled_.draw_frame(view, device_, options_));
  plain_.mesh.assign(plain, placed_);
  draw(plain_, plain);
}

HlodDistance HlodReference::compare(const Front& front, const Front& before) {
  frame_.mesh.assign(front, placed_);
  draw(frame_, front);
  before_mesh_.assign(before, placed_);
  redraw_to_far_plane(before_items_, before_mesh_.objects(), *view_);

  HlodDistance result;
  result.to_full = distance(*view_, frame_.items, frame_.image, full_.items, full_.image);
  result.to_unculled = distance(*view_, frame_.items, frame_.image, plain_.items, plain_.image);
  result.wrongly_hidden_px = count_lost_pixels(*view_, full_.items.depth, frame_.items.depth, options_.tolerance_px);
  result.crack_px = count_crack_pixels(*view_, full_.items.depth, frame_.items.depth, 4.0 * options_.tolerance_px);
  result.popping =
      measure_popping(*view_, where_shown(before_items_.depth, frame_.items.depth, shown_before_), frame_.items.depth);
  result.depth_complexity = depth_complexity_;
  return result;
}

}  // namespace occlod::tool
