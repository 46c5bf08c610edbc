#include "accuracy.h"

#include "drawing.h"
#include "occlod/hierarchy/cut_mesh.h"

namespace occlod::tool {

PictureDistance distance_to_full_mesh(const std::vector<LoadedObject>& objects, const View& view,
                                      const ItemBuffer& items, std::span<const DrawObject> refined) {
  std::vector<std::vector<Triangle>> triangles;
  triangles.reserve(objects.size());
  std::vector<DrawObject> full;
  for (const LoadedObject& object : objects) {
    triangles.push_back(triangles_of(*object.hierarchy, full_cut(*object.hierarchy)));
    full.push_back(draw_object(object, triangles.back()));
  }
  ItemBuffer full_items;
  redraw(full_items, full, view);
  ShadeOptions shading;
  shading.wire = false;
  return compare_pictures(view, items.depth, shade(items, refined, view, shading), full_items.depth,
                          shade(full_items, full, view, shading));
}

std::size_t count_wrongly_hidden(const std::vector<LoadedObject>& objects, const View& view,
                                 const RefineOptions& options, Visibility& visibility) {
  if (!visibility.can_hide()) return 0;
  Refiner refiner(refine_objects(objects));
  RefineOptions to_one_pixel = options;
  to_one_pixel.budget = refiner.full_triangles();
  to_one_pixel.tolerance_px = 1.0;
  ItemBuffer with, without;
  NoOcclusion none;
  double allowed_px = 0.0;
  for (const auto& [backend, items] : {std::pair<Visibility*, ItemBuffer*>(&visibility, &with), {&none, &without}}) {
    const Refinement& refinement = refiner.refine(view, to_one_pixel, *backend);
    redraw(*items, draw_objects(objects, refinement), view);
    allowed_px += refinement.stats.max_error_px;
  }
  return count_unexplained_pixels(view, without.depth, with.depth, allowed_px);
}

}  // namespace occlod::tool
