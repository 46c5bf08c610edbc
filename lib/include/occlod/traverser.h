// How much of a node's error counts when only part of the node is visible.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "occlod/device.h"
#include "occlod/device_costs.h"

namespace occlod::hlod {

// Charalambos and others 2007, sec. 3.2: a blend of mu itself and a sigmoid with its turning point at t. The paper
// prints no formula; this is the simplest smooth one with the properties that it names (docs/internals/hlod.md).
struct Bias {
  double s = 1.0;  // share of the sigmoid, in [0, 1]; 0: mu itself, as in Charalambos 2006
  double t = 0.3;  // turning point, in [0, 1]: below it errors count less than by mu, above it more

  // Returns the share of the error that counts, for mu: visible pixels of a node's box over all pixels that it covers,
  // clamped to [0, 1]. In [0, 1], monotone; 0 at 0, 1 at 1.
  [[nodiscard]] double operator()(double mu) const noexcept;

  friend bool operator==(const Bias&, const Bias&) = default;
};

// Chooses and draws the nodes of HLODs for a view, front to back, refined and culled by occlusion queries.

// Which nodes are drawn, and which queries decide it.
enum class Strategy {
  vfc,        // all inside the frustum, by screen-space error; no queries
  coh,        // Charalambos and others 2007: refining, stopping or delaying predicted from the last frame
  nohc,       // Guthe and others 2006: asks about nodes on any level, where cost and benefit say so
  batch,      // ours: predicted as by coh, asked together in at most three rounds, and only where that pays
  automatic,  // ours: batch or vfc, whichever is found to take less; the other is tried now and then
};

// Tells whether a strategy decides by TraverseOptions::costs: all but vfc and coh.
[[nodiscard]] bool needs_costs(Strategy strategy) noexcept;

// How a frame is traversed.
struct TraverseOptions {
  Strategy strategy = Strategy::coh;  // a change forgets what was visible
  double tolerance_px = 1.0;          // >= 0; 0: the input itself
  Bias bias = {};                     // of coh, batch and automatic
  bool geomorph = false;  // vertices slide to the parent's while its error goes from twice tolerance_px to tolerance_px
  // Of HLODs with splits: a node whose error is too large, but whose children's is not, is refined within, to the error
  // that covers tolerance_px, instead of being replaced by children that are better than asked for (Charalambos 2006,
  // sec. 4.4; build_hlod.h). Not with geomorph.
  bool within = false;
  DeviceCosts costs = {};  // of the device that is drawn on, where needs_costs(): measure_costs()
  // Of HLODs with a store (node_store.h): what the camera would see after so many more frames like the last is asked
  // for when nothing is missing, and so are the siblings of what is drawn. At 60 frames a second, a quarter of a
  // second. In [0, 1000]; 0: nothing is asked for before it is needed.
  int prefetch_frames = 15;

  friend bool operator==(const TraverseOptions&, const TraverseOptions&) = default;
};

// What a strategy is expected to take.
struct StrategyForecast {
  Strategy strategy = Strategy::vfc;  // which one
  double frame_ms = 0.0;              // by counts of the last frames that it drew, and TraverseOptions::costs
  std::uint32_t age = 0;              // frames since then
};

// A draw as it was made.
struct DrawnNode {
  std::uint32_t object = 0;       // index into the objects
  NodeId node = 0;                // of that object's HLOD
  std::uint32_t first_range = 0;  // into Frame::ranges
  std::uint32_t range_count = 0;  // 0 with `cut`
  // By which its error was multiplied for what was visible of it, as far as the frame knows in the end; 1 where nobody
  // asked or everything counts in full.
  float bias = 1.0F;
  // If not empty, the node refined within: see NodeDraw. Valid as long as the frame.
  std::span<const std::uint16_t> cut = {};
  std::uint32_t splits = 0;  // of the cut
  // What became of the node in this frame:
  bool asked = false;    // it was asked about; false: drawn without a question of its own
  bool delayed = false;  // drawn only when its answer came
  bool blocked = false;  // it was to be refined, and a parent was drawn
  bool refined = false;  // after it had been drawn, so that what is below it was drawn over it
};

// What came of asking about a node.
enum class Answer : std::uint8_t {
  unread,   // a coarser node was hidden, or it came too late
  hidden,   // nothing of the node is visible
  visible,  // and that decided something
  wasted,   // visible, and nothing was decided by it
};

// A node that was asked about.
struct NodeAnswer {
  std::uint32_t object = 0;        // index into the objects
  NodeId node = 0;                 // of that object's HLOD
  Answer answer = Answer::unread;  // as far as the frame knows in the end
};

// Counts of one frame.
struct FrameStats {
  std::size_t visits = 0;           // nodes taken from the queue and inside the frustum
  std::size_t drawn_nodes = 0;      // DN: nodes drawn at least in part
  std::size_t drawn_patches = 0;    // of them, nodes refined within left out
  std::size_t drawn_triangles = 0;  // of them
  std::size_t cut_nodes = 0;        // of drawn_nodes, those refined within
  std::size_t recut_nodes = 0;      // of cut_nodes, those drawn again, finer, when their answer came
  std::size_t rarn = 0;             // of drawn_nodes, those that were refined in the same frame too
  std::size_t delayed = 0;          // of drawn_nodes, those that were drawn only when their answer came
  std::size_t blocked = 0;          // nodes that had to be drawn since one of their parents was not refined
  std::size_t queries = 0;          // boxes asked about
  std::size_t wasted_queries = 0;   // of them, answered visible, and nothing was decided by it
  std::size_t hidden_nodes = 0;     // of the nodes asked about, those answered hidden
  std::size_t waiting_nodes = 0;    // of drawn_nodes, those that a finer one would have been drawn for if it were there
  std::size_t missing = 0;          // nodes whose meshes they wait for, and which may come: see StoreStats
  double largest_sse_px = 0.0;      // the largest screen-space error drawn, without bias
};

// One frame. Valid until the next draw_frame().
struct Frame {
  std::vector<DrawnNode> draws;   // in the order in which they were made
  std::vector<DrawRange> ranges;  // of all draws
  // Each node asked about once, in the order in which they were first reached; nodes that were asked about together may
  // also have cost the queries of their group.
  std::vector<NodeAnswer> asked;
  FrameStats stats;  // what was done
  FrameTimes times;  // what it took on the device
  // The sum of XXH3-64 of each patch or cut drawn: no matter in which order, nor how far morphed.
  std::uint64_t front_hash = 0;
  Strategy strategy = Strategy::vfc;        // that drew it: with `automatic` one of the others
  std::vector<StrategyForecast> forecasts;  // with `automatic`, of those that have been tried
};

struct Trial;

// Remembers from frame to frame what was visible, as long as the strategy stays. One thread at a time.
class Traverser {
 public:
  // Traverses these objects, whose HLODs live as long as the traverser. Throws Error for no objects, a null HLOD, one
  // without nodes, or a placement that is not affine or cannot be inverted.
  explicit Traverser(std::span<const PlacedHlod> objects);
  Traverser(Traverser&&) noexcept;
  Traverser& operator=(Traverser&&) noexcept;
  ~Traverser();

  // Moves an object; what is known of its visibility is kept. Throws Error as the constructor does, and for an index
  // out of range.
  void set_transform(std::size_t object, const glm::dmat4& object_to_world);
  // Forgets what was visible, as before the first frame.
  void reset();

  // Draws one frame. What is drawn depends on the view, the options, answers and on the order in which they become
  // available, and on earlier frames; nodes at equal distance are taken by object, then by id. Throws Error for options
  // out of their range, for a view that is too far from an object, and what the device throws; after that the next
  // frame is like the first. Expected O(nodes visited * log(nodes visited)).
  //
  // Of an HLOD with a store a node is refined only when the meshes of all children that may be inside the frustum are
  // there; until then it is drawn in their place, and they are asked for. So the front is a legal one, and the same as
  // without a store where nothing is missing. The frame is one of the store's, too; several traversers may use one
  // store in turn.
  const Frame& draw_frame(const View& view, RenderDevice& device, const TraverseOptions& options = {});

  // Returns the objects as given, with the transforms as they are now.
  [[nodiscard]] std::span<const PlacedHlod> objects() const noexcept;

  // Varies traversal for comparisons with papers, from the next frame on: bench/papers.
  void set_trial(const Trial& trial);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace occlod::hlod
