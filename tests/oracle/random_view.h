// Random views of generated scenes, and bounds among what is in them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <string>
#include <vector>

#include "occlod/mesh.h"
#include "oracle/random_shapes.h"
#include "oracle/ray_oracle.h"

namespace occlod::test {

enum class SceneKind { planet, pipes, city, spheres_behind_wall, soup };
inline constexpr std::array<SceneKind, 5> scene_kinds{SceneKind::planet, SceneKind::pipes, SceneKind::city,
                                                      SceneKind::spheres_behind_wall, SceneKind::soup};
[[nodiscard]] std::string label(SceneKind kind);
// A few thousand triangles; the soup is of 60 that reach through each other.
[[nodiscard]] TriangleMesh scene_mesh(SceneKind kind);

// A camera that looks at the mesh from far away, close to its surface, or from among it; wide and narrow.
[[nodiscard]] Camera random_camera(const TriangleMesh& mesh, RandomShapes& random);

// Two objects: 0 is where bounds are asked about, 1 is the mesh, both under transforms of their own.
class RandomView {
 public:
  RandomView(const TriangleMesh& mesh, RandomShapes& random);

  [[nodiscard]] const View& view() const { return view_; }
  [[nodiscard]] const std::vector<ObjectView>& objects() const { return objects_; }
  [[nodiscard]] OccluderPart occluder() const { return {1, mesh_->positions, mesh_->triangles}; }
  [[nodiscard]] const RayOracle& rays() const { return rays_; }

  // From a twentieth of a pixel to larger than the screen; a third of them touch the occluder, most others are in front
  // of it or behind it at their middle.
  [[nodiscard]] VisibilityQuery next_bound();

 private:
  [[nodiscard]] double random_depth(const glm::dvec2& pixel);

  const TriangleMesh* mesh_;
  RandomShapes& random_;
  std::vector<glm::dmat4> placements_;
  View view_;
  std::vector<ObjectView> objects_;
  RayOracle rays_;
};

}  // namespace occlod::test
