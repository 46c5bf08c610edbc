#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <vector>

#include "occlod/build_hierarchy.h"
#include "splits/active_faces.h"
#include "splits/star.h"
#include "splits/star_mesh.h"
#include "splits/triangle_keys.h"

namespace occlod {
namespace {

template <typename Key>
bool are_same(std::vector<Key> a, std::vector<Key> b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  return a == b;
}

bool restores_positions(const Hierarchy& hierarchy, const TriangleMesh& mesh) {
  std::vector<TriangleKey> restored, input;
  restored.reserve(mesh.triangle_count());
  input.reserve(mesh.triangle_count());
  for (const Triangle& t : triangles_of(hierarchy, full_cut(hierarchy)))
    restored.push_back(key_of(t, hierarchy.positions()));
  for (const Triangle& t : mesh.triangles) input.push_back(key_of(t, mesh.positions));
  return are_same(std::move(restored), std::move(input));
}

// Compares only the attributes that the mesh has.
bool restores_corners(const Hierarchy& hierarchy, const TriangleMesh& mesh) {
  const HierarchyView& view = hierarchy.data();
  WedgeAttributes input{mesh.positions, mesh.normals, mesh.colors, mesh.texture_coordinates, mesh.texture_origin};
  WedgeAttributes restored{view.positions, view.normals, view.colors, view.texture_coordinates, view.texture_origin};
  if (!keep_those_of(input, restored)) return false;
  std::vector<CornerKey> of_mesh, of_hierarchy;
  of_mesh.reserve(mesh.triangle_count());
  of_hierarchy.reserve(mesh.triangle_count());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    of_mesh.push_back(corners_of(mesh.wedge_triangles()[t], input, mesh.material_of(t)));
  for (const Triangle& t : wedge_triangles_of(hierarchy, full_cut(hierarchy)))
    of_hierarchy.push_back(corners_of(t, restored, mesh.materials.empty() ? 0 : hierarchy.material_of(t.x)));
  return are_same(std::move(of_hierarchy), std::move(of_mesh));
}

}  // namespace

bool restores(const Hierarchy& hierarchy, const TriangleMesh& mesh) {
  if (mesh.origin != hierarchy.data().origin) {
    TriangleMesh moved = mesh;
    move_origin(moved, hierarchy.data().origin);
    return restores(hierarchy, moved);
  }
  if (hierarchy.input_triangle_count() != mesh.triangle_count() || !restores_positions(hierarchy, mesh)) return false;
  const bool has_attributes = !mesh.normals.empty() || !mesh.colors.empty() || !mesh.texture_coordinates.empty() ||
                              !mesh.triangle_materials.empty();
  return !has_attributes || restores_corners(hierarchy, mesh);
}

namespace {

constexpr std::size_t max_violations = 20;

class Validator {
 public:
  Validator(const Hierarchy& hierarchy, int random_cuts)
      : h_(hierarchy),
        d_(hierarchy.data()),
        random_cuts_(random_cuts),
        splits_(static_cast<SplitId>(hierarchy.split_count())) {}

  std::vector<std::string> run() {
    h_.require_all();
    if (const auto problem = check_structure(d_)) {
      report("{}", *problem);
      return violations_;
    }
    check_saturation();
    check_corners();
    check_bounds();
    replay();
    check_materials();
    check_random_cuts();
    return violations_;
  }

 private:
  template <typename... Args>
  void report(fmt::format_string<Args...> format, Args&&... args) {
    if (violations_.size() < max_violations) violations_.push_back(fmt::format(format, std::forward<Args>(args)...));
  }

  // Checks invariant 1.
  void check_saturation() {
    const auto check = [&](SplitId coarse, SplitId fine, const char* relation) {
      const SplitNode &a = d_.nodes[coarse], &b = d_.nodes[fine];
      if (!(a.error >= b.error && a.guaranteed_error >= b.guaranteed_error) ||
          h_.attribute_error(coarse) < h_.attribute_error(fine))
        report("split {} has a smaller error than split {}, which {}", coarse, fine, relation);
    };
    for (SplitId s = 0; s < splits_; ++s) {
      for (const SplitId t : star_of(h_, s).dependencies()) check(t, s, "depends on it");
      for (const SplitId child : {d_.nodes[s].child_u, d_.nodes[s].child_v})
        if (child != no_id) check(s, child, "is below it in the forest");
    }
  }

  // Checks part of invariant 4: every corner of a face that a split inserts exists when the split is applied, because
  // it is in the base mesh, is the split's own vertex, is a corner of a removed face or comes from a split on which
  // this one depends.
  void check_corners() {
    const std::size_t base_vertices = h_.base_vertex_count();
    std::vector<VertexId> corners;
    for (SplitId s = 0; s < splits_; ++s) {
      const SplitStar star = star_of(h_, s);
      corners.clear();
      star.for_each_removed([&](const FaceRef&, const Triangle& t) { corners.insert(corners.end(), {t.x, t.y, t.z}); });
      std::sort(corners.begin(), corners.end());
      const auto needed = star.dependencies();
      star.for_each_inserted([&](const Triangle& t) {
        for (int k = 0; k < 3; ++k)
          if (t[k] >= base_vertices && t[k] != h_.vertex_of(s) &&
              !std::binary_search(corners.begin(), corners.end(), t[k]) &&
              !std::binary_search(needed.begin(), needed.end(), t[k] - base_vertices))
            report("split {} inserts a face at vertex {}, which may be missing", s, t[k]);
      });
    }
  }

  // Checks invariants 2 and 3. Subtrees are runs of a depth-first order. Segment trees of boxes over that order, one of
  // points and one of normals, let a whole run be accepted by its box, since all bounds are convex; so even a forest
  // that is one long chain is checked in reasonable time.
  void check_bounds() {
    order_depth_first();
    make_segments();
    for (SplitId s = 0; s < splits_; ++s) {
      const Sphere& sphere = d_.nodes[s].sphere;
      const Box box = d_.nodes[s].box();
      const Cylinder cylinder = d_.nodes[s].cylinder();
      const NormalCone cone = d_.nodes[s].cone();
      if (!holds_points(s, [&](const glm::vec3& p) { return holds(sphere, p); }))
        report("the sphere of split {} is too small", s);
      if (!holds_points(s, [&](const glm::vec3& p) { return holds(box, p); }))
        report("the box of split {} is too small", s);
      if (!holds_points(s, [&](const glm::vec3& p) { return holds(cylinder, p); }))
        report("the cylinder of split {} is too small", s);
      if (cone.culls() && !holds_normals(s, [&](const glm::vec3& n) { return holds(cone, n); }))
        report("the normal cone of split {} is too narrow", s);
    }
  }

  static bool holds(const Sphere& sphere, const glm::vec3& p) {
    return glm::distance(glm::dvec3(sphere.center), glm::dvec3(p)) <= static_cast<double>(sphere.radius);
  }
  static bool holds(const Box& box, const glm::vec3& p) {
    return glm::all(glm::lessThanEqual(box.min, p)) && glm::all(glm::lessThanEqual(p, box.max));
  }
  static bool holds(const Cylinder& cylinder, const glm::vec3& p) {
    const glm::dvec3 axis = glm::normalize(glm::dvec3(cylinder.axis));
    const glm::dvec3 offset = glm::dvec3(p) - glm::dvec3(cylinder.center);
    const double along = glm::dot(offset, axis);
    return along >= static_cast<double>(cylinder.t_min) && along <= static_cast<double>(cylinder.t_max) &&
           glm::length(offset - along * axis) <= static_cast<double>(cylinder.radius);
  }

  static bool holds(const NormalCone& cone, const glm::vec3& normal) {
    return glm::dot(glm::dvec3(normal), glm::dvec3(cone.axis)) >= static_cast<double>(cone.cos_angle);
  }

  void order_depth_first() {
    place_.resize(splits_);
    order_.clear();
    subtree_end_.assign(splits_, 0);
    std::vector<std::uint32_t> size(splits_, 1);
    for (SplitId s = splits_; s-- > 0;)
      for (const SplitId child : {d_.nodes[s].child_u, d_.nodes[s].child_v})
        if (child != no_id) size[s] += size[child];
    std::vector<SplitId> stack(d_.roots.begin(), d_.roots.end());
    while (!stack.empty()) {
      const SplitId s = stack.back();
      stack.pop_back();
      place_[s] = static_cast<std::uint32_t>(order_.size());
      subtree_end_[s] = place_[s] + size[s];
      order_.push_back(s);
      for (const SplitId child : {d_.nodes[s].child_u, d_.nodes[s].child_v})
        if (child != no_id) stack.push_back(child);
    }
  }

  // Visits the corners of the faces that the split removes or inserts.
  template <typename Visit>
  void for_each_own_point(SplitId s, const Visit& visit) const {
    visit(d_.positions[h_.vertex_of(s)]);
    star_of(h_, s).for_each_face([&](const Triangle& t) {
      for (int k = 0; k < 3; ++k) visit(d_.positions[t[k]]);
    });
  }
  // Visits the unit normals of the own faces that have an area.
  template <typename Visit>
  void for_each_own_normal(SplitId s, const Visit& visit) const {
    star_of(h_, s).for_each_face([&](const Triangle& t) {
      const glm::dvec3 a(d_.positions[t.x]), b(d_.positions[t.y]), c(d_.positions[t.z]);
      const glm::dvec3 normal = glm::cross(b - a, c - a);
      const double length = glm::length(normal);
      if (length > 0.0) visit(glm::vec3(normal / length));
    });
  }
  // Entry leaves_ + i of a segment tree bounds place i of the order; inner entries bound their two children. A box with
  // min > max is empty.
  void make_segments() {
    leaves_ = std::bit_ceil(std::max<std::size_t>(order_.size(), 1));
    const glm::vec3 far(std::numeric_limits<float>::max());
    point_segments_.assign(2 * leaves_, {far, -far});
    normal_segments_.assign(2 * leaves_, {far, -far});
    const auto add_to = [](Box& box) {
      return [&box](const glm::vec3& p) { box = {glm::min(box.min, p), glm::max(box.max, p)}; };
    };
    for (std::size_t i = 0; i < order_.size(); ++i) {
      for_each_own_point(order_[i], add_to(point_segments_[leaves_ + i]));
      for_each_own_normal(order_[i], add_to(normal_segments_[leaves_ + i]));
    }
    for (std::vector<Box>* tree : {&point_segments_, &normal_segments_})
      for (std::size_t i = leaves_; i-- > 1;) {
        const Box &a = (*tree)[2 * i], &b = (*tree)[2 * i + 1];
        (*tree)[i] = {glm::min(a.min, b.min), glm::max(a.max, b.max)};
      }
  }

  // Returns true iff `inside` (of a convex bound) is true for every corner, or normal, of every face of the subtree of
  // s.
  template <typename Inside>
  [[nodiscard]] bool holds_points(SplitId s, const Inside& inside) const {
    return holds_run(point_segments_, {place_[s], subtree_end_[s]}, 1, {0, leaves_}, inside, [&](SplitId t) {
      bool all = true;
      for_each_own_point(t, [&](const glm::vec3& p) { all = all && inside(p); });
      return all;
    });
  }
  template <typename Inside>
  [[nodiscard]] bool holds_normals(SplitId s, const Inside& inside) const {
    return holds_run(normal_segments_, {place_[s], subtree_end_[s]}, 1, {0, leaves_}, inside, [&](SplitId t) {
      bool all = true;
      for_each_own_normal(t, [&](const glm::vec3& n) { all = all && inside(n); });
      return all;
    });
  }
  struct Run {
    std::size_t first, end;
  };
  template <typename Inside, typename OwnInside>
  [[nodiscard]] bool holds_run(const std::vector<Box>& tree, Run wanted, std::size_t entry, Run covered,
                               const Inside& inside, const OwnInside& own_inside) const {
    const Box& box = tree[entry];
    if (wanted.end <= covered.first || covered.end <= wanted.first || box.min.x > box.max.x) return true;
    if (wanted.first <= covered.first && covered.end <= wanted.end) {
      bool all = true;
      for (int i = 0; all && i < 8; ++i) all = inside(corner(box, i));
      if (all) return true;
    }
    if (covered.end - covered.first == 1) return own_inside(order_[covered.first]);
    const std::size_t middle = (covered.first + covered.end) / 2;
    return holds_run(tree, wanted, 2 * entry, {covered.first, middle}, inside, own_inside) &&
           holds_run(tree, wanted, 2 * entry + 1, {middle, covered.end}, inside, own_inside);
  }

  // Checks the first half of invariant 4: splits applied in order remove only active faces, exactly those they name,
  // and the result has as many faces as the input.
  void replay() {
    ActiveFaces active(h_);
    for (SplitId s = 0; s < splits_; ++s) {
      star_of(h_, s).for_each_removed([&](const FaceRef& ref, const Triangle& t) {
        if (!active.remove(ref))
          report("split {} removes a face of split {} that is not active", s, ref.split);
        else if (!same_triangle(t, face_at(h_, ref)))
          report("split {} removes another face of split {} than it says", s, ref.split);
      });
      active.apply(s);
    }
    if (active.face_count() != h_.face_count())
      report("there are {} faces, not {}", active.face_count(), h_.face_count());
    if (active.count() != h_.input_triangle_count())
      report("all splits together leave {} triangles, not {}", active.count(), h_.input_triangle_count());
  }

  // Checks that the corners of every face have wedges of one material.
  void check_materials() {
    if (d_.wedge_materials.empty()) return;
    const auto is_one = [&](const Triangle& t) {
      return h_.material_of(t.x) == h_.material_of(t.y) && h_.material_of(t.x) == h_.material_of(t.z);
    };
    for (std::uint32_t f = 0; f < d_.base_faces.size(); ++f)
      if (!is_one(wedges_of_face(h_, {no_id, f}, d_.base_faces[f]))) report("base face {} has several materials", f);
    for (SplitId s = 0; s < splits_; ++s) {
      const SplitCorners corners = corners_of_star(h_, s);
      for (std::uint32_t slot = 0; slot < star_of(h_, s).inserted_count(); ++slot)
        if (!is_one(corners.inserted(slot))) report("split {} inserts a face of several materials", s);
    }
  }

  // Checks the second half of invariant 4. In a closed set, every vertex that is not restored is represented by its
  // nearest ancestor that is. The cut is conforming iff its oriented boundary is that of the input with the vertices so
  // replaced: then every inner edge is shared exactly as often as in the input, and no crack opens.
  void check_random_cuts() {
    const std::vector<Triangle> input = triangles_of(h_, full_cut(h_));
    std::mt19937_64 random(20070308);  // any fixed seed
    for (int i = 0; i <= random_cuts_ && splits_ > 0; ++i) {
      // The cuts range from no split at all to nearly all of them, in random places.
      std::vector<bool> applied(splits_, false);
      const std::uint64_t wanted = i == 0 ? 0
                                          : 1 + random() % ((std::uint64_t{splits_} * static_cast<std::uint64_t>(i)) /
                                                                static_cast<std::uint64_t>(random_cuts_) / 4 +
                                                            1);
      for (std::uint64_t k = 0; k < wanted; ++k) apply_closed(static_cast<SplitId>(random() % splits_), applied);
      check_cut(applied, input);
    }
  }

  void apply_closed(SplitId s, std::vector<bool>& applied) {
    stack_.assign(1, s);
    while (!stack_.empty()) {
      const SplitId t = stack_.back();
      stack_.pop_back();
      if (applied[t]) continue;
      applied[t] = true;
      for (const SplitId needed : star_of(h_, t).dependencies()) stack_.push_back(needed);
    }
  }

  void check_cut(const std::vector<bool>& applied, const std::vector<Triangle>& input) {
    const std::size_t base_vertices = h_.base_vertex_count();
    std::vector<VertexId> stands_for(h_.vertex_count());
    for (VertexId v = 0; v < stands_for.size(); ++v)
      stands_for[v] = v < base_vertices || applied[v - base_vertices]
                          ? v
                          : stands_for[star_of(h_, static_cast<SplitId>(v - base_vertices)).parent_vertex()];
    ChainSum boundary, expected;
    for (const Triangle& t : active_triangles(h_, applied)) {
      for_each_edge(t, [&](VertexId from, VertexId to) { boundary.add(from, to); });
      for (int k = 0; k < 3; ++k)
        if (stands_for[t[k]] != t[k]) report("a cut lacks vertex {} of one of its faces", t[k]);
    }
    for (const Triangle& t : input)
      for_each_edge(t, [&](VertexId from, VertexId to) { expected.add(stands_for[from], stands_for[to]); });
    if (!(boundary == expected))
      report("a closed set of {} splits is not a conforming mesh", std::count(applied.begin(), applied.end(), true));
  }

  const Hierarchy& h_;
  const HierarchyView& d_;
  int random_cuts_;
  SplitId splits_;
  std::vector<std::string> violations_;
  std::vector<SplitId> order_;              // depth-first
  std::vector<std::uint32_t> place_;        // per split, in that order
  std::vector<std::uint32_t> subtree_end_;  // the place after its subtree
  std::vector<Box> point_segments_;
  std::vector<Box> normal_segments_;
  std::size_t leaves_ = 0;
  std::vector<SplitId> stack_;
};

}  // namespace

std::vector<std::string> validate(const Hierarchy& hierarchy, int random_cuts) {
  return Validator(hierarchy, random_cuts).run();
}

}  // namespace occlod
