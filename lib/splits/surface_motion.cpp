#include "splits/surface_motion.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <span>

#include "splits/change_bound.h"
#include "splits/collapse_rules.h"
#include "occlod/hierarchy/cut_mesh.h"
#include "splits/star_mesh.h"

namespace occlod {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Of the next single precision number that has no lower half; rounds up.
std::uint16_t upper_half(double length) {
  if (length == 0.0) return 0;
  const float single = std::nextafter(static_cast<float>(length), std::numeric_limits<float>::infinity());
  return static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(single) + 0xFFFFU) >> 16U);
}

}  // namespace

class SurfaceMotion::Replay {
 public:
  Replay(const Hierarchy& hierarchy, SurfaceMotion& result)
      : h_(hierarchy),
        result_(result),
        mesh_(triangles_of(hierarchy, full_cut(hierarchy)), hierarchy.vertex_count()),
        positions_(hierarchy.positions()),
        has_marks_(hierarchy.vertex_count(), false) {}

  // False when what is recorded did not happen.
  bool run() {
    for (auto s = static_cast<SplitId>(h_.split_count()); s-- > 0;)
      if (!undo(s)) return false;
    return true;
  }

 private:
  bool undo(SplitId s) {
    const SplitStar star = h_.star(s);
    const VertexId v = star.vertex(), u = star.parent_vertex();
    if (!has_inserted_star(mesh_, star)) return false;
    if (star.inserted_count() == 0) return true;
    ring_.gather(mesh_, v);
    const std::optional<std::size_t> place = ring_.place_of(u);
    if (!place) return false;
    const bool keeps = keeps_topology(mesh_, ring_, *place);
    if (!keeps) mark(u);
    const bool slides = !keeps || has_marks_[v];
    const double moved = slides ? glm::distance(glm::dvec3(positions_[v]), glm::dvec3(positions_[u]))
                                : change_bound_(mesh_, positions_, ring_, u);
    pass_on(s, star, moved);
    if (has_marks_[v]) has_marks_[u] = true;
    ended_.clear();
    const std::size_t gone = keeps ? mesh_.collapse(v, u, s, false, arena_, ended_)
                                   : mesh_.collapse_again(v, u, s, folded_by(star), arena_, ended_);
    return gone == star.inserted_count() - star.removed_count();
  }

  // Older faces that faces at v are folded onto, from u.
  [[nodiscard]] std::span<const Triangle> folded_by(const SplitStar& star) {
    folded_.clear();
    star.for_each_inserted([&](const Triangle& t) {
      if (!contains(t, star.vertex()) && contains(t, star.parent_vertex()))
        folded_.push_back(rotated(t, star.parent_vertex()));
    });
    return folded_;
  }

  // u, and what is a neighbour of both ends.
  void mark(VertexId u) {
    ++result_.topology_changes_;
    const auto set = [&](VertexId w) { result_.marked_[w] = has_marks_[w] = true; };
    set(u);
    for (const VertexId w : ring_.neighbours())
      if (w != u && mesh_.edge_degree(u, w) > 0) set(w);
  }

  // Faces that the collapse makes have moved as far as the farthest of those that it ends, and then this far.
  void pass_on(SplitId s, const SplitStar& star, double moved) {
    float before = 0.0F;
    for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot)
      before = std::max(before, result_.moved({s, slot}));
    const std::uint16_t after = upper_half(static_cast<double>(before) + moved);
    star.for_each_removed_ref([&](const FaceRef& ref) {
      const std::size_t place = ref.slot + (ref.split == no_id ? std::size_t{0} : result_.first_face_[ref.split]);
      if (place < result_.moved_.size()) result_.moved_[place] = after;
    });
  }

  const Hierarchy& h_;
  SurfaceMotion& result_;
  StarMesh mesh_;
  PositionView positions_;
  std::vector<bool> has_marks_;  // of vertices: what has been merged into them until now
  VertexRing ring_;
  ChangeBound change_bound_;
  StarArena arena_;
  std::vector<LevelFace> ended_;
  std::vector<Triangle> folded_;
};

SurfaceMotion::SurfaceMotion(const Hierarchy& hierarchy)
    : marked_(hierarchy.vertex_count(), false), marks_below_(hierarchy.split_count(), false) {
  hierarchy.require_all();
  auto next = static_cast<std::uint32_t>(hierarchy.base_triangle_count());
  first_face_.reserve(hierarchy.split_count());
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    first_face_.push_back(next);
    next += hierarchy.star(s).inserted_count();
  }
  moved_.assign(next, 0);
  if (!Replay(hierarchy, *this).run()) std::fill(moved_.begin(), moved_.end(), upper_half(infinity));
  for (auto s = static_cast<SplitId>(hierarchy.split_count()); s-- > 0;) {
    const SplitNode& node = hierarchy.node(s);
    bool marks = marked_[hierarchy.vertex_of(s)];
    for (const SplitId child : {node.child_u, node.child_v}) marks = marks || (child != no_id && marks_below_[child]);
    marks_below_[s] = marks;
  }
}

std::shared_ptr<const SurfaceMotion> motion_of(const Hierarchy& hierarchy) {
  static std::mutex mutex;
  static std::map<const void*, std::weak_ptr<const SurfaceMotion>> held;  // by the arrays that they are about
  const std::lock_guard lock(mutex);
  std::erase_if(held, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<const SurfaceMotion>& place = held[hierarchy.positions().data()];
  std::shared_ptr<const SurfaceMotion> motion = place.lock();
  if (motion == nullptr) place = motion = std::make_shared<const SurfaceMotion>(hierarchy);
  return motion;
}

}  // namespace occlod
