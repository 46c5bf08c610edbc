#include "cells/cell_sampling.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "occlod/hierarchy/cut_mesh.h"
#include "refine/screen_error.h"
#include "cells/star_box.h"

namespace occlod {
namespace {

constexpr int most_pixels = 4096;  // along each side of an image

// To one side of a cube around the eye.
View view_to(const glm::dvec3& eye, int side, const EyeModel& eyes) {
  glm::dvec3 direction(0.0), up(0.0);
  direction[side / 2] = side % 2 == 0 ? 1.0 : -1.0;
  up[(side / 2 + 1) % 3] = 1.0;
  Camera camera{.eye = eye, .target = eye + direction, .up = up, .fov_y_deg = 90.0};
  camera.width = camera.height =
      static_cast<int>(std::clamp(std::ceil(2.0 * eyes.focal_length_px), 1.0, 1.0 * most_pixels));
  camera.near = eyes.near;
  camera.far = 1e9 * eyes.near;
  return View(camera);
}

// From the least corner of the cell to its largest; of one eye, the middle.
std::vector<glm::dvec3> eyes_of(const CellBox& cell, int along) {
  const auto share = [&](int i) { return along == 1 ? 0.5 : static_cast<double>(i) / (along - 1); };
  std::vector<glm::dvec3> eyes;
  for (int z = 0; z < along; ++z)
    for (int y = 0; y < along; ++y)
      for (int x = 0; x < along; ++x)
        eyes.push_back(glm::mix(cell.min, cell.max, glm::dvec3(share(x), share(y), share(z))));
  return eyes;
}

}  // namespace

CellSampling::Object::Object(const RefineObject& object, const Hierarchy& hierarchy) : placed(object), cut(hierarchy) {
  auto next = static_cast<std::uint32_t>(hierarchy.base_triangle_count());
  first_face.reserve(hierarchy.split_count());
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    first_face.push_back(next);
    next += hierarchy.star(s).inserted_count();
  }
  remover.assign(next, no_id);
  for (SplitId s = 0; s < hierarchy.split_count(); ++s)
    hierarchy.star(s).for_each_removed_ref([&](const FaceRef& face) { remover[place_of(face)] = s; });
}

CellSampling::CellSampling(std::span<const RefineObject> objects, const CellOptions& options) : options_(options) {
  for (const RefineObject& object : objects) {
    object.hierarchy->require_all();
    objects_.emplace_back(object, *object.hierarchy);
  }
  result_.objects.resize(objects.size());
}

const CellCut& CellSampling::build(const CellBox& cell) {
  begin(cell);
  const std::vector<glm::dvec3> eyes = eyes_of(cell, options_.sampled_eyes);
  for (bool changed = true; changed;) {
    changed = false;
    for (Object& object : objects_) object.seen.assign(object.remover.size(), false);
    for (const glm::dvec3& eye : eyes)
      for (int side = 0; side < 6; ++side) changed = refine(view_to(eye, side, options_.eyes)) || changed;
  }
  for (std::size_t i = 0; i < objects_.size(); ++i) find_drawn(i);
  return result_;
}

// What no face stands for cannot be seen to be missing: splits that remove none are made at once.
void CellSampling::begin(const CellBox& cell) {
  result_.stats = {};
  result_.triangles = result_.drawn_triangles = 0;
  result_.error_px = 0.0;
  views_.clear();
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Object& object = objects_[i];
    views_.emplace_back(cell, options_.eyes, object.placed.object_to_world);
    object.cut.clear();
    const Hierarchy& hierarchy = object.cut.hierarchy();
    for (SplitId s = 0; s < hierarchy.split_count(); ++s)
      if (hierarchy.star(s).removed_count() == 0 && !object.cut.applied(s) && must_split(i, s)) {
        static_cast<void>(object.cut.closure(s));
        object.cut.apply_closure();
      }
    gather(object);
  }
}

void CellSampling::gather(Object& object) {
  object.faces.clear();
  object.triangles.clear();
  object.cut.for_each_active([&](const FaceRef& face, const Triangle& t) {
    object.faces.push_back(face);
    object.triangles.push_back(t);
  });
}

bool CellSampling::refine(const View& view) {
  bool changed = false;
  for (draw(view); split_seen(); draw(view)) changed = true;
  return changed;
}

void CellSampling::draw(const View& view) {
  image_.reset(view.width(), view.height());
  std::uint32_t first = 0;
  for (const Object& object : objects_) {
    const ObjectView placed(view, object.placed.object_to_world);
    draw_items(image_, object.cut.hierarchy().positions(), object.triangles, placed.object_to_clip(), first);
    first += static_cast<std::uint32_t>(object.triangles.size());
  }
}

bool CellSampling::split_seen() {
  std::size_t count = 0;
  for (const Object& object : objects_) count += object.triangles.size();
  const std::vector<bool> seen = visible_items(image_, count);
  bool changed = false;
  std::size_t item = 0;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Object& object = objects_[i];
    bool split = false;
    for (const FaceRef& face : object.faces) {
      if (!seen[item++]) continue;
      object.seen[object.place_of(face)] = true;
      const SplitId s = object.remover[object.place_of(face)];
      if (s == no_id || object.cut.applied(s) || !must_split(i, s)) continue;
      static_cast<void>(object.cut.closure(s));
      object.cut.apply_closure();
      split = true;
    }
    if (split) gather(object);
    changed = changed || split;
  }
  return changed;
}

bool CellSampling::must_split(std::size_t place, SplitId s) {
  const Hierarchy& hierarchy = objects_[place].cut.hierarchy();
  const double px =
      static_cast<double>(errors_of(hierarchy, s, objects_[place].placed.attributes).guaranteed) *
      static_cast<double>(views_[place].largest_scale_px(box_of(hierarchy.star(s), hierarchy.positions())));
  if (px > options_.tolerance_px) return true;
  result_.error_px = std::max(result_.error_px, px);
  return false;
}

void CellSampling::find_drawn(std::size_t place) {
  Object& object = objects_[place];
  CellObjectCut& result = result_.objects[place];
  const Hierarchy& hierarchy = object.cut.hierarchy();
  object.cut.active_triangles(object.triangles, true);  // sorts its splits
  result.applied.assign(object.cut.applied_splits().begin(), object.cut.applied_splits().end());
  gather(object);
  std::vector<bool> near_seen(hierarchy.vertex_count(), false);
  for (std::size_t f = 0; f < object.faces.size(); ++f)
    if (object.seen[object.place_of(object.faces[f])])
      for (int k = 0; k < 3; ++k) near_seen[object.triangles[f][k]] = true;
  result.triangles.clear();
  const std::span<const glm::vec3> p = hierarchy.positions();
  for (std::size_t f = 0; f < object.faces.size(); ++f) {
    const Triangle& t = object.triangles[f];
    if (!near_seen[t.x] && !near_seen[t.y] && !near_seen[t.z]) continue;
    if (object.placed.two_sided || !views_[place].faces_away(p[t.x], p[t.y], p[t.z]))
      result.triangles.push_back(wedges_of_face(hierarchy, object.faces[f], t));
  }
  result_.triangles += object.triangles.size();
  result_.drawn_triangles += result.triangles.size();
}

}  // namespace occlod
