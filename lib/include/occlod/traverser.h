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

// Charalambos and others 2007, sec. 4: a blend of mu itself and a sigmoid with its turning point at t. The paper prints
// no formula; this is the simplest smooth one with the properties that it names (docs/guide/hlod.md).
struct Bias {
  double s = 1.0;  // share of the sigmoid, in [0, 1]; 0: mu itself, as in Charalambos 2006
  double t = 0.3;  // turning point, in [0, 1]: below it errors count less than by mu, above it more

  // mu: visible pixels of a node's box over all pixels that it covers, clamped to [0, 1]. In [0, 1], monotone; 0 at 0,
  // 1 at 1.
  [[nodiscard]] double operator()(double mu) const noexcept;

  friend bool operator==(const Bias&, const Bias&) = default;
};

// Everything visible counts in full: plain screen-space error.
[[nodiscard]] constexpr double no_bias(double mu) noexcept { return mu > 0.0 ? 1.0 : 0.0; }

// How probable it is that a node is hidden before anybody has asked: Guthe, Balazs and Klein, "Near Optimal
// Hierarchical Culling: Performance Driven Use of Hardware Occlusion Queries" (2006), sec. 3.1. Shares are of the
// pixels of the image, in [0, 1].

// How large things look.
struct ImageScale {
  double focal_length_px = 1.0;  // View::focal_length_px()
  double pixels = 1.0;           // of the image, > 0
  bool orthographic = false;     // rays are parallel
};

// c_bb: the share that a box covers, reckoned as a cube with its surface area (square world units) whose face is at
// `distance` from the eye (world units). 1 at a distance of 0.
[[nodiscard]] double box_coverage(double box_area, double distance, const ImageScale& image) noexcept;

// R_cov = 3/2 A / A_bb: what a mesh covers of what its box covers, reckoned as a sphere with the mesh's area. The paper
// words it as the reciprocal. Above 1 where surface lies in several layers. 1 for a box without area.
[[nodiscard]] double coverage_ratio(double mesh_area, double box_area) noexcept;

// c: the share that the mesh covers; a ratio above 1 counts as 1.
[[nodiscard]] double mesh_coverage(double box_share, double ratio) noexcept;

// c_scr after something with this coverage has been drawn as well, placed at random.
[[nodiscard]] double covered_with(double covered, double share) noexcept;

// How probable it is that all of a box is covered, for squares placed at random.
enum class CoverModel {
  printed,    // (sqrt c_scr - sqrt c_bb)^2: boxes may stick out of the image
  corrected,  // ((sqrt c_scr - sqrt c_bb) / (1 - sqrt c_bb))^2: they lie inside it
};

// p_cov: of a box that covers `box_share` behind what covers `covered`. 0 where the box is the larger.
[[nodiscard]] double cover_probability(double covered, double box_share, CoverModel model) noexcept;

// What was known of a node in the last frame.
enum class LastSight {
  visible,
  outside,  // of the frustum, or not reached
  hidden,
};

// p_occl, from p_cov: what was visible has to be hidden for two frames to be worth a query; what was hidden stays so.
[[nodiscard]] double occlusion_probability(double cover_probability, LastSight last) noexcept;

// Chooses and draws the nodes of HLODs for a view, front to back, refined and culled by occlusion queries.

// Which nodes are drawn, and which queries decide it.
enum class Strategy {
  vfc,      // all inside the frustum, by screen-space error; no queries
  sw,       // asks every node and waits, by screen-space error
  sw_b,     // the same by biased error: the fewest nodes, the most waiting
  boolean,  // coherent hierarchical culling (Bittner and others 2004; Gobetti & Marton 2005), by screen-space error
  simp,     // Charalambos 2006: visibility predicted by the place in the queue
  coh,      // Charalambos and others 2007: refining, stopping or delaying predicted from the last frame
  ideal,    // what sw_b draws, known beforehand and drawn without a query: an oracle for comparison
  // Which queries are asked is decided by what they cost (TraverseOptions::costs):
  nohc,       // Guthe and others 2006: nodes on any level, where cost and benefit say so
  optimum,    // what single queries can reach at best: only hidden nodes are asked, where that is cheapest; an oracle
  batch,      // ours: predicted as by coh, asked together in at most three rounds, and only where that pays
  automatic,  // ours: vfc, nohc, coh or batch, by what they are found to cost
  // For comparison:
  chc_plus,  // CHC++, Mattausch and others 2008: hidden nodes in groups, visible ones now and then
  two_pass,  // as GPU-driven engines: what was visible is drawn, the rest tested against it once
  cesium,    // cesium-native's rule: what is hidden is not refined, but drawn
};

// Whether a strategy decides by TraverseOptions::costs.
[[nodiscard]] bool needs_costs(Strategy strategy) noexcept;
// Whether a strategy is told what is hidden by TraverseOptions::oracle.
[[nodiscard]] bool needs_oracle(Strategy strategy) noexcept;

// How the error of a node on the screen is bounded.
enum class Metric {
  box,         // screen_error_px()
  sphere,      // sphere_error_px(), as published
  guaranteed,  // guaranteed_error_px(): a bound, several times the others; nodes are not refined within
};

// How the pixels of a node's box on an empty screen are counted.
enum class Alpha {
  exact,  // area of the box's outline inside the image
  paper,  // Charalambos 2006, sec. 4.3: a cube of the box's volume seen from the front
};

// When coh asks about nodes.
enum class Coherence {
  // When all that is known to be visible has been drawn. A node that may stand for its children again is asked about
  // while these are drawn once more. So nothing is taken for visible that shows only through a hole where something is
  // still to be drawn.
  mended,
  published,  // Charalambos and others 2007: in turn; such a node is drawn when its answer comes, not its children
};

// How a frame is traversed.
struct TraverseOptions {
  Strategy strategy = Strategy::coh;        // a change forgets what was visible
  double tolerance_px = 1.0;                // >= 0; 0: the input itself
  Bias bias;                                // of sw_b, simp, coh, ideal, batch and automatic
  bool biased = true;                       // false: whatever is visible counts in full, with every strategy
  Metric metric = Metric::box;              // of the error that is compared with the tolerance
  Alpha alpha = Alpha::exact;               // how mu is computed for the bias
  Coherence coherence = Coherence::mended;  // of coh
  bool geomorph = false;  // vertices slide to the parent's while its error goes from twice tolerance_px to tolerance_px
  // Of HLODs with splits: a node whose error is too large, but whose children's is not, is refined within, to the error
  // that covers tolerance_px, instead of being replaced by children that are better than asked for (Charalambos 2006,
  // sec. 4.4; within.h). Not with geomorph.
  bool within = false;
  // Of strategies that need it (needs_oracle()): draws and asks as sw_b does, so that it is known what to draw. Not the
  // device that is drawn on; its time is nobody's.
  RenderDevice* oracle = nullptr;
  // Of strategies that need them (needs_costs()): of the device that is drawn on. measure_costs(), or those of a
  // simulated device.
  DeviceCosts costs = {};
  // Of HLODs with a store (node_store.h): what the camera would see after so many more frames like the last is asked
  // for when nothing is missing, and so are the siblings of what is drawn. At 60 frames a second, a quarter of a
  // second. In [0, 1000]; 0: nothing is asked for before it is needed.
  int prefetch_frames = 15;
  // Of nohc and batch. `printed` also means that benefits are spread over log2 of the nodes, as in a binary tree; else
  // over the levels.
  CoverModel cover_model = CoverModel::printed;

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
  // What became of the node in this frame, of `ideal` without what its oracle did:
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

// Remembers from frame to frame what was visible, as long as the strategy stays. One thread at a time.
class Traverser {
 public:
  // The HLODs live as long as the traverser. Throws Error for no objects, a null HLOD, one without nodes, or a
  // placement that is not affine or cannot be inverted.
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

  // As given, with the transforms as they are now.
  [[nodiscard]] std::span<const PlacedHlod> objects() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace occlod::hlod
