// The three proxies in one static buffer.
#pragma once

#include <array>
#include <cstddef>

#include "gl/objects.h"
#include "gl/proxies.h"

namespace occlod::gl {

class ProxyBuffer {
 public:
  struct Part {
    GLsizei count = 0;       // indices, GL_UNSIGNED_SHORT
    std::size_t offset = 0;  // bytes
    // As OpenGL takes it: the offset into the bound buffer as a pointer.
    [[nodiscard]] const void* pointer() const noexcept {
      return reinterpret_cast<const void*>(offset);  // NOLINT(performance-no-int-to-ptr)
    }
  };

  explicit ProxyBuffer(const Functions& gl);
  // Binds the vertex array: positions at location 0.
  void bind(const Functions& gl) const { gl.BindVertexArray(array_.id()); }
  [[nodiscard]] const Part& part(ProxyShape shape) const { return parts_[static_cast<std::size_t>(shape)]; }

 private:
  VertexArray array_;
  Buffer vertices_;
  Buffer indices_;
  std::array<Part, proxy_shape_count> parts_;
};

}  // namespace occlod::gl
