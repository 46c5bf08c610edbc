#include "cells/cell_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/mat4x4.hpp>
#include <limits>
#include <utility>

#include "base/arithmetic.h"
#include "cells/cell_geometry.h"
#include "cells/hull.h"
#include "refine/screen_error.h"
#include "splits/star.h"

namespace occlod {
namespace {

constexpr std::uint32_t group_size = 128;  // triangles that are drawn together

// Returns the first pixel whose centre is not before `share` of the half image, in [-1, 1].
int first_pixel(double share, int size) {
  return static_cast<int>(std::clamp(std::ceil(0.5 * size * (share + 1.0) - 0.5), 0.0, static_cast<double>(size)));
}

}  // namespace

CellImages::CellImages(const CellSurface& surface) : surface_(surface) {
  for (int i = 0; i < size; ++i) {
    const double step = (2.0 * i + 1.0) / size - 1.0;
    steps_[static_cast<std::size_t>(i)] = step;
    inverse_steps_[static_cast<std::size_t>(i)] = 1.0 / step;
  }
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    sides_[i].axis = static_cast<int>(i / 2);
    sides_[i].sign = i % 2 == 0 ? 1.0 : -1.0;
  }
}

void CellImages::draw(const CellBox& cell, double near_reach) {
  cell_ = cell;
  eye_ = 0.5 * (cell.min + cell.max);
  near_reach_ = near_reach;
  near_ = std::max({near_reach, 1e-9 * surface_.largest_coordinate(), std::numeric_limits<double>::min()});
  for (Side& side : sides_) draw(side);
}

void CellImages::draw(Side& side) {
  side.nearness.assign(static_cast<std::size_t>(size) * stride, 0.0F);
  side.farthest.assign(static_cast<std::size_t>(tiles) * tiles, 0.0F);
  side.farthest_known.assign(static_cast<std::size_t>(tiles) * tiles, true);
  surface_.bvh().for_each_group(
      eye_, group_size, [&](const TriangleBvh::Group& group) { return show(side, group.box); },
      [&](const TriangleBvh::Group& group) { draw_group(side, group); });
}

void CellImages::draw_group(Side& side, const TriangleBvh::Group& group) {
  positions_.clear();
  triangles_.clear();
  for (std::uint32_t t = group.first; t < group.first + group.count; ++t) {
    const glm::dvec3 &a = surface_.corner(t, 0), &b = surface_.corner(t, 1), &c = surface_.corner(t, 2);
    if (triangle_meets(a, b, c, grown(cell_, surface_.moved(t) + near_reach_))) continue;
    const auto first = static_cast<VertexId>(positions_.size());
    for (const glm::dvec3& p : {a, b, c}) positions_.emplace_back(p - eye_);
    triangles_.emplace_back(first, first + 1, first + 2);
  }
  // The depth is w; two axes of the world are those of the image.
  glm::mat4 to_clip(0.0F);
  const auto sign = static_cast<float>(side.sign);
  to_clip[(side.axis + 1) % 3].x = 1.0F;
  to_clip[(side.axis + 2) % 3].y = -1.0F;  // rows start at the top
  to_clip[side.axis].z = to_clip[side.axis].w = sign;
  to_clip[3].z = static_cast<float>(-2.0 * near_);
  const PixelRect drawn = draw_depth({side.nearness.data(), size, size, stride}, positions_, triangles_, to_clip);
  if (drawn.empty()) return;
  for (int y = drawn.y0 / tile_size; y * tile_size < drawn.y1; ++y)
    for (int x = drawn.x0 / tile_size; x * tile_size < drawn.x1; ++x)
      side.farthest_known[static_cast<std::size_t>(y * tiles + x)] = false;
}

CellImages::Image CellImages::image_of(const Side& side, const CellBox& what) const {
  Image image;
  for (int k = 0; k < 3; ++k) {
    const int axis = (side.axis + 1 + k) % 3;
    image.min[k] = what.min[axis] - eye_[axis];
    image.max[k] = what.max[axis] - eye_[axis];
  }
  if (side.sign < 0.0) {
    std::swap(image.min.z, image.max.z);
    image.min.z = -image.min.z;
    image.max.z = -image.max.z;
  }
  image.min.z = std::max(image.min.z, near_);
  if (image.max.z < image.min.z) return image;
  const glm::dvec3 &low = image.min, &high = image.max;
  image.rect = {first_pixel(std::min(low.x / low.z, low.x / high.z), size),
                first_pixel(std::min(low.y / low.z, low.y / high.z), size),
                first_pixel(std::max(high.x / low.z, high.x / high.z), size),
                first_pixel(std::max(high.y / low.z, high.y / high.z), size)};
  return image;
}

bool CellImages::show(const CellBox& what) {
  return std::any_of(sides_.begin(), sides_.end(), [&](Side& side) { return show(side, what); });
}

bool CellImages::show(Side& side, const CellBox& what) {
  const Image image = image_of(side, what);
  if (image.rect.empty()) return false;
  for (int y = image.rect.y0; y < image.rect.y1;) {
    const int end_y = std::min((y / tile_size + 1) * tile_size, image.rect.y1);
    for (int x = image.rect.x0; x < image.rect.x1;) {
      const int end_x = std::min((x / tile_size + 1) * tile_size, image.rect.x1);
      if (static_cast<double>(farthest(side, x / tile_size, y / tile_size)) * image.min.z <= 1.0 &&
          shows_in_tile(side, image, {x, y, end_x, end_y}))
        return true;
      x = end_x;
    }
    y = end_y;
  }
  return false;
}

// A ray is inside the box from where it has passed the last of three planes to where it passes the first of the other
// three.
bool CellImages::shows_in_tile(const Side& side, const Image& image, const PixelRect& rect) const {
  for (int y = rect.y0; y < rect.y1; ++y) {
    const double by_row = inverse_steps_[static_cast<std::size_t>(y)];
    const bool down = by_row > 0.0;
    const double enter_row = std::max(image.min.z, (down ? image.min.y : image.max.y) * by_row);
    const double leave_row = std::min(image.max.z, (down ? image.max.y : image.min.y) * by_row);
    const float* const nearness = side.nearness.data() + static_cast<std::ptrdiff_t>(y) * stride;
    for (int x = rect.x0; x < rect.x1; ++x) {
      const double by_column = inverse_steps_[static_cast<std::size_t>(x)];
      const bool right = by_column > 0.0;
      const double enter = std::max(enter_row, (right ? image.min.x : image.max.x) * by_column);
      const double leave = std::min(leave_row, (right ? image.max.x : image.min.x) * by_column);
      if (enter <= leave && static_cast<double>(nearness[x]) * enter <= 1.0) return true;
    }
  }
  return false;
}

float CellImages::farthest(Side& side, int x, int y) {
  const auto tile = static_cast<std::size_t>(y * tiles + x);
  if (side.farthest_known[tile]) return side.farthest[tile];
  const float* const first = side.nearness.data() + (static_cast<std::ptrdiff_t>(y) * stride + x) * tile_size;
  float least = *first;
  for (int row = 0; row < tile_size; ++row)
    for (int column = 0; column < tile_size; ++column)
      least = std::min(least, first[static_cast<std::ptrdiff_t>(row) * stride + column]);
  side.farthest[tile] = least;
  side.farthest_known[tile] = true;
  return least;
}

namespace {

// Number of faces that are tested together before each is tested alone: larger groups are seldom hidden.
constexpr std::size_t max_faces_at_once = 8;

Box common(const Box& a, const Box& b) { return {glm::max(a.min, b.min), glm::min(a.max, b.max)}; }

double pixels(float error, float scale_px) { return static_cast<double>(error) * static_cast<double>(scale_px); }

}  // namespace

CellRefinement::CellRefinement(std::span<const RefineObject> objects, const CellSurface* surface,
                               const InnerBoxes* boxes, const CellOptions& options)
    : objects_(objects.begin(), objects.end()), options_(options) {
  result_.objects.resize(objects.size());
  for (const RefineObject& object : objects) {
    object.hierarchy->require_all();
    cuts_.emplace_back(*object.hierarchy);
  }
  if (surface == nullptr || options.occlusion == CellOcclusion::none) return;
  hull_test_.emplace(*surface, boxes);
  images_.emplace(*surface);
}

const CellCut& CellRefinement::build(const CellBox& cell) {
  result_.stats = {};
  result_.triangles = result_.drawn_triangles = 0;
  result_.error_px = 0.0;
  if (hull_test_) {
    const double near_reach = options_.eyes.near / options_.eyes.cos_corner_angle;
    hull_test_->set_cell(cell, near_reach);
    images_->draw(cell, near_reach);
  }
  const HullTest::Counts before = hull_test_ ? hull_test_->counts() : HullTest::Counts{};
  views_.clear();
  triangles_ = 0;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    views_.emplace_back(cell, options_.eyes, objects_[i].object_to_world);
    cuts_[i].clear();
    triangles_ += cuts_[i].triangle_count();
  }
  if (options_.budget > 0) refine_to_budget();
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    if (options_.budget == 0) refine(i, views_[i]);
    find_drawn(i, views_[i]);
    result_.triangles += cuts_[i].triangle_count();
    result_.drawn_triangles += result_.objects[i].triangles.size();
  }
  if (hull_test_) {
    result_.stats.queries_boxed = hull_test_->counts().boxed - before.boxed;
    result_.stats.floods = hull_test_->counts().floods - before.floods;
    result_.stats.flood_triangles = hull_test_->counts().triangles - before.triangles;
  }
  return result_;
}

void CellRefinement::refine(std::uint32_t object, const CellView& view) {
  const Hierarchy& hierarchy = cuts_[object].hierarchy();
  const std::span<const SplitId> roots = hierarchy.data().roots;
  visits_.clear();
  for (const SplitId root : roots) visits_.push_back({.split = root, .box = hierarchy.node(root).box()});
  std::reverse(visits_.begin(), visits_.end());  // the last is visited first
  while (!visits_.empty()) {
    const Visit next = visits_.back();
    visits_.pop_back();
    if (!next.is_last)
      visit(object, view, next);
    else if (!cuts_[object].applied(next.split))
      try_split(object, view, next.split, next.sight == Sight::unknown);
  }
}

void CellRefinement::visit(std::uint32_t object, const CellView& view, const Visit& entry) {
  const SplitId s = entry.split;
  const Hierarchy& hierarchy = cuts_[object].hierarchy();
  const SplitNode& node = hierarchy.node(s);
  ++result_.stats.nodes;
  if (is_fine(error_of(object, s), view.largest_scale_px(node.sphere))) {
    ++result_.stats.fine_nodes;
    return;
  }
  const SplitId next = next_below(object, view, s);
  const Sight sight = hull_test_ ? sight_of(object, view, entry, next) : Sight::unknown;
  if (sight == Sight::hidden) {
    ++result_.stats.hidden_nodes;
    return;
  }
  visits_.push_back({s, sight, true, entry.box});
  for (const SplitId child : {node.child_v, node.child_u})
    if (child != no_id)
      visits_.push_back({child, sight == Sight::unknown || child == next ? sight : Sight::unseen, false,
                         common(entry.box, hierarchy.node(child).box())});
}

// Asks about a node far below first: where that is not hidden, nothing above it is. Its box is clipped by those
// between, because packed boxes may stick out of those above them.
CellRefinement::Sight CellRefinement::sight_of(std::uint32_t object, const CellView& view, const Visit& entry,
                                               SplitId next) {
  const Hierarchy& hierarchy = cuts_[object].hierarchy();
  const CellBox box = grown_box(view, entry.box, hierarchy.node(entry.split).guaranteed_error);
  Sight sight = entry.sight;
  if (sight == Sight::unknown) {
    if (is_seen(box)) return Sight::unknown;
    sight = Sight::unseen;
  }
  if (sight == Sight::unseen) {
    Visit last = entry;
    for (SplitId s = next; s != no_id; s = next_below(object, view, s))
      last = {.split = s, .box = common(last.box, hierarchy.node(s).box())};
    if (!is_blocked(grown_box(view, last.box, hierarchy.node(last.split).guaranteed_error))) return Sight::shown;
    sight = Sight::doubtful;
  }
  if (sight == Sight::doubtful && (next == no_id || is_blocked(box))) return Sight::hidden;
  return sight;
}

SplitId CellRefinement::next_below(std::uint32_t object, const CellView& view, SplitId s) const {
  const Hierarchy& hierarchy = cuts_[object].hierarchy();
  const SplitNode& node = hierarchy.node(s);
  for (const SplitId child : {node.child_u, node.child_v})
    if (child != no_id &&
        pixels(error_of(object, child), view.largest_scale_px(hierarchy.node(child).sphere)) > options_.tolerance_px)
      return child;
  return no_id;
}

void CellRefinement::refine_to_budget() {
  heap_.clear();
  is_full_ = false;
  const auto push = [&](std::uint32_t object, SplitId s) {
    const Sphere& sphere = cuts_[object].hierarchy().node(s).sphere;
    heap_.push_back({error_of(object, s) * views_[object].largest_scale_px(sphere), object, s});
    std::push_heap(heap_.begin(), heap_.end());
  };
  for (std::uint32_t i = 0; i < objects_.size(); ++i)
    for (const SplitId root : cuts_[i].hierarchy().data().roots) push(i, root);
  while (!heap_.empty() && !is_full_) {
    std::pop_heap(heap_.begin(), heap_.end());
    const Candidate next = heap_.back();
    heap_.pop_back();
    stack_.clear();
    visit_by_error(next.object, views_[next.object], next.split);
    for (const SplitId child : stack_) push(next.object, child);
    if (!is_full_) continue;
    const float left = heap_.empty() ? next.px : std::max(next.px, heap_.front().px);
    result_.error_px = std::max(result_.error_px, static_cast<double>(left));
  }
}

void CellRefinement::visit_by_error(std::uint32_t object, const CellView& view, SplitId s) {
  const SplitNode& node = cuts_[object].hierarchy().node(s);
  ++result_.stats.nodes;
  if (is_fine(error_of(object, s), view.largest_scale_px(node.sphere))) {
    ++result_.stats.fine_nodes;
    return;
  }
  if (hull_test_ && is_hidden(grown_box(view, node.box(), node.guaranteed_error))) {
    ++result_.stats.hidden_nodes;
    return;
  }
  for (const SplitId child : {node.child_u, node.child_v})
    if (child != no_id) stack_.push_back(child);
  if (!cuts_[object].applied(s)) try_split(object, view, s, true);
}

void CellRefinement::try_split(std::uint32_t object, const CellView& view, SplitId s, bool may_be_seen) {
  Cut& cut = cuts_[object];
  const Hierarchy& hierarchy = cut.hierarchy();
  const Box box = box_of(star_of(hierarchy, s), hierarchy.positions());
  if (is_fine(error_of(object, s), view.largest_scale_px(box))) {
    ++result_.stats.fine_splits;
  } else if (is_hidden(view, box, hierarchy.node(s).guaranteed_error, may_be_seen)) {
    ++result_.stats.hidden_splits;
  } else {
    const Cut::Closure closure = cut.closure(s);
    is_full_ = options_.budget > 0 && triangles_ + closure.triangles > options_.budget;
    if (is_full_) return;
    triangles_ += closure.triangles;
    result_.stats.forced_splits += closure.splits.size() - 1;
    cut.apply_closure();
  }
}

float CellRefinement::error_of(std::uint32_t object, SplitId s) const {
  return errors_of(cuts_[object].hierarchy(), s, objects_[object].attributes).guaranteed;
}

bool CellRefinement::is_fine(float error, float scale_px) {
  const double px = pixels(error, scale_px);
  if (!(px <= options_.tolerance_px)) return false;
  result_.error_px = std::max(result_.error_px, px);
  return true;
}

CellBox CellRefinement::grown_box(const CellView& view, const Box& box, float error) const {
  double growth = static_cast<double>(error);
  if (options_.budget == 0) growth = std::min(growth, options_.tolerance_px / view.smallest_scale_px(box));
  return view.world_box(box, growth);
}

bool CellRefinement::is_hidden(const CellView& view, const Box& box, float error, bool may_be_seen) {
  if (!hull_test_) return false;
  const CellBox what = grown_box(view, box, error);
  return may_be_seen ? is_hidden(what) : is_blocked(what);
}

bool CellRefinement::is_seen(const CellBox& what) {
  const bool seen = images_->show(what);
  result_.stats.seen_boxes += seen ? 1 : 0;
  return seen;
}

bool CellRefinement::is_hidden(const CellBox& what) { return !is_seen(what) && is_blocked(what); }

bool CellRefinement::is_blocked(const CellBox& what) {
  ++result_.stats.queries;
  const bool hidden = hull_test_->hides(what);
  result_.stats.queries_hidden += hidden ? 1 : 0;
  return hidden;
}

void CellRefinement::find_drawn(std::uint32_t object, const CellView& view) {
  Cut& cut = cuts_[object];
  CellObjectCut& result = result_.objects[object];
  cut.active_wedge_triangles(active_, true);  // sorts its splits
  result.applied.assign(cut.applied_splits().begin(), cut.applied_splits().end());
  drawn_.assign(active_.size(), false);
  faces_.clear();
  std::uint32_t place = 0;
  cut.for_each_active([&](const FaceRef& ref, const Triangle& t) { add_face(object, view, ref, t, place++); });
  sort_by_place(faces_);
  if (!faces_.empty()) drop_hidden(faces_, is_blocked(faces_[0].box));
  result.triangles.clear();
  for (std::size_t i = 0; i < active_.size(); ++i)
    if (drawn_[i]) result.triangles.push_back(active_[i]);
}

void CellRefinement::add_face(std::uint32_t object, const CellView& view, const FaceRef& ref, const Triangle& t,
                              std::uint32_t place) {
  const Hierarchy& hierarchy = cuts_[object].hierarchy();
  const std::span<const glm::vec3> positions = hierarchy.positions();
  const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
  if (!objects_[object].two_sided && view.faces_away(a, b, c)) return;
  drawn_[place] = true;
  if (!hull_test_) return;
  const float error = ref.split == no_id ? hierarchy.error_bound() : hierarchy.node(ref.split).guaranteed_error;
  const CellBox box = grown_box(view, bounding_box(std::array{a, b, c}), error);
  if (!is_seen(box)) faces_.push_back({box, place});
}

// Halves the faces by their place in space, like TriangleBvh.
void CellRefinement::sort_by_place(std::span<Face> faces) {
  if (faces.size() < 2) return;
  const int axis = longest_axis(box_around(faces));
  const auto key = [&](const Face& face) { return std::pair(face.box.min[axis] + face.box.max[axis], face.place); };
  const std::size_t half = faces.size() / 2;
  std::nth_element(faces.begin(), faces.begin() + static_cast<std::ptrdiff_t>(half), faces.end(),
                   [&](const Face& x, const Face& y) { return key(x) < key(y); });
  sort_by_place(faces.first(half));
  sort_by_place(faces.subspan(half));
}

// Asks about several faces together only where the first of them is hidden.
void CellRefinement::drop_hidden(std::span<const Face> faces, bool is_first_hidden) {
  if (is_first_hidden && faces.size() <= max_faces_at_once && (faces.size() == 1 || is_hidden(box_around(faces)))) {
    for (const Face& face : faces) drawn_[face.place] = false;
    return;
  }
  if (faces.size() == 1) return;
  const std::size_t half = faces.size() / 2;
  drop_hidden(faces.first(half), is_first_hidden);
  drop_hidden(faces.subspan(half), is_blocked(faces[half].box));
}

CellBox CellRefinement::box_around(std::span<const Face> faces) {
  CellBox box = faces[0].box;
  for (const Face& face : faces) box = unite(box, face.box);
  return box;
}

}  // namespace occlod
