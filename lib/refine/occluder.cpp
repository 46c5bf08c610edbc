#include "refine/occluder.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numeric>
#include <tuple>

#include "base/threads.h"
#include "splits/star.h"

namespace occlod {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Faces that may be off by more pixels hide too little for what they cost.
constexpr double largest_radius_px = 48.0;
// What rasterisers and single precision may change: pixels, and shares of depths.
constexpr double slack_px = 0.02;
constexpr double slack_depth = 2e-5;

double cross2(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

// Returns a / b, or infinity when that is not finite.
double safe_ratio(double a, double b) {
  const double ratio = a / b;
  return std::isfinite(ratio) ? ratio : infinity;
}

}  // namespace

void TileOccluder::begin(const View& view) {
  glm::dmat4 from_eye(1.0);
  from_eye[3] = glm::dvec4(view.camera().eye, 1.0);
  eye_to_clip_ = view.world_to_clip() * from_eye;
  clip_to_eye_ = glm::inverse(eye_to_clip_);
  direction_ = view.direction();
  near_ = view.camera().near;
  focal_length_px_ = view.focal_length_px();
  stretch_ = view.is_orthographic() ? 1.0 : 1.0 / view.cos_corner_angle();
  is_orthographic_ = view.is_orthographic();
  width_ = view.width();
  height_ = view.height();
  columns_ = (width_ + tile_size - 1) / tile_size;
  rows_ = (height_ + tile_size - 1) / tile_size;
  tiles_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), {infinity, 0});
}

void TileOccluder::add(std::uint32_t object, std::span<const MovedFace> faces, std::span<const glm::vec3> positions,
                       const ObjectView& view, bool two_sided) {
  faces_.clear();
  Face made;
  for (const MovedFace& face : faces)
    if (make_face(face, positions, view, two_sided, made)) faces_.push_back(made);
  join_faces();
  unsorted_intervals_.clear();
  unsorted_borders_.clear();
  for (std::uint32_t f = 0; f < faces_.size(); ++f) {
    add_intervals(f);
    add_borders(f);
  }
  sort_by_tile();
  find_depths(object);
}

// Returns false for useless faces: back faces, edge-on ones, those that reach the near plane, and those that may be far
// from where they are.
bool TileOccluder::make_face(const MovedFace& face, std::span<const glm::vec3> positions, const ObjectView& view,
                             bool two_sided, Face& result) const {
  for (int k = 0; k < 3; ++k) {
    result.vertices[static_cast<std::size_t>(k)] = face.corners[k];
    result.corners[static_cast<std::size_t>(k)] = project(positions[face.corners[k]], view);
  }
  result.marked = face.marked;
  result.moved = static_cast<double>(face.moved) * view.largest_stretch();
  const auto& c = result.corners;
  const double min_depth = std::min({c[0].depth, c[1].depth, c[2].depth});
  if (!(min_depth - result.moved > near_)) return false;
  result.radius = radius_of(result.moved, min_depth);
  result.reach = result.radius;
  if (!(result.radius <= largest_radius_px)) return false;
  // Pixel rows run downwards, so counter-clockwise faces have a negative area.
  const double area = cross2(c[1].pixel - c[0].pixel, c[2].pixel - c[0].pixel);
  const bool is_front = view.mirrored() ? area > 0.0 : area < 0.0;
  if (!std::isfinite(area) || area == 0.0 || !(is_front || two_sided)) return false;
  if (area < 0.0) return true;
  std::swap(result.corners[1], result.corners[2]);
  std::swap(result.vertices[1], result.vertices[2]);
  result.marked =
      static_cast<std::uint8_t>((face.marked & 1U) | ((face.marked & 2U) << 1U) | ((face.marked & 4U) >> 1U));
  return true;
}

TileOccluder::Corner TileOccluder::project(const glm::vec3& position, const ObjectView& view) const {
  const glm::dvec3 from_eye = view.object_to_eye() * glm::dvec4(position, 1.0);
  const glm::dvec4 clip = eye_to_clip_ * glm::dvec4(from_eye, 1.0);
  const double depth = glm::dot(from_eye, direction_);
  return {{(0.5 + 0.5 * clip.x / clip.w) * width_, (0.5 - 0.5 * clip.y / clip.w) * height_},
          is_orthographic_ ? -depth : 1.0 / depth,
          depth};
}

// Returns how many pixels a point moves at most when it moves by `moved` and is then in the image.
double TileOccluder::radius_of(double moved, double min_depth) const {
  return slack_px + focal_length_px_ * moved * stretch_ / (is_orthographic_ ? 1.0 : min_depth);
}

// Joins faces over edges that are no border: those with one face on either side, as seen from the eye, whose ends are
// not both marks.
void TileOccluder::join_faces() {
  edges_.clear();
  for (std::uint32_t f = 0; f < faces_.size(); ++f)
    for (std::uint8_t k = 0; k < 3; ++k) {
      const std::uint64_t a = faces_[f].vertices[k], b = faces_[f].vertices[(k + 1U) % 3U];
      edges_.push_back({std::min(a, b) << 32U | std::max(a, b), f, k, a < b});
      faces_[f].beyond[k] = no_face;
    }
  std::sort(edges_.begin(), edges_.end(),
            [](const Edge& x, const Edge& y) { return std::tie(x.ends, x.face) < std::tie(y.ends, y.face); });
  for (std::size_t i = 0; i < edges_.size();) {
    std::size_t end = i + 1;
    while (end < edges_.size() && edges_[end].ends == edges_[i].ends) ++end;
    if (end == i + 2 && edges_[i].is_forward != edges_[i + 1].is_forward) {
      const Edge &a = edges_[i], &b = edges_[i + 1];
      const unsigned both = (1U << a.corner) | (1U << ((a.corner + 1U) % 3U));
      if ((faces_[a.face].marked & both) != both) {
        faces_[a.face].beyond[a.corner] = b.face;
        faces_[b.face].beyond[b.corner] = a.face;
        // What is near the edge is then near both its faces.
        const double reach = std::max(faces_[a.face].radius, faces_[b.face].radius);
        for (const std::uint32_t f : {a.face, b.face}) faces_[f].reach = std::max(faces_[f].reach, reach);
      }
    }
    i = end;
  }
}

TileOccluder::Rect TileOccluder::tiles_near(const glm::dvec2& low, const glm::dvec2& high, double radius) const {
  const auto tile = [](double pixel, int count) {
    return static_cast<int>(std::clamp(std::floor(pixel / tile_size), -1.0, static_cast<double>(count)));
  };
  return {std::max(0, tile(low.x - radius, columns_)), std::max(0, tile(low.y - radius, rows_)),
          std::min(columns_, tile(high.x + radius, columns_) + 1), std::min(rows_, tile(high.y + radius, rows_) + 1)};
}

void TileOccluder::add_intervals(std::uint32_t f) {
  const Face& face = faces_[f];
  const auto& [a, b, c] = face.corners;
  const Rect rect = tiles_near(glm::min(glm::min(a.pixel, b.pixel), c.pixel),
                               glm::max(glm::max(a.pixel, b.pixel), c.pixel), face.reach);
  // Finds outward unit normals, and the nearness as a function of the pixel.
  std::array<glm::dvec2, 3> normals;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec2 edge = face.corners[(k + 1) % 3].pixel - face.corners[k].pixel;
    const double length = glm::length(edge);
    normals[k] = length > 0.0 ? glm::dvec2(-edge.y, edge.x) / length : glm::dvec2(0.0);
  }
  const glm::dvec2 ab = b.pixel - a.pixel, ac = c.pixel - a.pixel;
  const double area = cross2(ab, ac), to_b = b.nearness - a.nearness, to_c = c.nearness - a.nearness;
  const glm::dvec2 slope((to_b * ac.y - to_c * ab.y) / area, (to_c * ab.x - to_b * ac.x) / area);
  const double nearest = std::max({a.nearness, b.nearness, c.nearness});
  const double farthest = std::min({a.nearness, b.nearness, c.nearness});
  constexpr double half = 0.5 * tile_size;
  const double change = (std::abs(slope.x) + std::abs(slope.y)) * (half + face.radius);
  for (int y = rect.top; y < rect.bottom; ++y)
    for (int x = rect.left; x < rect.right; ++x) {
      const glm::dvec2 middle((x + 0.5) * tile_size, (y + 0.5) * tile_size);
      bool touches = true, holds_middle = true;
      for (std::size_t k = 0; touches && k < 3; ++k) {
        const double outside = glm::dot(normals[k], middle - face.corners[k].pixel);
        touches = outside - half * (std::abs(normals[k].x) + std::abs(normals[k].y)) <= face.reach;
        holds_middle = holds_middle && outside <= 0.0;
      }
      if (!touches) continue;
      const double at = a.nearness + glm::dot(slope, middle - a.pixel);
      double high = at + change, low = at - change;
      high = high < nearest ? std::max(high, farthest) : nearest;
      low = low > farthest ? std::min(low, nearest) : farthest;
      unsorted_intervals_.push_back({static_cast<std::uint32_t>(y * columns_ + x), f,
                                     static_cast<float>((depth_at(high) - face.moved) * (1.0 - slack_depth)),
                                     static_cast<float>((depth_at(low) + face.moved) * (1.0 + slack_depth)),
                                     holds_middle});
    }
}

void TileOccluder::add_borders(std::uint32_t f) {
  const Face& face = faces_[f];
  unsigned ends = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (face.beyond[k] != no_face) continue;
    add_border(f, face.corners[k], face.corners[(k + 1) % 3]);
    ends |= (1U << k) | (1U << ((k + 1U) % 3U));
  }
  for (std::size_t k = 0; k < 3; ++k)
    if (((face.marked & ~ends) >> k & 1U) != 0) add_border(f, face.corners[k], face.corners[k]);
}

void TileOccluder::add_border(std::uint32_t f, const Corner& a, const Corner& b) {
  const Face& face = faces_[f];
  constexpr double half_diagonal = 0.7072 * tile_size;
  const Rect rect = tiles_near(glm::min(a.pixel, b.pixel), glm::max(a.pixel, b.pixel), face.radius);
  const glm::dvec2 along = b.pixel - a.pixel;
  const double length2 = glm::dot(along, along);
  const double reach = half_diagonal + face.radius;
  const double change = length2 > 0.0 ? reach / std::sqrt(length2) : 1.0;  // change of the place on the edge
  for (int y = rect.top; y < rect.bottom; ++y)
    for (int x = rect.left; x < rect.right; ++x) {
      const glm::dvec2 middle((x + 0.5) * tile_size, (y + 0.5) * tile_size);
      const double place = length2 > 0.0 ? glm::dot(middle - a.pixel, along) / length2 : 0.0;
      const glm::dvec2 nearest = a.pixel + std::clamp(place, 0.0, 1.0) * along;
      if (!(glm::distance(nearest, middle) <= reach)) continue;
      const double first = std::clamp(place - change, 0.0, 1.0), last = std::clamp(place + change, 0.0, 1.0);
      const double rise = b.nearness - a.nearness;
      const double nearness = std::max(a.nearness + first * rise, a.nearness + last * rise);
      unsorted_borders_.push_back({static_cast<std::uint32_t>(y * columns_ + x), f,
                                   static_cast<float>((depth_at(nearness) - face.moved) * (1.0 - slack_depth))});
    }
}

void TileOccluder::sort_by_tile() {
  const auto sort = [&](const auto& unsorted, auto& sorted, std::vector<std::uint32_t>& first) {
    first.assign(tiles_.size() + 2, 0);
    for (const auto& item : unsorted) ++first[item.tile + 2];
    std::partial_sum(first.begin(), first.end(), first.begin());
    sorted.resize(unsorted.size());
    for (const auto& item : unsorted) sorted[first[item.tile + 1]++] = item;
    first.pop_back();
  };
  sort(unsorted_intervals_, intervals_, first_interval_);
  sort(unsorted_borders_, borders_, first_border_);
}

void TileOccluder::find_depths(std::uint32_t object) {
  place_.assign(faces_.size(), no_face);
  for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile) {
    const auto part = [&](const auto& all, const std::vector<std::uint32_t>& first) {
      return std::span(all).subspan(first[tile], first[tile + 1] - first[tile]);
    };
    const auto near = part(intervals_, first_interval_);
    if (std::none_of(near.begin(), near.end(), [](const Interval& i) { return i.holds_middle; })) continue;
    find_depth(tile, object, near, part(borders_, first_border_));
    for (const Interval& i : near) place_[i.face] = no_face;
  }
}

std::uint32_t TileOccluder::root(std::uint32_t i) {
  while (roots_[i] != i) i = roots_[i] = roots_[roots_[i]];
  return i;
}

void TileOccluder::find_depth(std::uint32_t tile, std::uint32_t object, std::span<const Interval> near,
                              std::span<const Border> borders) {
  const auto count = static_cast<std::uint32_t>(near.size());
  roots_.resize(count);
  order_.resize(count);
  std::iota(roots_.begin(), roots_.end(), 0U);
  std::iota(order_.begin(), order_.end(), 0U);
  for (std::uint32_t i = 0; i < count; ++i) place_[near[i].face] = i;
  for (std::uint32_t i = 0; i < count; ++i)
    for (const std::uint32_t other : faces_[near[i].face].beyond)
      if (other != no_face && place_[other] != no_face) roots_[root(i)] = root(place_[other]);
  min_border_.assign(count, infinity);
  for (const Border& border : borders) {
    if (place_[border.face] == no_face) continue;
    double& least = min_border_[root(place_[border.face])];
    least = std::min(least, static_cast<double>(border.first));
  }
  for (std::uint32_t i = 0; i < count; ++i) roots_[i] = root(i);
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t i, std::uint32_t j) {
    return std::tie(roots_[i], near[i].first, i) < std::tie(roots_[j], near[j].first, j);
  });
  for (std::uint32_t k = 0; k < count;) {
    const std::uint32_t set = roots_[order_[k]];
    // Visits groups of intervals that overlap, from near to far, until one hides.
    bool hides = false;
    while (!hides && k < count && roots_[order_[k]] == set) {
      double last = 0.0;
      for (bool is_first = true; k < count && roots_[order_[k]] == set; ++k, is_first = false) {
        const Interval& i = near[order_[k]];
        if (!is_first && static_cast<double>(i.first) > last) break;
        last = is_first ? static_cast<double>(i.last) : std::max(last, static_cast<double>(i.last));
        hides = hides || i.holds_middle;
      }
      if (hides && last < min_border_[set] && last < tiles_[tile].depth) tiles_[tile] = {last, object};
    }
    while (k < count && roots_[order_[k]] == set) ++k;
  }
}

void TileOccluder::write(std::uint32_t object, const ObjectView& view, std::vector<glm::vec3>& positions,
                         std::vector<Triangle>& triangles) const {
  const glm::dmat3 to_eye(view.object_to_eye());
  const glm::dmat3 to_object = glm::inverse(to_eye);
  const glm::dvec3 origin = view.object_to_eye()[3];
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    const Tile& tile = tiles_[t];
    if (!(tile.depth < infinity) || tile.object != object) continue;
    const int x = static_cast<int>(t) % columns_ * tile_size, y = static_cast<int>(t) / columns_ * tile_size;
    const auto place = [&](int column, int row, double depth) {
      const glm::dvec2 clip(2.0 * column / width_ - 1.0, 1.0 - 2.0 * row / height_);
      const glm::dvec4 a = clip_to_eye_ * glm::dvec4(clip, -1.0, 1.0), b = clip_to_eye_ * glm::dvec4(clip, 1.0, 1.0);
      const glm::dvec3 from = glm::dvec3(a) / a.w, to = glm::dvec3(b) / b.w;
      const double share = safe_ratio(depth - glm::dot(from, direction_), glm::dot(to - from, direction_));
      return to_object * (from + share * (to - from) - origin);
    };
    // Single precision may change the depth by this much. Objects far from their origin have no room for tiles.
    const glm::dvec3 there = place(x + tile_size / 2, y + tile_size / 2, tile.depth);
    const double largest = std::max({std::abs(there.x), std::abs(there.y), std::abs(there.z)});
    const double rounding = 1e-6 * (largest * view.largest_stretch() + tile.depth);
    if (!(focal_length_px_ * stretch_ * rounding <= 0.25 * (is_orthographic_ ? 1.0 : tile.depth))) continue;
    const double depth = tile.depth + rounding;
    const auto first = static_cast<VertexId>(positions.size());
    for (const auto& [column, row] :
         {std::pair(x, y), {x, y + tile_size}, {x + tile_size, y + tile_size}, {x + tile_size, y}})
      positions.emplace_back(place(column, row, depth));
    triangles.emplace_back(first, first + 1, first + 2);
    triangles.emplace_back(first, first + 2, first + 3);
  }
}

namespace {

// Splits whose faces are one part: enough for a thread to be worth while.
constexpr std::size_t splits_in_a_part = 1024;

bool shows_back(const Triangle& t, std::span<const glm::vec3> positions, const glm::vec3& eye) {
  const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
  return glm::dot(glm::cross(b - a, c - a), eye - a) < 0.0F;
}

// Writes the faces of some applied splits. Unless both sides are seen, faces that show their backs are left out: they
// are not drawn and so hide nothing, and on a closed surface they lie behind its front faces. Faces that are not finite
// or too small to tell stay.
void write_faces(const Cut& cut, std::size_t first_split, const glm::vec3& eye, bool two_sided,
                 std::vector<Triangle>& out) {
  const std::span<const glm::vec3> positions = cut.hierarchy().positions();
  const std::size_t end = std::min(first_split + splits_in_a_part, cut.applied_splits().size());
  out.clear();
  out.reserve(3 * splits_in_a_part);  // about two a split: no frame of a known path shall allocate
  cut.for_each_active(first_split, end, [&](const FaceRef&, const Triangle& t) {
    if (two_sided || !shows_back(t, positions, eye)) out.push_back(t);
  });
}

}  // namespace

std::span<const OccluderPart> Occluder::build(std::span<const RefineObject> objects, CutSet& cuts, const View& view,
                                              std::span<const ObjectView> views, OccluderMode mode, unsigned threads) {
  result_.clear();
  if (mode == OccluderMode::paper)
    build_of_cuts(objects, cuts, views, threads);
  else
    build_conservative(objects, cuts, view, views);
  return result_;
}

void Occluder::begin_part(std::size_t i, std::uint32_t object, std::size_t first_split) {
  if (parts_.size() == i) parts_.emplace_back();
  parts_[i].object = object;
  parts_[i].first_split = first_split;
}

void Occluder::build_of_cuts(std::span<const RefineObject> objects, CutSet& cuts, std::span<const ObjectView> views,
                             unsigned threads) {
  std::size_t parts = 0;
  for (std::uint32_t i = 0; i < cuts.size(); ++i) {
    cuts.drop_taken_back(i);
    std::size_t first = 0;
    do {
      begin_part(parts++, i, first);
      first += splits_in_a_part;
    } while (first < cuts[i].applied_splits().size());
  }
  for_each_block(parts, 1, threads, [&](std::size_t at, std::size_t, unsigned) {
    Part& part = parts_[at];
    write_faces(cuts[part.object], part.first_split, views[part.object].eye(), objects[part.object].two_sided,
                part.triangles);
  });
  for (const Part& part : std::span(parts_).first(parts))
    result_.push_back({part.object, cuts.hierarchy(part.object).positions(), part.triangles});
}

void Occluder::build_conservative(std::span<const RefineObject> objects, CutSet& cuts, const View& view,
                                  std::span<const ObjectView> views) {
  hold_motions(cuts);
  tiles_.begin(view);
  for (std::uint32_t i = 0; i < cuts.size(); ++i) {
    begin_part(i, i, 0);
    cuts.active_triangles(i, parts_[i].triangles, true);  // also sorts the applied splits
    find_vertices(cuts[i], *motions_[i]);
    find_faces(cuts[i], *motions_[i]);
    tiles_.add(i, faces_, cuts[i].hierarchy().positions(), views[i], objects[i].two_sided);
  }
  for (std::uint32_t i = 0; i < cuts.size(); ++i) {
    parts_[i].positions.clear();
    parts_[i].triangles.clear();
    tiles_.write(i, views[i], parts_[i].positions, parts_[i].triangles);
    result_.push_back({i, parts_[i].positions, parts_[i].triangles});
  }
}

// Finds the motions of hierarchies that are not held yet; those of a Refiner stay the same.
void Occluder::hold_motions(const CutSet& cuts) {
  motions_.resize(cuts.size());
  held_.resize(cuts.size(), nullptr);
  for (std::uint32_t i = 0; i < cuts.size(); ++i) {
    const Hierarchy& hierarchy = cuts.hierarchy(i);
    if (held_[i] == hierarchy.positions().data()) continue;
    motions_[i] = motion_of(hierarchy);
    held_[i] = hierarchy.positions().data();
  }
}

void Occluder::find_vertices(const Cut& cut, const SurfaceMotion& motion) {
  const Hierarchy& hierarchy = cut.hierarchy();
  base_roots_.assign(hierarchy.base_vertex_count(), no_id);
  for (const SplitId root : hierarchy.data().roots) {
    const VertexId u = star_of(hierarchy, root).parent_vertex();
    if (u < base_roots_.size()) base_roots_[u] = root;
  }
  vertices_.clear();
  for (VertexId v = 0; v < base_roots_.size(); ++v) add_vertex(cut, motion, v, base_roots_[v]);
  for (const SplitId s : cut.applied_splits())
    add_vertex(cut, motion, hierarchy.vertex_of(s), hierarchy.node(s).child_v);
}

void Occluder::add_vertex(const Cut& cut, const SurfaceMotion& motion, VertexId v, SplitId first) {
  while (first != no_id && cut.applied(first)) first = cut.hierarchy().node(first).child_u;
  vertices_.push_back({first, motion.is_marked(v, first)});
}

const Occluder::CutVertex& Occluder::vertex(const Cut& cut, VertexId v) const {
  const std::size_t base = cut.hierarchy().base_vertex_count();
  if (v < base) return vertices_[v];
  const std::span<const SplitId> applied = cut.applied_splits();
  const auto place = std::lower_bound(applied.begin(), applied.end(), static_cast<SplitId>(v - base));
  return vertices_[base + static_cast<std::size_t>(place - applied.begin())];
}

void Occluder::find_faces(const Cut& cut, const SurfaceMotion& motion) {
  faces_.clear();
  cut.for_each_active([&](const FaceRef& ref, const Triangle& t) {
    MovedFace face{t, motion.moved(ref)};
    for (int k = 0; k < 3; ++k) {
      const CutVertex& corner = vertex(cut, t[k]);
      face.marked = static_cast<std::uint8_t>(face.marked | (corner.is_marked ? 1U << static_cast<unsigned>(k) : 0U));
    }
    faces_.push_back(face);
  });
}

}  // namespace occlod
