// Builds occluders from cuts, either from their triangles or conservatively, and decides when they are drawn.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "occlod/mesh.h"
#include "occlod/refiner.h"
#include "occlod/view.h"
#include "occlod/visibility.h"
#include "refine/cut.h"
#include "refine/tuning.h"
#include "splits/surface_motion.h"

namespace occlod {

// A face of a cut, and how far what it stands for may be from it.
struct MovedFace {
  Triangle corners;
  float moved = 0.0F;       // object units; see SurfaceMotion
  std::uint8_t marked = 0;  // bit k: corner k is a mark
};

// Finds, for each tile of the image, a depth behind which nothing can be seen, although the mesh is not exactly where
// the input is. Orient the faces that are drawn towards the eye, and let S be a set of them. Where as many faces of S
// lie on the left of an edge as on its right, seen from the eye, the edge is no part of the border of S. Bounded
// motions carry what S stands for in the input to S, and its border to the border of S and to marks. So take a ray from
// the near plane to a point x, where x is farther from each face of S than what the face stands for has moved, and all
// of the ray is likewise farther from the border of S and from marks. The ray meets the input as often as S, counted
// with sign; that is how often it meets S at all, since all of S faces the eye. **If it meets S at all, the input hides
// x.**
//
// The test is made for all rays of a tile at once. Everything is grown by how far it may have moved, on the screen by
// the pixels that this covers at most. Of the grown faces that touch the tile, those that are joined over edges that
// are no border are one S. A face is near the rays between two depths. The point x must lie in none of these intervals,
// behind the first group of them in which a face holds the middle of the tile, and before the nearest border. Nothing
// depends on where pixels have their centres.
//
// Reuses its memory.
class TileOccluder {
 public:
  static constexpr int tile_size = 8;  // pixels

  // Starts a view and forgets what was added.
  void begin(const View& view);
  // Adds faces of an object. `faces` index `positions` (object space). O(n log n + tiles touched).
  void add(std::uint32_t object, std::span<const MovedFace> faces, std::span<const glm::vec3> positions,
           const ObjectView& view, bool two_sided);
  // Appends a square (object space) for each tile where this object hides most.
  void write(std::uint32_t object, const ObjectView& view, std::vector<glm::vec3>& positions,
             std::vector<Triangle>& triangles) const;

 private:
  struct Corner {
    glm::dvec2 pixel;
    double nearness;  // linear over the image of a plane: 1 / depth, or -depth in orthographic views
    double depth;     // from the eye plane, world units
  };
  // A face of a set S, with its corners counter-clockwise as seen.
  struct Face {
    std::array<Corner, 3> corners;
    std::array<VertexId, 3> vertices;
    std::array<std::uint32_t, 3> beyond;  // the face over the edge that begins at corner k; no_face: a border
    double moved;                         // bound on its motion, world units
    double radius;                        // pixels that this motion covers at most
    double reach;                         // largest radius of the face and of those beyond its edges
    std::uint8_t marked;
  };
  struct Interval {
    std::uint32_t tile, face;
    float first, last;  // depths, world units
    bool holds_middle;
  };
  struct Border {
    std::uint32_t tile, face;
    float first;
  };
  struct Tile {
    double depth;  // nothing behind this depth can be seen
    std::uint32_t object;
  };
  struct Rect {
    int left, top, right, bottom;  // in tiles; right and bottom are exclusive
  };
  static constexpr std::uint32_t no_face = ~std::uint32_t{0};

  [[nodiscard]] bool make_face(const MovedFace& face, std::span<const glm::vec3> positions, const ObjectView& view,
                               bool two_sided, Face& result) const;
  [[nodiscard]] Corner project(const glm::vec3& position, const ObjectView& view) const;
  [[nodiscard]] double depth_at(double nearness) const { return is_orthographic_ ? -nearness : 1.0 / nearness; }
  [[nodiscard]] double radius_of(double moved, double min_depth) const;
  void join_faces();
  void add_intervals(std::uint32_t f);
  void add_borders(std::uint32_t f);
  void add_border(std::uint32_t f, const Corner& a, const Corner& b);
  [[nodiscard]] Rect tiles_near(const glm::dvec2& low, const glm::dvec2& high, double radius) const;
  void sort_by_tile();
  void find_depths(std::uint32_t object);
  void find_depth(std::uint32_t tile, std::uint32_t object, std::span<const Interval> near,
                  std::span<const Border> borders);
  [[nodiscard]] std::uint32_t root(std::uint32_t i);

  glm::dmat4 eye_to_clip_{1.0}, clip_to_eye_{1.0};  // between clip space and world space relative to the eye
  glm::dvec3 direction_{0.0};
  double near_ = 0.0, focal_length_px_ = 0.0, stretch_ = 1.0;
  bool is_orthographic_ = false;
  int width_ = 0, height_ = 0, columns_ = 0, rows_ = 0;  // in pixels; in tiles
  std::vector<Tile> tiles_;

  std::vector<Face> faces_;
  struct Edge {
    std::uint64_t ends;
    std::uint32_t face;
    std::uint8_t corner;
    bool is_forward;
  };
  std::vector<Edge> edges_;
  std::vector<Interval> intervals_, unsorted_intervals_;
  std::vector<Border> borders_, unsorted_borders_;
  std::vector<std::uint32_t> first_interval_, first_border_;  // per tile
  std::vector<std::uint32_t> place_;                          // per face, its index in the current tile
  std::vector<std::uint32_t> roots_, order_;
  std::vector<double> min_border_;
};

// Builds the mesh that hides from the current cuts of all objects. Reuses its memory. In mode paper, the parts, several
// for a large object, are triangles of the hierarchy's own vertices, in no order, without back faces except for
// two-sided objects. In mode
// conservative, they are squares on tiles of the image.
class Occluder {
 public:
  // Builds the occluder. `cuts` and `views`, of `view`, are per object. The result is valid until the next call. O(n)
  // for n triangles, on `threads` threads; in mode conservative O(n log n + tiles touched), on one, and once for each
  // hierarchy the time of motion_of().
  std::span<const OccluderPart> build(std::span<const RefineObject> objects, CutSet& cuts, const View& view,
                                      std::span<const ObjectView> views, OccluderMode mode, unsigned threads = 1);

 private:
  struct Part {
    std::uint32_t object = 0;
    std::size_t first_split = 0;       // in the order of the cut; not conservative
    std::vector<glm::vec3> positions;  // corners of squares; conservative only
    std::vector<Triangle> triangles;
  };
  // A vertex of a cut, with the first split of its chain that is not applied.
  struct CutVertex {
    SplitId first_left = no_id;
    bool is_marked = false;
  };

  void build_of_cuts(std::span<const RefineObject> objects, CutSet& cuts, std::span<const ObjectView> views,
                     unsigned threads);
  void build_conservative(std::span<const RefineObject> objects, CutSet& cuts, const View& view,
                          std::span<const ObjectView> views);
  void begin_part(std::size_t i, std::uint32_t object, std::size_t first_split);
  void hold_motions(const CutSet& cuts);
  void find_vertices(const Cut& cut, const SurfaceMotion& motion);
  void add_vertex(const Cut& cut, const SurfaceMotion& motion, VertexId v, SplitId first);
  void find_faces(const Cut& cut, const SurfaceMotion& motion);
  [[nodiscard]] const CutVertex& vertex(const Cut& cut, VertexId v) const;

  std::vector<Part> parts_;
  std::vector<OccluderPart> result_;
  std::vector<std::shared_ptr<const SurfaceMotion>> motions_;  // by object
  std::vector<const glm::vec3*> held_;                         // positions of the hierarchy of each motion
  std::vector<CutVertex> vertices_;  // of one cut: base vertices, then those of applied splits in their order
  std::vector<SplitId> base_roots_;
  std::vector<MovedFace> faces_;  // faces of one cut
  TileOccluder tiles_;
};

// Measures how far refinement has come.
struct Growth {
  std::size_t splits = 0;     // applied splits
  std::size_t triangles = 0;  // triangles beyond those of the base meshes
};

// Decides when the occluder is drawn anew: either at given numbers of applied splits or, where none are given, when the
// mesh has grown to a third of the budget, or to that divided by powers of `factor`, and some split has moved its
// surface far enough to be worth it. So the work of drawing is a geometric series, and the last occluder before the
// final check still decides about most of the budget.
class OccluderSteps {
 public:
  // Where no numbers are given, the first occluder has first() triangles and each later one `factor` times as many.
  static constexpr double factor = 6.0;
  [[nodiscard]] static double first(double budget) {
    const double last = budget / last_part;
    const double least = std::clamp(last / factor, min_triangles, enough_triangles);
    double triangles = std::max(last, least);
    while (triangles >= factor * least) triangles /= factor;
    return triangles;
  }

  void begin(const RefineOptions& options) {
    options_ = &options;
    next_ = 0;
    next_triangles_ = first(static_cast<double>(options.budget));
    last_ = {};
    moved_px_ = 0.0F;
  }

  void split_applied(float quadric_error_px) { moved_px_ = std::max(moved_px_, quadric_error_px); }

  [[nodiscard]] bool due(const Growth& now) const {
    const std::vector<std::uint32_t>& given = tuning_of(*options_).occluder_splits;
    if (!given.empty()) return next_ < given.size() && now.splits >= given[next_];
    return static_cast<double>(now.triangles) >= next_triangles_ && moved_px_ >= min_move_px;
  }

  void drawn(const Growth& now) {
    if (!tuning_of(*options_).occluder_splits.empty())
      while (due(now)) ++next_;
    while (next_triangles_ <= static_cast<double>(now.triangles)) next_triangles_ *= factor;
    last_ = now;
    moved_px_ = 0.0F;
  }
  // Returns the growth at the last occluder.
  [[nodiscard]] const Growth& last() const noexcept { return last_; }

 private:
  // The first occluder has at least min_triangles, or enough_triangles where two are drawn anyway.
  static constexpr double min_triangles = 32.0, enough_triangles = 128.0;
  static constexpr double last_part = 3.0;  // budget divided by the triangles of the last occluder
  static constexpr float min_move_px = 1.0F;

  const RefineOptions* options_ = nullptr;
  std::size_t next_ = 0;         // index of the next given number
  double next_triangles_ = 0.0;  // next number where none are given
  Growth last_;
  float moved_px_ = 0.0F;  // largest motion by a split since the last occluder
};

}  // namespace occlod
