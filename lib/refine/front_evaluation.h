// What the split of a node is worth by how its own faces are seen, and for how long.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "occlod/refiner.h"
#include "refine/front.h"
#include "refine/importance.h"
#include "refine/refined_scene.h"

namespace occlod {

struct FrontPriority {
  Importance::Value value;
  ErrorGrowth growth;
};

struct FrontView {
  const ObjectView& view;
  const Importance& importance;
  bool two_sided = false;
  float grazing_exponent = 0.0F;
  float steepness = 0.0F;  // twice the tangent of the angle of the image's corners
  glm::vec3 center{0.0F};  // that motion is counted from
};

// Of a star with no more than FrontStar::max_faces that is wholly inside the frustum, of a split with these errors.
[[nodiscard]] FrontPriority front_priority(const FrontStar& star, const SplitErrors& errors,
                                           const FrontView& front_view);

// What the nodes on the fronts of all objects are worth in the view of this frame.

// What matters within this factor of the level, the priority where the budget ended, is looked at first.
inline constexpr float level_band = 1.06F;
// What matters less than this part of the level is worthless: nodes are no longer descended.
inline constexpr float worthless_part = 0.5F;

// Of a split.
struct SplitWorth {
  float priority = 0.0F;      // 0 = changes nothing that is seen
  float own_priority = 0.0F;  // without what it forces
  ScreenError error;
};

struct AppliedCount {
  std::size_t all = 0;        // splits
  std::size_t worthless = 0;  // of those, that matter much less than what the budget goes to
};

// For each node on a front the last evaluation is kept, and how far the view may move before that expires. After
// restart() or move_to() every scale holds in this frame's view to within its error factor.
class FrontEvaluation {
 public:
  explicit FrontEvaluation(std::span<const RefineObject> objects);

  // Starts with empty fronts in this view.
  void restart(const RefinedScene& scene);
  // Goes on in this view: what has expired is evaluated anew.
  void move_to(const RefinedScene& scene);

  [[nodiscard]] const RefinedScene& scene() const noexcept { return scene_; }
  [[nodiscard]] std::uint32_t object_count() const noexcept { return static_cast<std::uint32_t>(objects_.size()); }
  [[nodiscard]] Front& front(std::uint32_t object) noexcept { return objects_[object].front; }
  [[nodiscard]] const Front& front(std::uint32_t object) const noexcept { return objects_[object].front; }
  [[nodiscard]] std::size_t node_count() const noexcept;

  // What is known of all nodes of an object, for select().
  [[nodiscard]] BoundedProducts errors(std::uint32_t object) const;
  [[nodiscard]] BoundedProducts guaranteed_errors(std::uint32_t object) const;
  [[nodiscard]] BoundedProducts priorities(std::uint32_t object) const;
  [[nodiscard]] BoundedProducts leaf_priorities(std::uint32_t object) const;

  // Finds the scales of these nodes for this view, if that has not been done.
  void evaluate(std::uint32_t object, std::span<const Front::Index> nodes);
  // Of all that have none.
  void evaluate_expired(std::uint32_t object);
  // A split's priority is at most its subtree's error times this.
  [[nodiscard]] float most_grazing() const;
  // Of the split of a node, at most, as far as it is known; NaN when nothing is.
  [[nodiscard]] float priority_at_most(std::uint32_t object, Front::Index k) const;
  // Of the split of a node.
  [[nodiscard]] SplitWorth worth(std::uint32_t object, Front::Index k);

  // Of applied splits, by whether their subtrees matter more than `least`.
  [[nodiscard]] AppliedCount count_applied(float least) const;
  // How many nodes have been reached, and why nothing is done at some of them.
  void count_nodes(RefineStats& stats) const;
  // The largest error of what is held to be visible and is not refined. Only what may be it is evaluated.
  void measure_errors(ScreenError& left);

 private:
  struct Object {
    explicit Object(const RefineObject& object) : front(*object.hierarchy, object.attributes) {}

    Front front;
    std::optional<ObjectView> view;  // of the last frame
    ViewMotion motion;               // since the front was last evaluated as a whole
  };

  void move(std::uint32_t object);
  [[nodiscard]] SplitWorth worth_by_star(std::uint32_t object, Front::Index k);
  void measure_unreached(std::uint32_t object, const BoundedProducts& of, float so_far, ScreenError& left);
  void measure_unapplied(std::uint32_t object, const BoundedProducts& of, float so_far, ScreenError& left);

  RefinedScene scene_;
  std::vector<Object> objects_;
  std::optional<View> last_view_;
  std::vector<Front::Index> found_, expired_;  // scratch
};

}  // namespace occlod
