#include "splits/motion_cut.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "splits/active_faces.h"
#include "splits/change_bound.h"
#include "splits/collapse_rules.h"
#include "occlod/hierarchy/cut_mesh.h"
#include "splits/star_mesh.h"

namespace occlod {
namespace {

class LimitedReplay {
 public:
  LimitedReplay(const Hierarchy& hierarchy, double max_motion, const MotionCutWithout& without)
      : h_(hierarchy),
        max_motion_(max_motion),
        without_(without),
        mesh_(triangles_of(hierarchy, full_cut(hierarchy)), hierarchy.vertex_count()),
        positions_(hierarchy.positions()),
        stays_(hierarchy.split_count(), false) {
    auto next = static_cast<std::uint32_t>(hierarchy.base_triangle_count());
    first_face_.reserve(hierarchy.split_count());
    for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
      first_face_.push_back(next);
      next += hierarchy.star(s).inserted_count();
    }
    moved_.assign(next, 0.0F);
  }

  void run() {
    for (auto s = static_cast<SplitId>(h_.split_count()); s-- > 0;) {
      stays_[s] = stays_[s] || !undo(s);
      if (stays_[s])
        for (const SplitId needed : h_.star(s).dependencies()) stays_[needed] = true;
    }
  }

  [[nodiscard]] MotionCut result() const {
    ActiveFaces active(h_);
    for (SplitId s = 0; s < h_.split_count(); ++s) {
      if (!stays_[s]) continue;
      active.apply(s);
      h_.star(s).for_each_removed_ref([&](const FaceRef& ref) { active.remove(ref); });
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
      const SplitStar star = h_.star(s);
      for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot) add({s, slot}, star.inserted(slot));
    }
    return cut;
  }

 private:
  [[nodiscard]] std::size_t place_of(const FaceRef& ref) const {
    return ref.slot + (ref.split == no_id ? std::size_t{0} : first_face_[ref.split]);
  }

  // False when the collapse has to be left out.
  bool undo(SplitId s) {
    const SplitStar star = h_.star(s);
    if (star.inserted_count() == 0) return false;
    const VertexId v = star.vertex(), u = star.parent_vertex();
    if (!has_inserted_star(mesh_, star)) return false;
    ring_.gather(mesh_, v);
    const std::optional<std::size_t> place = ring_.place_of(u);
    if (!place) return false;
    const bool keeps = is_plain(star) && keeps_topology(mesh_, ring_, *place);
    if (!keeps && !without_.topology) return false;
    float before = 0.0F;
    for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot)
      before = std::max(before, moved_[place_of({s, slot})]);
    const double now = keeps ? change_bound_(mesh_, positions_, ring_, u)
                             : glm::distance(glm::dvec3(positions_[v]), glm::dvec3(positions_[u]));
    const double after = static_cast<double>(before) + now;
    if (!(after <= max_motion_)) return false;
    const float rounded = std::nextafter(static_cast<float>(after), std::numeric_limits<float>::infinity());
    star.for_each_removed_ref([&](const FaceRef& ref) { moved_[place_of(ref)] = after > 0.0 ? rounded : 0.0F; });
    ended_.clear();
    mesh_.collapse(v, u, s, !keeps, arena_, ended_);
    return true;
  }

  // Whether the faces that the split removes are those that it inserts without u, with u for v: nothing was folded.
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
  MotionCutWithout without_;
  StarMesh mesh_;
  PositionView positions_;
  std::vector<bool> stays_;  // of splits: applied in the cut
  std::vector<std::uint32_t> first_face_;
  std::vector<float> moved_;  // of faces that ever existed
  VertexRing ring_;
  ChangeBound change_bound_;
  StarArena arena_;
  std::vector<LevelFace> ended_;
};

}  // namespace

MotionCut cut_to_motion(const Hierarchy& hierarchy, double max_motion, const MotionCutWithout& without) {
  hierarchy.require_all();
  LimitedReplay replay(hierarchy, max_motion, without);
  replay.run();
  return replay.result();
}

MotionCut cut_to_motion(const Hierarchy& hierarchy, double max_motion) {
  return cut_to_motion(hierarchy, max_motion, {});
}

}  // namespace occlod
