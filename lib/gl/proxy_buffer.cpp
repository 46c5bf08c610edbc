#include "gl/proxy_buffer.h"

#include <cstdint>
#include <vector>

namespace occlod::gl {

ProxyBuffer::ProxyBuffer(const Functions& gl) : array_(gl), vertices_(gl), indices_(gl) {
  std::vector<glm::vec3> vertices;
  std::vector<std::uint16_t> indices;
  for (std::size_t i = 0; i < proxy_shape_count; ++i) {
    const ProxyMesh& proxy = unit_proxy(static_cast<ProxyShape>(i));
    parts_[i] = {static_cast<GLsizei>(proxy.indices.size()), indices.size() * sizeof(std::uint16_t)};
    const auto base = static_cast<std::uint16_t>(vertices.size());
    for (const std::uint16_t index : proxy.indices) indices.push_back(static_cast<std::uint16_t>(base + index));
    vertices.insert(vertices.end(), proxy.vertices.begin(), proxy.vertices.end());
  }
  gl.BindVertexArray(array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  gl.EnableVertexAttribArray(0);
  gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  fill(gl, GL_ARRAY_BUFFER, std::span<const glm::vec3>(vertices), GL_STATIC_DRAW);
  fill(gl, GL_ELEMENT_ARRAY_BUFFER, std::span<const std::uint16_t>(indices), GL_STATIC_DRAW);
}

}  // namespace occlod::gl
