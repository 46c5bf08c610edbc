// What an HLOD is drawn with: a stream of draws and occlusion queries whose answers may come late. Traversal knows
// devices by this interface only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <memory>
#include <span>
#include <string_view>

#include "occlod/bounds.h"
#include "occlod/device_costs.h"
#include "occlod/hlod.h"
#include "occlod/item_buffer.h"
#include "occlod/view.h"

namespace occlod::hlod {

// One HLOD at one place.
struct PlacedHlod {
  const Hlod* hlod = nullptr;       // not null
  glm::dmat4 object_to_world{1.0};  // of its positions, see positions_to_world(); affine, invertible
  bool two_sided = false;           // back faces are visible too
};

// Consecutive triangles of a node's mesh: one patch or several.
struct DrawRange {
  std::uint32_t first_index = 0;  // into NodeMesh::indices
  std::uint32_t index_count = 0;  // a multiple of 3, > 0
  // How far vertices have gone to where NodeMesh::merged_into says, in [0, 1]: 0 as they are, 1 as in the parent. Where
  // ranges of one node differ, they share only vertices that stay.
  float morph = 0.0F;

  friend bool operator==(const DrawRange&, const DrawRange&) = default;
};

// One draw call. Spans need live only during draw().
struct NodeDraw {
  std::uint32_t object = 0;           // index into the objects of begin_frame
  NodeId node = 0;                    // of that object's HLOD
  std::span<const DrawRange> ranges;  // at least one, ascending; none when `cut` is drawn
  // If not empty: the triangles of the node refined within by its first `splits` splits (NodeCut::indices),
  // three indices each into the positions of Hlod::mesh() and, after them, of Hlod::within(). The same number of splits
  // of a node always comes with the same triangles.
  std::span<const std::uint16_t> cut = {};
  std::uint32_t splits = 0;  // that made `cut`
};

// A box to ask about.
struct BoxRef {
  std::uint32_t object = 0;  // index into the objects of begin_frame
  Box box;                   // object space
};

// A query or a batch of them; of one frame.
using QueryId = std::uint32_t;

// What one frame took, in ms. Devices whose time is simulated give simulated times.
struct FrameTimes {
  double frame_ms = 0.0;   // from begin_frame() to the end of all drawing
  double cpu_ms = 0.0;     // of the calling thread, waiting included
  double gpu_ms = 0.0;     // that the device was busy
  double stall_ms = 0.0;   // that the calling thread waited for answers
  double starve_ms = 0.0;  // that the device had nothing to do between its first and its last command

  friend bool operator==(const FrameTimes&, const FrameTimes&) = default;
};

// A device. Commands take effect in the order in which they are given: a query counts against all draws before it and
// none after it. Both sides of triangles are drawn. One frame at a time, on one thread.
class RenderDevice {
 public:
  RenderDevice() = default;
  RenderDevice(const RenderDevice&) = delete;
  RenderDevice& operator=(const RenderDevice&) = delete;
  virtual ~RenderDevice() = default;

  // Returns the name for reports, e.g. "software".
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;

  // Starts a frame with an empty image; forgets the queries of the last. The span need live only during the call, the
  // HLODs until the next begin_frame().
  virtual void begin_frame(const View& view, std::span<const PlacedHlod> objects) = 0;
  // Draws part of a node.
  virtual void draw(const NodeDraw& draw) = 0;
  // Asks how many pixels of the fronts of these boxes (at least one) pass the depth test: one count for all, the sum of
  // theirs, at most the pixels of the image. Boxes are grown by about a pixel, so that one that holds a visible point
  // is never counted 0. Boxes that cross the near plane, are not finite, inside out or reach farther than 65,536 pixels
  // from the middle of the image count all pixels of the image; those beside it or wholly before the near plane none.
  [[nodiscard]] virtual QueryId ask(std::span<const BoxRef> boxes) = 0;
  // Asks the same with a count for each box, in one batch.
  [[nodiscard]] virtual QueryId ask_each(std::span<const BoxRef> boxes) = 0;
  // Tells whether wait() would not wait. Never waits itself.
  [[nodiscard]] virtual bool available(QueryId query) = 0;
  // Waits for the counts, in pixels. They live until the next call of ask(), ask_each() or begin_frame(). Throws Error
  // when there is no answer after 10 s.
  [[nodiscard]] virtual std::span<const std::uint32_t> wait(QueryId query) = 0;
  // Tells that traversal has looked at so many nodes, which devices with simulated time count.
  virtual void visit(std::size_t nodes) = 0;
  // Finishes all commands. Answers that nobody has read are dropped.
  virtual FrameTimes end_frame() = 0;
};

// The device `software`: our rasteriser, with exact counts at once. The picture and the truth for every other device.

// What has been done since begin_frame().
struct DeviceWork {
  std::uint64_t draws = 0;            // calls of draw()
  std::uint64_t triangles = 0;        // of them
  std::uint64_t fragments = 0;        // pixels covered, those of each triangle, whether they pass the depth test or not
  std::uint64_t boxes = 0;            // asked about
  std::uint64_t drawn_boxes = 0;      // of them, those that had to be drawn: others count all pixels or none
  std::uint64_t query_fragments = 0;  // pixels that the fronts of these cover, passing or not
};

// Draws at the resolution of the view with one sample at the middle of each pixel, in double precision up to the pixel.
// Every box is counted at once, each of its pixels once: available() is always true, wait() never waits. The same bits
// on every machine. end_frame() gives the times that this has really taken; the device is busy when it draws and asks,
// the calling thread always.
class SoftwareDevice final : public RenderDevice {
 public:
  // `keep_items`: keeps which triangle owns each pixel, for items(); drawing then takes about twice as long. Allocates
  // nothing before the first frame.
  explicit SoftwareDevice(bool keep_items = false);
  ~SoftwareDevice() override;

  // Grows the boxes that are asked about by further pixels, >= 0, from the next frame on.
  void set_slack(double pixels) noexcept;

  [[nodiscard]] std::string_view name() const noexcept override;
  void begin_frame(const View& view, std::span<const PlacedHlod> objects) override;
  void draw(const NodeDraw& draw) override;
  [[nodiscard]] QueryId ask(std::span<const BoxRef> boxes) override;
  [[nodiscard]] QueryId ask_each(std::span<const BoxRef> boxes) override;
  [[nodiscard]] bool available(QueryId query) override;
  [[nodiscard]] std::span<const std::uint32_t> wait(QueryId query) override;
  void visit(std::size_t nodes) override;
  FrameTimes end_frame() override;

  // Returns what was done in this frame, or the last where it has ended.
  [[nodiscard]] const DeviceWork& work() const noexcept;
  // Copies what is drawn, or has been where the frame has ended. O(pixels).
  [[nodiscard]] DepthBuffer depth() const;
  // Returns what is drawn likewise, of a device that keeps items. Triangle i of the frame's k-th draw is item i + the
  // triangles of the draws before it, in the order of the ranges.
  [[nodiscard]] const ItemBuffer& items() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

// Measures what the commands of a device cost: Guthe, Balazs and Klein 2006, sec. 3.2.2.

// Draws a mesh of 64,800 triangles and one of two, a pixel large or filling an image of 512 x 512, and asks about boxes
// of both sizes, in frames of few and of many commands; what the latter take more, by FrameTimes::frame_ms, is what the
// commands cost. Medians of nine rounds, at least 0.001 ns; of 1,000 single queries that are waited for, on an empty
// pipeline, what is left after the slowest thousandth has been dropped gives readback_ns. submit_ns and visit_ns come
// from FrameTimes::cpu_ms. latency_commands, which nothing tells, is 0. About a second; exact on simulated devices.
// Throws what the device throws.
[[nodiscard]] DeviceCosts measure_costs(RenderDevice& device);

}  // namespace occlod::hlod
