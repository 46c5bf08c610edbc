// Manages the image into which HLODs are drawn, and its read-back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gl/backend_options.h"
#include "gl/mesh_arena.h"
#include "gl/objects.h"
#include "gl/programs.h"
#include "gl/proxies.h"
#include "hlod/draw/box_proxy.h"
#include "occlod/device.h"
#include "occlod/gl.h"
#include "occlod/item_buffer.h"
#include "occlod/picture.h"
#include "occlod/view.h"

namespace occlod::gl {

// Stores colours of 8 bits and depths of 32 bits, with one or several samples per pixel.
class HlodTarget {
 public:
  // Throws Error when the driver does not support that many samples.
  HlodTarget(const Functions& gl, int samples);
  // Binds the target for drawing, with the view's size and empty: alpha is 0 where nothing is drawn. Throws Error for a
  // size that the driver does not support.
  void begin(const View& view);
  // Returns what has been drawn, without the background of shade(). Drawing may continue afterwards.
  [[nodiscard]] Image read_image() const;
  [[nodiscard]] DepthBuffer read_depth() const;
  [[nodiscard]] int samples() const noexcept { return samples_; }

 private:
  struct Storage {
    explicit Storage(const Functions& gl) : framebuffer(gl), color(gl), depth(gl) {}
    Framebuffer framebuffer;
    Renderbuffer color;
    Renderbuffer depth;
  };
  void require_size(int width, int height) const;
  void allocate(const Storage& storage, int samples) const;
  void read(GLbitfield what, GLenum format, GLenum type, void* pixels) const;

  const Functions* gl_;
  int samples_;
  Storage drawn_;
  std::optional<Storage> resolved_;  // when there are several samples per pixel
  Camera camera_;
  int width_ = 0;  // of the storage
  int height_ = 0;
};

// What the shaders read of a box that counts its pixels.
struct MarkedBox {
  glm::mat4 unit_to_clip{1.0F};  // front faces are counter-clockwise
  std::uint32_t word = 0;        // index into the storage buffer
};
static_assert(sizeof(MarkedBox) == 68);

// Draws many boxes by one call. Each adds the number of its pixels that pass the depth test to a word of a storage
// buffer, in an image with one sample per pixel. Lives in a context of OpenGL 4.3 that must be current in every call.
class BoxMarks {
 public:
  explicit BoxMarks(const Functions& gl);
  // Draws into a buffer that has room for all words. Requires the state of set_proxy_state(). Readers of the words need
  // a barrier first.
  void draw(std::span<const MarkedBox> boxes, const Buffer& words) const;

 private:
  const Functions* gl_;
  Program program_;
  ProxyBuffer proxies_;
  Buffer instances_;
};

// Draws nodes of HLODs and box proxies alternately into one image: the part of the `gl` device that needs no queries.

// Lives in a context that must be current in every call. begin_frame() and later calls set all state that draws depend
// on, so other code may use the context between frames. Where OpenGL can draw many nodes by one call, draws are
// collected until submit(), which is called from outside or by whatever depends on the drawn result.
class HlodStage {
 public:
  HlodStage(const Functions& gl, const HlodDeviceOptions& options, const HlodDeviceCalls& calls);
  HlodStage(const HlodStage&) = delete;
  HlodStage& operator=(const HlodStage&) = delete;

  void begin_frame(const View& view, std::span<const hlod::PlacedHlod> objects);
  void draw(const hlod::NodeDraw& draw);
  // Submits the collected draws to OpenGL.
  void submit();
  // Returns the proxy that is drawn for a box; see project_box().
  [[nodiscard]] BoxProxy project(const hlod::BoxRef& box) const;
  // Returns the largest number of pixels of the image that a drawn proxy can cover.
  [[nodiscard]] std::uint32_t max_pixels(const BoxProxy& proxy) const;
  // Prepares for proxies; call it after draw() and before draw_proxy(). Submits.
  void start_proxies();
  void draw_proxy(const BoxProxy& proxy);
  // Returns whether mark_boxes() may be called.
  [[nodiscard]] bool can_mark() const noexcept { return marks_.has_value(); }
  // Returns, for a proxy that is drawn, the transform from the unit cube to clip space.
  [[nodiscard]] static glm::mat4 unit_to_clip(const BoxProxy& proxy);
  // Draws all boxes by one call; each adds the number of its pixels that pass the depth test to its word. Submits.
  void mark_boxes(std::span<const MarkedBox> boxes, const Buffer& words);

  // Returns the number of pixels of the image.
  [[nodiscard]] std::uint32_t pixels() const;
  [[nodiscard]] std::uint32_t samples_per_pixel() const { return static_cast<std::uint32_t>(target_.samples()); }
  // Returns the image with all draws so far.
  [[nodiscard]] Image read_image();
  [[nodiscard]] DepthBuffer read_depth();
  // Returns the calls since begin_frame().
  [[nodiscard]] const CallCounts& calls() const noexcept { return calls_; }
  [[nodiscard]] const MeshMemory& mesh_memory() const noexcept { return arena_.memory(); }
  [[nodiscard]] const Functions& gl() const noexcept { return *gl_; }

 private:
  enum class Mode { nothing, nodes, proxies, marks };
  struct Object {
    EyeSpace eye_space;
    ProxySpace proxy_space;
  };

  void set_common_state() const;
  void set_proxy_state();
  void start_nodes(std::uint32_t object);
  void draw_cut(const hlod::NodeDraw& draw);
  void draw_ranges(std::uint32_t object, const ArenaPlace& place, std::span<const hlod::DrawRange> ranges);
  void draw_run(const ArenaPlace& place, std::span<const hlod::DrawRange> ranges);

  const Functions* gl_;
  HlodTarget target_;
  MeshArena arena_;
  NodeProgram nodes_;
  PlainProgram plain_;
  ProxyBuffer proxies_;
  std::optional<GatheredDraws> gathered_;  // if one call can draw many nodes
  std::optional<BoxMarks> marks_;          // if one call can draw many boxes

  Screen screen_;
  std::vector<Object> objects_;
  Mode mode_ = Mode::nothing;
  std::uint32_t object_ = no_id;  // the object whose uniforms are set
  CallCounts calls_;
  std::vector<GLsizei> counts_;  // of one draw call
  std::vector<const void*> first_indices_;
  std::vector<GLint> base_vertices_;
};

}  // namespace occlod::gl
