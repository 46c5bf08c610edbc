// Many proxies drawn by one call for each shape, each of which marks or counts in a word of a storage buffer what of it
// passes the depth test.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gl/objects.h"
#include "gl/proxies.h"
#include "gl/proxy_buffer.h"

namespace occlod::gl {

// What a word says in the end, if it was 0.
enum class Marking {
  visible,  // 1 if anything of the proxy passed
  pixels,   // how many passed; of an image with one sample a pixel
};

// A proxy to be drawn, as the shaders read it.
struct MarkedProxy {
  glm::mat4 unit_to_clip{1.0F};  // front faces are counter-clockwise
  std::uint32_t word = 0;        // of the storage buffer
};
static_assert(sizeof(MarkedProxy) == 68);

using MarkedProxies = std::array<std::vector<MarkedProxy>, proxy_shape_count>;  // by shape

// Lives in a context of OpenGL 4.3 that is current in every call.
class ProxyMarks {
 public:
  ProxyMarks(const Functions& gl, Marking marking);
  // Into a buffer that has room for all their words. The state is that of set_proxy_state(). Whoever reads the words
  // does so behind a barrier.
  void draw(const MarkedProxies& proxies, const Buffer& words) const;

 private:
  void upload(const MarkedProxies& proxies) const;

  const Functions* gl_;
  Program program_;
  ProxyBuffer proxies_;
  Buffer instances_;
};

}  // namespace occlod::gl
