// The device `gl`: draws HLODs by OpenGL and asks it by occlusion queries.
#pragma once

#include <cstddef>
#include <memory>

#include "occlod/device/device.h"
#include "occlod/gl/context.h"
#include "occlod/picture/picture.h"
#include "occlod/raster/item_buffer.h"

namespace occlod::gl {

// How the device `gl` draws.
struct HlodDeviceOptions {
  // Four samples a pixel and a dear fragment shader (eight more lights with highlights) instead of one sample and a
  // plain one: a renderer whose fragments cost.
  bool quality = false;
  // The most that meshes of nodes may occupy in OpenGL's memory, bytes, > 0: 28 for each vertex and 6 for each
  // triangle.
  std::size_t mesh_bytes = std::size_t{256} << 20;
  // Nodes that are drawn one after the other, without a question in between, are given to OpenGL by one call for each
  // object and buffer of meshes, where the context has OpenGL 4.3, or ARB_multi_draw_indirect and ARB_base_instance.
  // The depths and counts are the same, and so is the picture but for equal depths.
  bool indirect = true;
  // The boxes of ask_each() are drawn by one call, and each counts its pixels in a word of a storage buffer, where the
  // context has OpenGL 4.3; not with `quality`. The counts are the same as by a query for each.
  bool marks = true;
};

// What the device holds of meshes and has done about them.
struct MeshMemory {
  std::size_t nodes = 0;      // held now
  std::size_t bytes = 0;      // that they occupy, at most HlodDeviceOptions::mesh_bytes
  std::size_t uploads = 0;    // of nodes, since the device was made
  std::size_t evictions = 0;  // of nodes that made room for others, since then
};

// How a frame was given to OpenGL.
struct CallCounts {
  std::size_t draws = 0;       // calls of draw()
  std::size_t draw_calls = 0;  // of OpenGL that drew them; draws that are still gathered are not among these
  std::size_t boxes = 0;       // that were drawn to answer questions
  std::size_t box_calls = 0;   // of OpenGL that drew them
};

// A device whose picture can be read back.
class HlodDevice : public hlod::RenderDevice {
 public:
  // The picture drawn since begin_frame(): flat two-sided shading with the lights and the background of shade(),
  // vertex colours where there are any. Waits for the drawing. Throws Error when OpenGL reports one.
  [[nodiscard]] virtual Image read_image() = 0;
  // Its depths; one of the samples of each pixel with `quality`. Likewise.
  [[nodiscard]] virtual DepthBuffer read_depth() = 0;
  // Counts of the cache of meshes.
  [[nodiscard]] virtual MeshMemory mesh_memory() const noexcept = 0;
  // Counts since begin_frame().
  [[nodiscard]] virtual CallCounts calls() const noexcept = 0;
  // Whether gpu_ms and starve_ms are measured: not on drivers without timer queries, nor on those that draw on the CPU,
  // whose timers tell nothing of use. They are 0 then.
  [[nodiscard]] virtual bool measures_gpu() const noexcept = 0;
};

// Draws into an image of its own, of the view's size; surfaces are clipped at the far plane. Meshes are uploaded when
// they are first drawn, again for each number of splits within a node, and those leave that were drawn longest ago. A
// count is that of GL_SAMPLES_PASSED around the grown boxes, or the same by additions in a shader; with several samples
// a pixel it is divided by their number and rounded up. It is at most the pixels of the boxes' screen rectangles.
//
// frame_ms is by the clock, until all commands are done; cpu_ms until all are given. gpu_ms is from the first to the
// last command between two waits, added up, by timer queries; starve_ms what lies between, within the frame.
//
// Between begin_frame() and end_frame() the context belongs to the device, which does not restore the state that it
// sets. Throws Error for no context, no mesh_bytes, or fewer than four samples with `quality`; begin_frame() for a
// placement that is not affine or cannot be inverted, an image that the driver cannot hold, or a mesh larger than
// mesh_bytes; draw() for a damaged mesh in a mapped file; begin_frame(), wait() and end_frame() when OpenGL reports an
// error or the context is lost; wait() and end_frame() when the driver has not answered after 10 s.
[[nodiscard]] std::unique_ptr<HlodDevice> make_hlod_device(std::shared_ptr<Context> context,
                                                           const HlodDeviceOptions& options = {});

}  // namespace occlod::gl
