// What a strategy remembers of nodes.
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

template <typename T>
class PerNode {
 public:
  // Before the first use in a frame. Forgets everything in the first frame of the scene. Whether nothing is known.
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

// Whether a query is worth its time: Guthe, Balazs and Klein 2006, secs. 3.2, 4.1 and 4.2.

// What drawing takes of a device's stages.
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

// t_r: the slowest stage decides.
[[nodiscard]] double draw_time_ns(const DeviceCosts& costs, const DrawWork& work) noexcept;
// t_o, for a box that covers so many pixels. Not printed; by analogy with t_r.
[[nodiscard]] double query_time_ns(const DeviceCosts& costs, double box_pixels) noexcept;

// Of one node.
struct QueryValue {
  double draw_ns = 0.0;   // t_r of what is below it
  double query_ns = 0.0;  // t_o: what asking costs
  double benefit_ns = 0.0;
};
// depth: of the hierarchy, > 0: benefits add up over its levels.
[[nodiscard]] QueryValue query_value(double draw_ns, double query_ns, double occlusion_probability,
                                     double depth) noexcept;

// What the test has to know of a node beside its value.
struct AskedBefore {
  LastSight last = LastSight::outside;
  double occlusion_probability = 0.0;
  double frames_since_asked = 0.0;  // n_q; of a node that was never asked about, since it was first seen
};

// Of the node's children together; those outside the frustum are left out, so they cost nothing.
struct ChildrenValue {
  double query_ns = 0.0;
  double benefit_ns = 0.0;
  double leaves = 0.0;         // N_l: nodes that are drawn below the node
  bool any_unaskable = false;  // one whose drawing takes less than its query
};

// The paper's fig. 5 with sec. 4.1. Its figure sums over the children of leaves too, so that those would never be asked
// about; here both tests of children are for inner nodes. `children` is null for a leaf.
[[nodiscard]] bool is_query_reasonable(const DeviceCosts& costs, const QueryValue& node, const AskedBefore& before,
                                       const ChildrenValue* children) noexcept;

// N_q: so many queries after one was asked, it must be answered.
[[nodiscard]] double max_parallel_queries(const DeviceCosts& costs) noexcept;

// What drawing takes of what is below a node.

// Square object units.
[[nodiscard]] double box_area(const Box& box);
// Of drawing the node itself, whatever its level. coverage: ObjectFrame::coverage() of its box.
[[nodiscard]] DrawWork own_work(const FrameScene& scene, NodeRef n, double coverage);
// The share of the image that the node's triangles cover, likewise.
[[nodiscard]] double own_coverage(const FrameScene& scene, NodeRef n);

// What was known of a node in the last frame.
[[nodiscard]] LastSight last_sight(const FrameScene& scene, NodeRef n);

// A node that stops is known; of any other counts what was drawn below it when something was last; before that, what
// its error lets expect. Nodes with several parents count for each by its share of their triangles.
class WorkBelow {
 public:
  void begin_frame(const FrameScene& scene);
  // n is inside the frustum; once a frame.
  void note_visited(NodeRef n) { visited_.push_back(n); }
  void note_drawn(const FrameScene& scene, NodeRef n);
  void end_frame(const FrameScene& scene);

  // coverage: ObjectFrame::coverage() of the node's box.
  [[nodiscard]] DrawWork of(const FrameScene& scene, NodeRef n, double coverage) const;
  // The same of a node that is not fine enough without a bias, if it is refined.
  [[nodiscard]] DrawWork refined(const FrameScene& scene, NodeRef n, double coverage) const;

 private:
  struct Record {
    float draws = 0.0F;      // when something was last drawn below it; 0: never
    float triangles = 0.0F;  // likewise
    float now_draws = 0.0F;  // in this frame
    float now_triangles = 0.0F;
    float all_draws = 0.0F;  // nodes of level 0 below it
    float all_triangles = 0.0F;
  };
  void add_up_level_0(const FrameScene& scene);

  PerNode<Record> records_;
  std::vector<NodeRef> visited_;  // in this frame
};

// How often nodes turn out hidden when they are asked about, by what the model of cover says of them.

// The model of Guthe and others 2006 takes what is drawn for rectangles at random places. Real scenes are a row of
// houses or an engine under its hood, so its probabilities are used for order only: nodes of about the same probability
// share a rate, which answers correct.
class HidingRates {
 public:
  void begin_frame();
  // A node that was visible when it was asked about last, `frames` ago.
  void note_visible(double cover_probability, double frames, bool hidden);
  // A node of which nothing was known.
  void note_new(double cover_probability, bool hidden);

  // How probable it is that a visible node is hidden in the next frame.
  [[nodiscard]] double of_visible(double cover_probability) const;
  // How probable it is that a node of which nothing is known is hidden.
  [[nodiscard]] double of_new(double cover_probability) const;

 private:
  static constexpr std::size_t classes = 8;
  struct Count {
    double hidden = 0.0;
    double all = 0.0;
  };
  [[nodiscard]] static std::size_t class_of(double cover_probability);

  std::array<Count, classes> visible_;  // all: frames
  std::array<Count, classes> new_;      // all: nodes
};

// Which hidden nodes are asked about in one query: the multi-queries of CHC++ (Mattausch and others 2008, sec. 5.2).

class HiddenGroups {
 public:
  void begin_frame(const FrameScene& scene) { hidden_frames_.fit(scene); }
  void note_answer(NodeRef n, bool visible) { hidden_frames_[n] = visible ? 0 : hidden_frames_[n] + 1; }

  // The largest V = m / (1 + p_fail m), greedily; first those that are most likely to stay hidden. They go to the
  // front; returns their number.
  [[nodiscard]] std::size_t group(std::span<NodeRef> hidden) const;

 private:
  PerNode<std::uint32_t> hidden_frames_;
};

}  // namespace occlod::hlod
