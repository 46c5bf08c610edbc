// The image that HLODs are drawn into, and how it is read.
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
#include "gl/proxy_stage.h"
#include "hlod/draw/box_proxy.h"
#include "occlod/device.h"
#include "occlod/gl.h"
#include "occlod/item_buffer.h"
#include "occlod/picture.h"
#include "occlod/view.h"

namespace occlod::gl {

// Colours of 8 bits and depths of 32, with one or several samples a pixel.
class HlodTarget {
 public:
  // Throws Error when the driver has fewer samples.
  HlodTarget(const Functions& gl, int samples);
  // Makes it what is drawn into, of the view's size and empty: alpha is 0 where nothing is drawn. Throws Error for a
  // size that the driver cannot hold.
  void begin(const View& view);
  // What has been drawn, before the background of shade(). Drawing may go on.
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
  std::optional<Storage> resolved_;  // with several samples
  Camera camera_;
  int width_ = 0;  // of the storage
  int height_ = 0;
};

// Nodes of HLODs and proxies of boxes, drawn by turns into one image: what the device `gl` does without queries.

// Lives in a context that is current in every call. Everything that draws depend on is set in begin_frame() and after
// it, so that others may have used the context since the last frame. Where OpenGL can draw many nodes by one call,
// draws are gathered until submit() is called, by others or by whatever depends on what they draw.
class HlodStage {
 public:
  HlodStage(const Functions& gl, const HlodDeviceOptions& options, const HlodDeviceCalls& calls);
  HlodStage(const HlodStage&) = delete;
  HlodStage& operator=(const HlodStage&) = delete;

  void begin_frame(const View& view, std::span<const hlod::PlacedHlod> objects);
  void draw(const hlod::NodeDraw& draw);
  // Gives OpenGL the draws that are gathered.
  void submit();
  // What is drawn in place of a box; see project_box().
  [[nodiscard]] BoxProxy project(const hlod::BoxRef& box) const;
  // The most pixels of the image that a proxy which is to be drawn can cover.
  [[nodiscard]] std::uint32_t max_pixels(const BoxProxy& proxy) const;
  // To be called after draw() and before draw_proxy(). Submits.
  void start_proxies();
  void draw_proxy(const BoxProxy& proxy);
  // Whether mark_proxies() may be called.
  [[nodiscard]] bool can_mark() const noexcept { return marks_.has_value(); }
  // Of a proxy that is to be drawn: from the unit cube to clip space.
  [[nodiscard]] static glm::mat4 unit_to_clip(const BoxProxy& proxy);
  // Draws all of them by one call; each adds the pixels of it that pass to its word. Submits.
  void mark_proxies(const MarkedProxies& proxies, const Buffer& words);

  // Of the image.
  [[nodiscard]] std::uint32_t pixels() const;
  [[nodiscard]] std::uint32_t samples_per_pixel() const { return static_cast<std::uint32_t>(target_.samples()); }
  // Of all draws so far.
  [[nodiscard]] Image read_image();
  [[nodiscard]] DepthBuffer read_depth();
  // Since begin_frame().
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
  std::optional<GatheredDraws> gathered_;  // where many nodes may be drawn by one call
  std::optional<ProxyMarks> marks_;        // where many boxes may

  Screen screen_;
  std::vector<Object> objects_;
  Mode mode_ = Mode::nothing;
  std::uint32_t object_ = no_id;  // whose uniforms are set
  CallCounts calls_;
  std::vector<GLsizei> counts_;  // of one draw call
  std::vector<const void*> first_indices_;
  std::vector<GLint> base_vertices_;
};

}  // namespace occlod::gl
