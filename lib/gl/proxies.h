// Makes the volumes that are drawn in place of bounds, and decides the cases that need no drawing. Does not call
// OpenGL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "gl/objects.h"
#include "hlod/draw/box_proxy.h"
#include "occlod/visibility.h"

namespace occlod::gl {

inline constexpr std::size_t proxy_shape_count = 3;

// Convex, closed, counter-clockwise seen from outside, and circumscribed: contains the unit ball (32 triangles), the
// cube [-1, 1]^3 (12), or the cylinder of radius 1 around z in [-1, 1] (64). Symmetric about z = 0.
struct ProxyMesh {
  std::vector<glm::vec3> vertices;
  std::vector<std::uint16_t> indices;
};
[[nodiscard]] const ProxyMesh& unit_proxy(ProxyShape shape);

struct ProxyDraw {
  ProxyShape shape = ProxyShape::box;
  glm::mat4 unit_to_clip{1.0F};  // to the target; front faces are counter-clockwise, also for mirrored objects
  std::uint32_t max_pixels = 0;  // pixels of the view that the proxy can cover
};

// Decides one query: draw a proxy, or answer at once.
struct QueryPlan {
  std::optional<ProxyDraw> draw;
  bool visible = true;  // the answer when nothing is drawn
};

// Places a proxy around the bound; returns nothing for bounds that are not finite or are inverted.
[[nodiscard]] std::optional<Placement> place(const VisibilityQuery& query);
[[nodiscard]] QueryPlan plan_query(const Screen& screen, const ProxySpace& space, const VisibilityQuery& query);

// Stores the three proxies in one static buffer.

class ProxyBuffer {
 public:
  struct Part {
    GLsizei count = 0;       // indices, GL_UNSIGNED_SHORT
    std::size_t offset = 0;  // in bytes
    // Returns the offset into the bound buffer as the pointer that OpenGL expects.
    [[nodiscard]] const void* pointer() const noexcept {
      return reinterpret_cast<const void*>(offset);  // NOLINT(performance-no-int-to-ptr)
    }
  };

  explicit ProxyBuffer(const Functions& gl);
  // Binds the vertex array, with positions at location 0.
  void bind(const Functions& gl) const { gl.BindVertexArray(array_.id()); }
  [[nodiscard]] const Part& part(ProxyShape shape) const { return parts_[static_cast<std::size_t>(shape)]; }

 private:
  VertexArray array_;
  Buffer vertices_;
  Buffer indices_;
  std::array<Part, proxy_shape_count> parts_;
};

}  // namespace occlod::gl
