// An OpenGL context without a window, on whatever the machine offers.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "occlod/device.h"
#include "occlod/item_buffer.h"
#include "occlod/picture.h"
#include "occlod/visibility.h"

namespace occlod::gl {

struct Functions;

// Where a context comes from.
enum class Platform {
  egl,     // surfaceless, else a device; a GPU where there is one, unless LIBGL_ALWAYS_SOFTWARE is set; else llvmpipe
  osmesa,  // Mesa's off-screen library, opened at run time; always on the CPU
};

// An OpenGL core context of version 3.3 or newer: the newest that the driver has, up to 4.6. Several may live in one
// process. Create, use and destroy it on one thread; what uses it calls make_current() first and destroys its own
// objects before the context.
//
// Where the driver supports it, the context is lost when the GPU is reset. What uses it then throws Error that says so
// at its next view, occluder or batch of answers. Destroy it and everything that uses it; new ones work, and so does
// software occlusion.
class Context {
 public:
  Context(const Context&) = delete;
  Context(Context&&) = delete;
  Context& operator=(const Context&) = delete;
  Context& operator=(Context&&) = delete;
  virtual ~Context() = default;

  // Returns the OpenGL entry points that the backends use; theirs alone.
  [[nodiscard]] virtual const Functions& functions() const noexcept = 0;
  // Returns "egl-surfaceless", "egl-device" or "osmesa".
  [[nodiscard]] virtual std::string_view platform_name() const noexcept = 0;
  // Returns GL_RENDERER, e.g. "llvmpipe (LLVM 15.0.6, 256 bits)".
  [[nodiscard]] virtual std::string renderer() const = 0;
  // Returns GL_VERSION.
  [[nodiscard]] virtual std::string version() const = 0;
  // Makes the context current, which is cheap when it is already. Throws Error when another thread holds it.
  virtual void make_current() = 0;

 protected:
  Context() = default;
};

// Creates a context, which is current on return. Throws Error that says which library or extension is missing and what
// to install. The first call sets the environment variable LP_NUM_THREADS to 0 for this process, unless it is set:
// Mesa's llvmpipe then draws on the calling thread, where a query that is waited for takes 14 instead of 85 us. Other
// drivers do not read it. Like every setenv, not to be raced with getenv on other threads.
[[nodiscard]] std::unique_ptr<Context> create_context(Platform platform);
// Creates one by EGL, else by OSMesa; throws the reasons of both.
[[nodiscard]] std::unique_ptr<Context> create_any_context();

// The backend `gl-query`: OpenGL occlusion queries in flights, as in Birkholz & Rahn, sec. 3.1 and 3.3.

// Draws both sides of the occluder into a depth target of the view's size and asks with proxy volumes: boxes of 12
// triangles (for PointHull too), spheres of 32 and cylinders of 64, each circumscribed and enlarged by 3/4 pixel so
// that a bound is never missed between two samples. Refinement keeps 32 queries under way. Answered visible without a
// query: bounds that are not finite or inside out, whose proxy reaches the near plane, or whose image is larger than
// the screen in both directions or more than eight times as large in one. Answered hidden without a query: bounds off
// the screen.
//
// Between begin_view() and the last collect() the context belongs to this backend, which does not restore the state
// that it sets. Throws Error for no context; collect() when the driver has not answered after 10 s; begin_view(),
// draw_occluder() and the collect() after which no query is under way when OpenGL reports an error.
[[nodiscard]] std::unique_ptr<Visibility> make_query_occlusion(std::shared_ptr<Context> context);

// The device `gl`: draws HLODs by OpenGL and asks it by occlusion queries.

// How the device `gl` draws.
struct HlodDeviceOptions {
  // Four samples a pixel and a dear fragment shader (eight more lights with highlights) instead of one sample and a
  // plain one: a renderer whose fragments cost.
  bool quality = false;
  // The most that meshes of nodes may occupy in OpenGL's memory, bytes, > 0: 28 for each vertex and 6 for each
  // triangle.
  std::size_t mesh_bytes = std::size_t{256} << 20;
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
  // Reads the picture drawn since begin_frame(): flat two-sided shading with the lights and the background of shade(),
  // vertex colours where there are any. Waits for the drawing. Throws Error when OpenGL reports one.
  [[nodiscard]] virtual Image read_image() = 0;
  // Reads its depths likewise; one of the samples of each pixel with `quality`.
  [[nodiscard]] virtual DepthBuffer read_depth() = 0;
  // Returns counts of the cache of meshes.
  [[nodiscard]] virtual MeshMemory mesh_memory() const noexcept = 0;
  // Returns counts since begin_frame().
  [[nodiscard]] virtual CallCounts calls() const noexcept = 0;
  // Tells whether gpu_ms and starve_ms are measured: not on drivers without timer queries, nor on those that draw on
  // the CPU, whose timers tell nothing of use. They are 0 then.
  [[nodiscard]] virtual bool measures_gpu() const noexcept = 0;
};

// Draws into an image of its own, of the view's size, many nodes and boxes by one call where OpenGL can; surfaces are
// clipped at the far plane. Meshes are uploaded when they are first drawn, again for each number of splits within a
// node, and those leave that were drawn longest ago. A count is that of GL_SAMPLES_PASSED around the grown boxes, or
// the same by additions in a shader; with several samples a pixel it is divided by their number and rounded up. It is
// at most the pixels of the boxes' screen rectangles.
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
