// Reduces one mesh, to one number of triangles after another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/mesh.h"
#include "occlod/simplify.h"
#include "splits/simplify.h"

namespace occlod {

// Keeps the mesh in spatial order. The options must outlive it.
class Reducer {
 public:
  // Throws Error for options out of their ranges and for meshes that build_hierarchy() refuses.
  Reducer(const TriangleMesh& mesh, const SimplifyOptions& options);

  [[nodiscard]] const TriangleMesh& ordered_mesh() const { return mesh_; }
  [[nodiscard]] unsigned threads() const { return threads_; }
  // Vertices that `locked` marks, if it is not empty, stay as they are.
  [[nodiscard]] TriangleMesh reduced(std::size_t max_triangles, std::span<const std::uint8_t> locked,
                                     const std::function<bool(double)>& progress) const;

 private:
  [[nodiscard]] std::vector<glm::vec3> refitted(const ReducedFaces& reduced, std::span<const Triangle> wedges,
                                                std::span<const std::uint8_t> locked) const;

  const SimplifyOptions& options_;
  unsigned threads_;
  TriangleMesh mesh_;
  std::vector<MaterialId> materials_;
};

}  // namespace occlod
