// Estimates what queries cost and save, from what strategies remember of nodes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hlod/draw/cover_model.h"
#include "hlod/draw/frame_scene.h"
#include "occlod/device_costs.h"
#include "occlod/traverser.h"

namespace occlod::hlod {

// Holds one value for each node of the scene.
template <typename T>
class PerNode {
 public:
  // Must be called before the first use in a frame. Forgets all values in the first frame of the scene. Returns whether
  // it did.
  bool fit(const FrameScene& scene) {
    if (scene.frame() > 1 && !values_.empty()) return false;
    values_.resize(scene.object_count());
    for (std::uint32_t i = 0; i < scene.object_count(); ++i) values_[i].assign(scene.hlod({i, 0}).node_count(), T());
    return true;
  }
  [[nodiscard]] T& operator[](NodeRef n) noexcept { return values_[n.object][n.node]; }
  [[nodiscard]] const T& operator[](NodeRef n) const noexcept { return values_[n.object][n.node]; }

 private:
  std::vector<std::vector<T>> values_;
};

// Decides whether a query is worth its time: Guthe, Balazs and Klein 2006, secs. 3.2 and 4.1 to 4.3.

// Counts the work that drawing makes in each stage of a device.
struct DrawWork {
  double draws = 0.0;
  double triangles = 0.0;
  double fragments = 0.0;

  DrawWork& operator+=(const DrawWork& other) noexcept {
    draws += other.draws;
    triangles += other.triangles;
    fragments += other.fragments;
    return *this;
  }
};
[[nodiscard]] inline DrawWork operator*(double share, const DrawWork& work) noexcept {
  return {share * work.draws, share * work.triangles, share * work.fragments};
}

// Returns t_r, the time to draw: the slowest stage decides.
[[nodiscard]] double draw_time_ns(const DeviceCosts& costs, const DrawWork& work) noexcept;
// Returns t_o, the time of a query for a box that covers `box_pixels`. The paper does not print it; this is by analogy
// with t_r.
[[nodiscard]] double query_time_ns(const DeviceCosts& costs, double box_pixels) noexcept;

// Weighs a query about one node.
struct QueryValue {
  double draw_ns = 0.0;   // t_r of everything below it
  double query_ns = 0.0;  // t_o
  double benefit_ns = 0.0;
};
// Returns the value of a query. `depth` > 0 is the hierarchy's: benefits add up over its levels.
[[nodiscard]] QueryValue query_value(double draw_ns, double query_ns, double occlusion_probability,
                                     double depth) noexcept;

// Tells what the test needs to know of a node besides its value.
struct AskedBefore {
  LastSight last = LastSight::outside;
  double occlusion_probability = 0.0;
  double frames_since_asked = 0.0;  // n_q; for a node that was never queried, since it was first seen
};

// Sums over a node's children inside the frustum.
struct ChildrenValue {
  double query_ns = 0.0;
  double benefit_ns = 0.0;
  double leaves = 0.0;         // N_l: number of nodes that are drawn below the node
  bool any_unaskable = false;  // a child takes less time to draw than to query
};

// Returns the decision of the paper's fig. 5 with sec. 4.1. Its figure sums over the children of leaves too, so that
// leaves would never be queried; here both tests of children apply to inner nodes only. `children` is null for a leaf.
[[nodiscard]] bool is_query_reasonable(const DeviceCosts& costs, const QueryValue& node, const AskedBefore& before,
                                       const ChildrenValue* children) noexcept;

// Returns N_q (sec. 4.3): after this many later queries, a query must have been answered.
[[nodiscard]] double max_parallel_queries(const DeviceCosts& costs) noexcept;

// Returns the surface area in square object units.
[[nodiscard]] double box_area(const Box& box);
// Returns the work of drawing the node itself, whatever its level. `coverage` is ObjectFrame::coverage() of its box.
[[nodiscard]] DrawWork own_work(const FrameScene& scene, NodeRef n, double coverage);
// Returns the share of the image that the node's triangles cover.
[[nodiscard]] double own_coverage(const FrameScene& scene, NodeRef n);

// Returns the share of the image that the boxes of the HLOD's roots cover side by side, at most 1. O(roots).
[[nodiscard]] double root_share(const Hlod& hlod, const ObjectFrame& view);

// Estimates how probable it is that nodes are covered by what has been drawn in the frame so far.
//
// Guthe and others place objects at random in the whole image, so that what fills a tenth of it hides at most a tenth
// of what comes later. A scan that stands free hides half of itself. With CoverModel::in_scene the same formulas are of
// the part of the image that the scene covers. It is 1 where the eye is inside the scene, and then both are the same.
class Covered {
 public:
  void begin_frame(const FrameScene& scene);
  void note_drawn(const FrameScene& scene, NodeRef n);
  // Returns p_cov. `coverage` is ObjectFrame::coverage() of the node's box.
  [[nodiscard]] double probability(double coverage) const;

 private:
  double covered_ = 0.0;      // c_scr, of the scene's share
  double scene_share_ = 1.0;  // of the image; 1 as printed
};

// Returns what was known of a node in the last frame.
[[nodiscard]] LastSight last_sight(const FrameScene& scene, NodeRef n);

// Estimates the work of drawing everything below a node. For a node that stops it is known. For any other node it is
// what was drawn below it when anything last was; before that, its error predicts it. A node with several parents
// counts for each by the share of its triangles.
class WorkBelow {
 public:
  void begin_frame(const FrameScene& scene);
  // Is called once a frame for each node inside the frustum.
  void note_visited(NodeRef n) { visited_.push_back(n); }
  void note_drawn(const FrameScene& scene, NodeRef n);
  void end_frame(const FrameScene& scene);

  // Returns the estimate. `coverage` is ObjectFrame::coverage() of the node's box.
  [[nodiscard]] DrawWork of(const FrameScene& scene, NodeRef n, double coverage) const;
  // Returns the estimate for a node that is refined because it is not fine enough without a bias.
  [[nodiscard]] DrawWork refined(const FrameScene& scene, NodeRef n, double coverage) const;

 private:
  struct Record {
    float draws = 0.0F;      // when anything was last drawn below it; 0: never
    float triangles = 0.0F;  // when anything was last drawn below it
    float now_draws = 0.0F;  // in this frame
    float now_triangles = 0.0F;
    float all_draws = 0.0F;  // nodes of level 0 below it
    float all_triangles = 0.0F;
  };
  void add_up_level_0(const FrameScene& scene);

  PerNode<Record> records_;
  std::vector<NodeRef> visited_;  // in this frame
};

// Estimates how often queried nodes turn out hidden. The model of Guthe and others 2006 takes drawn objects for
// rectangles at random places. Real scenes are a row of houses or an engine under its hood, so its probabilities only
// sort nodes into classes, whose rates are corrected by answers.
class HidingRates {
 public:
  void begin_frame();
  // Records an answer about a node that was visible when it was last queried, `frames` ago.
  void note_visible(double cover_probability, double frames, bool hidden);
  // Records an answer about a node of which nothing was known.
  void note_new(double cover_probability, bool hidden);

  // Returns the probability that a visible node is hidden in the next frame.
  [[nodiscard]] double of_visible(double cover_probability) const;
  // Returns the probability that a node of which nothing is known is hidden.
  [[nodiscard]] double of_new(double cover_probability) const;

 private:
  static constexpr std::size_t classes = 8;
  struct Count {
    double hidden = 0.0;
    double all = 0.0;
  };
  [[nodiscard]] static std::size_t class_of(double cover_probability);

  std::array<Count, classes> visible_;  // `all` counts frames
  std::array<Count, classes> new_;      // `all` counts nodes
};

// Chooses hidden nodes for one query: the multi-queries of CHC++ (Mattausch and others 2008, sec. 5.2).
class HiddenGroups {
 public:
  void begin_frame(const FrameScene& scene) { hidden_frames_.fit(scene); }
  void note_answer(NodeRef n, bool visible) { hidden_frames_[n] = visible ? 0 : hidden_frames_[n] + 1; }

  // Moves the nodes of the next query to the front, those most likely to stay hidden first, and returns their number m.
  // Adds nodes as long as V = m / (1 + p_fail m) does not fall.
  [[nodiscard]] std::size_t group(std::span<NodeRef> hidden) const;

 private:
  PerNode<std::uint32_t> hidden_frames_;
};

}  // namespace occlod::hlod
