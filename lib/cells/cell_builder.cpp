#include "occlod/cell_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <optional>
#include <span>
#include <vector>

#include "base/placement.h"
#include "cells/cell_geometry.h"
#include "cells/cell_refinement.h"
#include "cells/hull_test.h"
#include "cells/inner_boxes.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/item_buffer.h"
#include "refine/cut.h"
#include "refine/screen_error.h"
#include "splits/star.h"

namespace occlod {
namespace {

// Computes the cuts of all objects for one cell by sampling what some of its eye points see.

// Draws the cuts from a grid of eye points in all six directions, at the resolution of the eye model. A face that owns
// a pixel is split while the split changes it by more than the tolerance, until every eye point sees only faces that
// may stay. Those faces are drawn, plus all faces that share a vertex with them and may show their front. (After
// Nirenstein and Blake 2004, who decide about triangles from images.) What is visible only between eye points or pixels
// is missing. The result does not depend on the number of threads.
class CellSampling {
 public:
  CellSampling(std::span<const RefineObject> objects, const CellOptions& options);

  const CellCut& build(const CellBox& cell);

 private:
  struct Object {
    Object(const RefineObject& object, const Hierarchy& hierarchy);

    [[nodiscard]] std::size_t place_of(const FaceRef& face) const {
      return face.slot + (face.split == no_id ? std::size_t{0} : first_face[face.split]);
    }

    RefineObject placed;
    Cut cut;
    std::vector<std::uint32_t> first_face;  // per split, among all faces that ever exist; base faces come first
    std::vector<SplitId> remover;           // per face: the split that removes it, or none
    std::vector<FaceRef> faces;             // active
    std::vector<Triangle> triangles;        // of these faces
    std::vector<bool> seen;                 // per face that ever exists
  };

  void begin(const CellBox& cell);
  void gather(Object& object);
  // Refines until everything that this view sees may stay. Returns false when that was already so.
  bool refine(const View& view);
  void draw(const View& view);
  bool split_seen();
  // Returns whether the split changes its faces by more than the tolerance.
  [[nodiscard]] bool must_split(std::size_t place, SplitId s);
  void find_drawn(std::size_t place);

  CellOptions options_;
  std::vector<Object> objects_;
  std::vector<CellView> views_;
  ItemBuffer image_;
  CellCut result_;
};

constexpr int max_pixels = 4096;  // along each side of an image

// Returns a view through one side of a cube around the eye.
View view_to(const glm::dvec3& eye, int side, const EyeModel& eyes) {
  glm::dvec3 direction(0.0), up(0.0);
  direction[side / 2] = side % 2 == 0 ? 1.0 : -1.0;
  up[(side / 2 + 1) % 3] = 1.0;
  Camera camera{.eye = eye, .target = eye + direction, .up = up, .fov_y_deg = 90.0};
  camera.width = camera.height =
      static_cast<int>(std::clamp(std::ceil(2.0 * eyes.focal_length_px), 1.0, 1.0 * max_pixels));
  camera.near = eyes.near;
  camera.far = 1e9 * eyes.near;
  return View(camera);
}

// Returns eye points from the least corner of the cell to its largest; if there is only one, the centre.
std::vector<glm::dvec3> eyes_of(const CellBox& cell, int along) {
  const auto share = [&](int i) { return along == 1 ? 0.5 : static_cast<double>(i) / (along - 1); };
  std::vector<glm::dvec3> eyes;
  for (int z = 0; z < along; ++z)
    for (int y = 0; y < along; ++y)
      for (int x = 0; x < along; ++x)
        eyes.push_back(glm::mix(cell.min, cell.max, glm::dvec3(share(x), share(y), share(z))));
  return eyes;
}

CellSampling::Object::Object(const RefineObject& object, const Hierarchy& hierarchy) : placed(object), cut(hierarchy) {
  auto next = static_cast<std::uint32_t>(hierarchy.base_triangle_count());
  first_face.reserve(hierarchy.split_count());
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    first_face.push_back(next);
    next += star_of(hierarchy, s).inserted_count();
  }
  remover.assign(next, no_id);
  for (SplitId s = 0; s < hierarchy.split_count(); ++s)
    star_of(hierarchy, s).for_each_removed_ref([&](const FaceRef& face) { remover[place_of(face)] = s; });
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

// A split that removes no face is applied at once, because no face would show that its geometry is missing.
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
      if (star_of(hierarchy, s).removed_count() == 0 && !object.cut.applied(s) && must_split(i, s)) {
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
      static_cast<double>(views_[place].largest_scale_px(box_of(star_of(hierarchy, s), hierarchy.positions())));
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

// Relative rounding error of sums and products of a few terms in double precision, as a share of the largest term.
constexpr double rounding = 1e-14;

bool finite(const glm::dvec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

void require_cell(const CellBox& cell) {
  if (!finite(cell.min) || !finite(cell.max))
    throw Error({"cell", "", "a corner is not a finite number", "give a box of finite numbers"});
  if (glm::any(glm::greaterThan(cell.min, cell.max)))
    throw Error({"cell", "", "its least corner lies beyond its largest", "give min <= max in every axis"});
}

void require_eyes(const EyeModel& eyes) {
  const auto refuse = [](const char* field, const char* range) {
    throw Error({"eye model", field, "is out of its range", range});
  };
  if (!(eyes.focal_length_px > 0.0) || !std::isfinite(eyes.focal_length_px))
    refuse("focal_length_px", "give a number > 0");
  if (!(eyes.cos_corner_angle > 0.0 && eyes.cos_corner_angle <= 1.0)) refuse("cos_corner_angle", "give one in (0, 1]");
  if (!(eyes.near > 0.0) || !std::isfinite(eyes.near)) refuse("near", "give a distance > 0");
  if (!(eyes.clearance >= 0.0) || !std::isfinite(eyes.clearance)) refuse("clearance", "give a distance >= 0");
}

}  // namespace

EyeModel eye_model(const View& view) {
  if (view.is_orthographic())
    throw Error({"camera", "orthographic_height", "an orthographic view has no eye that could be in a cell",
                 "give a camera in perspective"});
  return {view.focal_length_px(), view.cos_corner_angle(), view.camera().near, 0.0};
}

CellView::CellView(const CellBox& cell, const EyeModel& eyes, const glm::dmat4& object_to_world)
    : cell_(cell), eyes_(eyes), object_to_world_(object_to_world) {
  require_cell(cell);
  require_eyes(eyes);
  require_placement(object_to_world);
  const glm::dmat3 linear(object_to_world);
  largest_stretch_ = stretch_of(linear);
  scale_at_near_px_ = eyes.focal_length_px * largest_stretch_ / (eyes.near * eyes.cos_corner_angle);
  const double reach =
      occlod::largest_coordinate(cell) + occlod::largest_coordinate(CellBox{object_to_world_[3], object_to_world_[3]});
  double steps = 0.0;  // upper bound, object units per world unit
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 step(0.0);
    step[axis] = 1.0;
    steps += glm::length(solve(linear, step));
  }
  corner_slack_ = rounding * steps * reach;
  for (std::size_t i = 0; i < 8; ++i) {
    const glm::dvec3 corner((i & 1U) != 0 ? cell.max.x : cell.min.x, (i & 2U) != 0 ? cell.max.y : cell.min.y,
                            (i & 4U) != 0 ? cell.max.z : cell.min.z);
    corners_[i] = solve(linear, corner - object_to_world_[3]);
    rounded_corners_[i] = glm::vec3(corners_[i]);
  }
}

// A displacement at distance d and angle a from the axis covers at most f / (d cos^2 a) pixels per unit; and, as the
// depth z = d cos a is no less than that of the near plane, at most f / (z cos a) with z = near. The largest angle is
// that of the corners of the image.
double CellView::scale_px_at(double distance) const noexcept {
  const double cos_angle = eyes_.cos_corner_angle, nearest = std::max(distance, eyes_.clearance);
  if (!(nearest > 0.0)) return scale_at_near_px_;
  return std::min(scale_at_near_px_, eyes_.focal_length_px * largest_stretch_ / (nearest * cos_angle * cos_angle));
}

float CellView::largest_scale_px(const Sphere& sphere) const noexcept {
  const glm::dvec3 center = object_to_world_ * glm::dvec4(sphere.center, 1.0);
  return rounded_up(
      scale_px_at(smallest_distance(cell_, {center, center}) - static_cast<double>(sphere.radius) * largest_stretch_));
}

float CellView::largest_scale_px(const Box& box) const noexcept {
  return rounded_up(scale_px_at(smallest_distance(cell_, world_box(box, 0.0))));
}

double CellView::smallest_scale_px(const Box& box) const noexcept {
  return scale_px_at(largest_distance(cell_, world_box(box, 0.0)));
}

bool CellView::faces_away(const NormalCone& cone, const Sphere& sphere) const noexcept {
  if (!cone.culls()) return false;
  return std::all_of(rounded_corners_.begin(), rounded_corners_.end(),
                     [&](const glm::vec3& eye) { return occlod::faces_away(cone, sphere, eye); });
}

bool CellView::faces_away(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) const noexcept {
  const glm::dvec3 from(a), u = glm::dvec3(b) - from, v = glm::dvec3(c) - from, normal = glm::cross(u, v);
  // Most faces are seen from the front by the first corner already, which takes no roots to find out.
  if (glm::dot(normal, corners_[0] - from) >= 0.0) return false;
  const double size = glm::length(u) * glm::length(v), length = glm::length(normal);
  return std::all_of(corners_.begin(), corners_.end(), [&](const glm::dvec3& eye) {
    const glm::dvec3 to_eye = eye - from;
    const double slack = rounding * size * glm::length(to_eye) + length * corner_slack_;
    return glm::dot(normal, to_eye) < -slack;
  });
}

CellBox CellView::world_box(const Box& box, double margin) const noexcept {
  const glm::dvec3 middle = 0.5 * (glm::dvec3(box.min) + glm::dvec3(box.max));
  const glm::dvec3 half = 0.5 * (glm::dvec3(box.max) - glm::dvec3(box.min)) + margin;
  const glm::dvec3 center = object_to_world_ * glm::dvec4(middle, 1.0);
  glm::dvec3 reach(0.0), size = glm::abs(object_to_world_[3]);
  for (int axis = 0; axis < 3; ++axis) {
    reach += glm::abs(object_to_world_[axis]) * half[axis];
    size += glm::abs(object_to_world_[axis] * middle[axis]);
  }
  const glm::dvec3 outwards = reach * (1.0 + rounding) + rounding * size;
  return {center - outwards, center + outwards};
}

namespace {

std::shared_ptr<const CellSurface> surface_of(std::span<const RefineObject> objects, double max_motion) {
  if (!(max_motion >= 0.0) || !std::isfinite(max_motion))
    throw Error({"cell occluders", "max_motion", "is out of its range", "give a length >= 0, in world units"});
  for (const RefineObject& object : objects) {
    if (object.hierarchy == nullptr)
      throw Error({"cell occluders", "", "an object has no hierarchy", "build one with build_hierarchy()"});
    require_placement(object.object_to_world);
  }
  return std::make_shared<const CellSurface>(objects, max_motion);
}

}  // namespace

CellOccluders::CellOccluders(std::span<const RefineObject> objects, double max_motion)
    : surface_(surface_of(objects, max_motion)), boxes_(std::make_shared<const InnerBoxes>(*surface_)) {}

bool CellOccluders::hides(const CellBox& eyes, const CellBox& what, double near_reach) const {
  HullTest test(*surface_, boxes_.get());
  test.set_cell(eyes, near_reach);
  return test.hides(what);
}

std::size_t CellOccluders::triangle_count() const noexcept { return surface_->triangle_count(); }

namespace {

constexpr int max_sampled_eyes = 64;

std::span<const RefineObject> checked(std::span<const RefineObject> objects, const CellOptions& options) {
  if (!(options.tolerance_px > 0.0) || !std::isfinite(options.tolerance_px))
    throw Error({"cell options", "tolerance_px", "is out of its range", "give a number of pixels > 0"});
  if (options.sampled_eyes < 1 || options.sampled_eyes > max_sampled_eyes)
    throw Error({"cell options", "sampled_eyes", "is out of its range", "give 1 to 64 eyes along each axis"});
  if (options.budget > 0 && options.occlusion == CellOcclusion::sampled)
    throw Error({"cell options", "budget", "does not go with sampled occlusion", "give a tolerance only"});
  std::size_t base_triangles = 0;
  for (const RefineObject& object : objects) {
    if (object.hierarchy == nullptr)
      throw Error({"cell builder", "", "an object has no hierarchy", "build one with build_hierarchy()"});
    // Throws for a placement or an eye model that is out of its range, before any cell is built.
    static_cast<void>(CellView({}, options.eyes, object.object_to_world));
    base_triangles += object.hierarchy->base_triangle_count();
  }
  if (options.budget > 0 && options.budget < base_triangles)
    throw Error({"cell options", "budget", "is less than the triangles of the base meshes",
                 fmt::format("give {} or more", base_triangles)});
  return objects;
}

}  // namespace

class CellBuilder::Work {
 public:
  Work(std::span<const RefineObject> objects, const CellOccluders* occluders, const CellOptions& options) {
    if (options.occlusion == CellOcclusion::sampled)
      sampling_.emplace(checked(objects, options), options);
    else
      refinement_.emplace(checked(objects, options), occluders == nullptr ? nullptr : &occluders->surface(),
                          occluders == nullptr ? nullptr : &occluders->boxes(), options);
  }
  const CellCut& build(const CellBox& cell) { return sampling_ ? sampling_->build(cell) : refinement_->build(cell); }

 private:
  // Exactly one of these is used.
  std::optional<CellRefinement> refinement_;
  std::optional<CellSampling> sampling_;
};

CellBuilder::CellBuilder(std::span<const RefineObject> objects, const CellOccluders* occluders,
                         const CellOptions& options)
    : work_(std::make_unique<Work>(objects, occluders, options)) {}
CellBuilder::~CellBuilder() = default;
CellBuilder::CellBuilder(CellBuilder&&) noexcept = default;
CellBuilder& CellBuilder::operator=(CellBuilder&&) noexcept = default;

const CellCut& CellBuilder::build(const CellBox& cell) { return work_->build(cell); }

}  // namespace occlod
