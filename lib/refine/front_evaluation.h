// Evaluates what the nodes on the fronts of all objects are worth in a view, and for how long.
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
  glm::vec3 center{0.0F};  // center that motion is counted from, object space
};

// Returns the priority of a split with this star and these errors, or nothing unless the star is wholly inside the
// frustum. Precondition: it has at most FrontStar::max_faces faces.
[[nodiscard]] std::optional<FrontPriority> front_priority(const FrontStar& star, const SplitErrors& errors,
                                                          const FrontView& front_view);

// Priorities within this factor of the level, the priority at which the budget ended, are looked at first.
inline constexpr float level_band = 1.06F;
// Below this part of the level, nodes are worthless: they are no longer descended.
inline constexpr float worthless_part = 0.5F;

// Holds what a split is worth.
struct SplitWorth {
  float priority = 0.0F;      // 0: changes nothing that is seen
  float own_priority = 0.0F;  // priority without what the split forces
  ScreenError error;
};

struct AppliedCount {
  std::size_t all = 0;        // applied splits
  std::size_t worthless = 0;  // of these, splits that matter much less than the level
};

// Keeps for each node on a front the last evaluation, and how far the view may move before that expires. After
// restart() or move_to() every scale holds in this frame's view to within its error factor.
class FrontEvaluation {
 public:
  explicit FrontEvaluation(std::span<const RefineObject> objects);

  // Starts with empty fronts in this view.
  void restart(const RefinedScene& scene);
  // Goes on in this view and evaluates anew what has expired.
  void move_to(const RefinedScene& scene);

  [[nodiscard]] const RefinedScene& scene() const noexcept { return scene_; }
  [[nodiscard]] std::uint32_t object_count() const noexcept { return static_cast<std::uint32_t>(objects_.size()); }
  [[nodiscard]] Front& front(std::uint32_t object) noexcept { return objects_[object].front; }
  [[nodiscard]] const Front& front(std::uint32_t object) const noexcept { return objects_[object].front; }
  [[nodiscard]] std::size_t node_count() const noexcept;

  // These return what is known of all nodes of an object, for select().
  [[nodiscard]] BoundedProducts errors(std::uint32_t object) const;
  [[nodiscard]] BoundedProducts guaranteed_errors(std::uint32_t object) const;
  [[nodiscard]] BoundedProducts priorities(std::uint32_t object) const;
  [[nodiscard]] BoundedProducts leaf_priorities(std::uint32_t object) const;

  // Finds the scales of these nodes for this view, unless that has been done.
  void evaluate(std::uint32_t object, std::span<const Front::Index> nodes);
  // Evaluates all nodes whose scales have expired.
  void evaluate_expired(std::uint32_t object);
  // Returns the largest ratio of a split's priority to its subtree's error.
  [[nodiscard]] float most_grazing() const;
  // Returns an upper bound on the priority of a node's split, as far as it is known; NaN when nothing is.
  [[nodiscard]] float priority_at_most(std::uint32_t object, Front::Index k) const;
  // Returns what the split of a node is worth.
  [[nodiscard]] SplitWorth worth(std::uint32_t object, Front::Index k);
  // Returns the same for many nodes, each listed once, on as many threads as the options allow; `worths` has the size
  // of `nodes`.
  void find_worths(std::uint32_t object, std::span<const Front::Index> nodes, std::span<SplitWorth> worths);

  // Counts applied splits, and those whose subtrees matter no more than `least`.
  [[nodiscard]] AppliedCount count_applied(float least) const;
  // Adds to `stats` how many nodes have been reached, and why nothing is done at some of them.
  void count_nodes(RefineStats& stats) const;
  // Raises `left` to the largest error of what is held to be visible and is not refined. Evaluates only nodes that may
  // have it.
  void measure_errors(ScreenError& left);

 private:
  struct Object {
    explicit Object(const RefineObject& object) : front(*object.hierarchy, object.attributes) {}

    Front front;
    std::optional<ObjectView> view;  // view in the last frame
    float steepness = 0.0F;          // see FrontView
    ViewMotion motion;               // since the front was last evaluated as a whole
  };

  void see(std::uint32_t object);
  void move(std::uint32_t object);
  [[nodiscard]] std::optional<SplitWorth> find_worth(std::uint32_t object, Front::Index k);
  [[nodiscard]] SplitWorth worth_of_other(std::uint32_t object, Front::Index k);
  SplitWorth note(std::uint32_t object, Front::Index k, const FrontPriority& found);
  void measure_unreached(std::uint32_t object, const BoundedProducts& of, float so_far, ScreenError& left);
  void measure_unapplied(std::uint32_t object, const BoundedProducts& of, float so_far, ScreenError& left);

  RefinedScene scene_;
  std::vector<Object> objects_;
  std::optional<View> last_view_;
  std::vector<Front::Index> found_, expired_, outdated_;  // scratch, like the next one
  std::vector<SplitWorth> worths_;
};

}  // namespace occlod
