// What an HLOD is drawn with: a stream of draws and occlusion queries whose answers may come late. Traversal knows
// devices by this interface only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <span>
#include <string_view>

#include "occlod/hlod/hlod.h"
#include "occlod/math/bounds.h"
#include "occlod/view/view.h"

namespace occlod::hlod {

// One HLOD at one place.
struct PlacedHlod {
  const Hlod* hlod = nullptr;       // not null
  glm::dmat4 object_to_world{1.0};  // affine, invertible
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
  // If not empty: the triangles of the node refined within by its first `splits` splits (NodeCut::indices in within.h),
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

  // For reports, e.g. "software".
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;

  // Starts a frame with an empty image; forgets the queries of the last. The span need live only during the call, the
  // HLODs until the next begin_frame().
  virtual void begin_frame(const View& view, std::span<const PlacedHlod> objects) = 0;
  // Draws part of a node.
  virtual void draw(const NodeDraw& draw) = 0;
  // How many pixels of the fronts of these boxes (at least one) pass the depth test: one count for all, the sum of
  // theirs, at most the pixels of the image. Boxes are grown by about a pixel, so that one that holds a visible point
  // is never counted 0. Boxes that cross the near plane, are not finite, inside out or reach farther than 65,536 pixels
  // from the middle of the image count all pixels of the image; those beside it or wholly before the near plane none.
  [[nodiscard]] virtual QueryId ask(std::span<const BoxRef> boxes) = 0;
  // The same with a count for each box, in one batch.
  [[nodiscard]] virtual QueryId ask_each(std::span<const BoxRef> boxes) = 0;
  // Whether wait() would not wait. Never waits itself.
  [[nodiscard]] virtual bool available(QueryId query) = 0;
  // The counts, in pixels. They live until the next call of ask(), ask_each() or begin_frame(). Throws Error when there
  // is no answer after 10 s.
  [[nodiscard]] virtual std::span<const std::uint32_t> wait(QueryId query) = 0;
  // Tells that traversal has looked at so many nodes, which devices with simulated time count.
  virtual void visit(std::size_t nodes) = 0;
  // Finishes all commands. Answers that nobody has read are dropped.
  virtual FrameTimes end_frame() = 0;
};

}  // namespace occlod::hlod
