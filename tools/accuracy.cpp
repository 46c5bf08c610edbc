#include "accuracy.h"

#include "drawing.h"
#include "occlod/build_hierarchy.h"

namespace occlod::tool {
namespace {

RefineOptions to_one_pixel(RefineOptions options, const Refiner& refiner) {
  options.budget = refiner.full_triangles();
  options.tolerance_px = 1.0;
  return options;
}

}  // namespace

Image shade_without_wire(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view,
                         std::span<const ObjectTexture> textures) {
  ShadeOptions shading;
  shading.wire = false;
  shading.textures = textures;
  return shade(items, objects, view, shading);
}

FullMeshPicture::FullMeshPicture(const std::vector<LoadedObject>& objects, const View& view,
                                 std::span<const ObjectTexture> textures)
    : view_(view), textures_(textures), coordinates_(texture_coordinates(objects)) {
  std::vector<std::vector<Triangle>> triangles;
  triangles.reserve(objects.size());
  std::vector<DrawObject> full;
  for (const LoadedObject& object : objects) {
    triangles.push_back(wedge_triangles_of(*object.hierarchy, full_cut(*object.hierarchy)));
    full.push_back(draw_object(object, triangles.back()));
  }
  draw_items(items_, full, view);
  image_ = shade_without_wire(items_, full, view, textures_);
  if (!coordinates_.empty()) texels_ = find_texels(items_, full, view, coordinates_);
}

PictureDistance FullMeshPicture::distance_to(const ItemBuffer& items, std::span<const DrawObject> refined) const {
  return compare_pictures(view_, items.depth, shade_without_wire(items, refined, view_, textures_), items_.depth,
                          image_);
}

std::optional<double> FullMeshPicture::texture_slip_px(const ItemBuffer& items,
                                                       std::span<const DrawObject> refined) const {
  if (coordinates_.empty()) return std::nullopt;
  return occlod::texture_slip_px(find_texels(items, refined, view_, coordinates_), texels_);
}

WronglyHidden::WronglyHidden(const std::vector<LoadedObject>& objects)
    : objects_(objects), reference_refiner_(refine_objects(objects)), refiner_(refine_objects(objects)) {}

void WronglyHidden::set_view(const View& view, const RefineOptions& options) {
  view_ = &view;
  NoOcclusion none;
  const Refinement& refinement = reference_refiner_.refine(view, to_one_pixel(options, refiner_), none);
  drawn_ = draw_objects(objects_, refinement);
  draw_items(without_, drawn_, view);
  reference_error_px_ = refinement.stats.max_error_px;
}

std::size_t WronglyHidden::count(const RefineOptions& options, Visibility& visibility) {
  if (!visibility.can_hide()) return 0;
  const Refinement& refinement = refiner_.refine(*view_, to_one_pixel(options, refiner_), visibility);
  draw_items(with_, draw_objects(objects_, refinement), *view_);
  allowed_px_ = reference_error_px_ + refinement.stats.max_error_px;
  return count_unexplained_pixels(*view_, without_.depth, with_.depth, allowed_px_);
}

}  // namespace occlod::tool
