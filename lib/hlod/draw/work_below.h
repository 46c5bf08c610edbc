// What drawing takes of what is below a node.
#pragma once

#include <cstdint>
#include <vector>

#include "hlod/draw/per_node.h"
#include "hlod/draw/query_value.h"

namespace occlod::hlod {

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

}  // namespace occlod::hlod
