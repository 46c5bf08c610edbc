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

#include "occlod/build_hierarchy.h"
#include "splits/active_faces.h"
#include "splits/collapse_rules.h"
#include "splits/star.h"
#include "splits/star_mesh.h"

namespace occlod {
namespace {

class LimitedReplay {
 public:
  LimitedReplay(const Hierarchy& hierarchy, double max_motion)
      : h_(hierarchy),
        max_motion_(max_motion),
        mesh_(triangles_of(hierarchy, full_cut(hierarchy)), hierarchy.vertex_count()),
        positions_(hierarchy.positions()),
        stays_(hierarchy.split_count(), false) {
    auto next = static_cast<std::uint32_t>(hierarchy.base_triangle_count());
    first_face_.reserve(hierarchy.split_count());
    for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
      first_face_.push_back(next);
      next += star_of(hierarchy, s).inserted_count();
    }
    moved_.assign(next, 0.0F);
  }

  void run() {
    for (auto s = static_cast<SplitId>(h_.split_count()); s-- > 0;) {
      stays_[s] = stays_[s] || !undo(s);
      if (stays_[s])
        for (const SplitId needed : star_of(h_, s).dependencies()) stays_[needed] = true;
    }
  }

  [[nodiscard]] MotionCut result() const {
    ActiveFaces active(h_);
    for (SplitId s = 0; s < h_.split_count(); ++s) {
      if (!stays_[s]) continue;
      active.apply(s);
      star_of(h_, s).for_each_removed_ref([&](const FaceRef& ref) { active.remove(ref); });
    }
    MotionCut cut;
    const auto add = [&](const FaceRef& ref, const Triangle& t) {
      if (!active.active(ref)) return;
      cut.triangles.push_back(t);
      cut.moved.push_back(moved_[place_of(ref)]);
    };
    for (std::uint32_t slot = 0; slot < h_.base_triangle_count(); ++slot)
      add({no_id, slot}, h_.data().base_faces[slot]);
    for (SplitId s = 0; s < h_.split_count(); ++s) {
      if (!stays_[s]) continue;
      const SplitStar star = star_of(h_, s);
      for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot) add({s, slot}, star.inserted(slot));
    }
    return cut;
  }

 private:
  [[nodiscard]] std::size_t place_of(const FaceRef& ref) const {
    return ref.slot + (ref.split == no_id ? std::size_t{0} : first_face_[ref.split]);
  }

  // Undoes a split; returns false when its collapse has to be left out.
  bool undo(SplitId s) {
    const SplitStar star = star_of(h_, s);
    if (star.inserted_count() == 0) return false;
    const VertexId v = star.vertex(), u = star.parent_vertex();
    if (!has_inserted_star(mesh_, star)) return false;
    ring_.gather(mesh_, v);
    const std::optional<std::size_t> place = ring_.place_of(u);
    if (!place) return false;
    const bool keeps = is_plain(star) && keeps_topology(mesh_, ring_, *place);
    if (!keeps) return false;
    float before = 0.0F;
    for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot)
      before = std::max(before, moved_[place_of({s, slot})]);
    const double now = keeps ? change_bound_(positions_, ring_, u)
                             : glm::distance(glm::dvec3(positions_[v]), glm::dvec3(positions_[u]));
    const double after = static_cast<double>(before) + now;
    if (!(after <= max_motion_)) return false;
    const float rounded = std::nextafter(static_cast<float>(after), std::numeric_limits<float>::infinity());
    star.for_each_removed_ref([&](const FaceRef& ref) { moved_[place_of(ref)] = after > 0.0 ? rounded : 0.0F; });
    ended_.clear();
    mesh_.collapse(v, u, s, !keeps, arena_, ended_);
    return true;
  }

  // Returns whether the faces that the split removes are those that it inserts without u, with v replaced by u: nothing
  // was folded.
  [[nodiscard]] static bool is_plain(const SplitStar& star) {
    std::uint32_t others = 0;
    for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot) {
      const Triangle t = star.inserted(slot);
      if (!contains(t, star.vertex())) return false;
      others += contains(t, star.parent_vertex()) ? 0U : 1U;
    }
    return others == star.removed_count();
  }

  const Hierarchy& h_;
  double max_motion_;
  StarMesh mesh_;
  PositionView positions_;
  std::vector<bool> stays_;  // per split: applied in the cut
  std::vector<std::uint32_t> first_face_;
  std::vector<float> moved_;  // per face that ever existed
  VertexRing ring_;
  ChangeBound change_bound_;
  StarArena arena_;
  std::vector<LevelFace> ended_;
};

}  // namespace

MotionCut cut_to_motion(const Hierarchy& hierarchy, double max_motion) {
  hierarchy.require_all();
  LimitedReplay replay(hierarchy, max_motion);
  replay.run();
  return replay.result();
}

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Rounds up to a single-precision number whose lower half is zero, and returns the upper half.
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

  // Returns false when the recorded collapses are inconsistent.
  bool run() {
    for (auto s = static_cast<SplitId>(h_.split_count()); s-- > 0;)
      if (!undo(s)) return false;
    return true;
  }

 private:
  bool undo(SplitId s) {
    const SplitStar star = star_of(h_, s);
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
                                : change_bound_(positions_, ring_, u);
    pass_on(s, star, moved);
    if (has_marks_[v]) has_marks_[u] = true;
    ended_.clear();
    const std::size_t gone = keeps ? mesh_.collapse(v, u, s, false, arena_, ended_)
                                   : mesh_.collapse_again(v, u, s, folded_by(star), arena_, ended_);
    return gone == star.inserted_count() - star.removed_count();
  }

  // Returns the older faces onto which faces at v are folded, as seen from u.
  [[nodiscard]] std::span<const Triangle> folded_by(const SplitStar& star) {
    folded_.clear();
    star.for_each_inserted([&](const Triangle& t) {
      if (!contains(t, star.vertex()) && contains(t, star.parent_vertex()))
        folded_.push_back(rotated(t, star.parent_vertex()));
    });
    return folded_;
  }

  // Marks u and the vertices that were neighbours of both ends.
  void mark(VertexId u) {
    ++result_.topology_changes_;
    const auto set = [&](VertexId w) { result_.marked_[w] = has_marks_[w] = true; };
    set(u);
    for (const VertexId w : ring_.neighbours())
      if (w != u && mesh_.edge_degree(u, w) > 0) set(w);
  }

  // Propagates motion: faces that the collapse makes have moved as far as the farthest of the faces that it ends, plus
  // this distance.
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
  std::vector<bool> has_marks_;  // per vertex: whether a mark has been merged into it so far
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
    next += star_of(hierarchy, s).inserted_count();
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
  static std::map<const void*, std::weak_ptr<const SurfaceMotion>> held;  // keyed by the arrays they describe
  const std::lock_guard lock(mutex);
  std::erase_if(held, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<const SurfaceMotion>& place = held[hierarchy.positions().data()];
  std::shared_ptr<const SurfaceMotion> motion = place.lock();
  if (motion == nullptr) place = motion = std::make_shared<const SurfaceMotion>(hierarchy);
  return motion;
}

}  // namespace occlod
