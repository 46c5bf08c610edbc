#include "splits/quadric_minima.h"

#include <cstdint>

namespace occlod {

std::vector<glm::vec3> quadric_minima(SimplifyState& state, std::span<const VertexId> left,
                                      std::span<const VertexId> target, std::span<const Triangle> faces) {
  constexpr float rounding = 1.001F;
  std::vector<glm::vec3> result(target.size(), glm::vec3(0.0F));
  std::vector<std::uint8_t> is_mixed(target.size(), 0);
  bool any = false;
  for (const VertexId v : left) {
    VertexQuadric& quadric = state.vertices[v].quadric;
    const bool is_pure = quadric.xx + quadric.yy + quadric.zz <= rounding * quadric.weight;
    if (is_pure)
      result[v] = quadric.minimum();
    else
      quadric = {}, is_mixed[v] = 1, any = true;
  }
  if (!any) return result;
  for (const Triangle& t : faces)
    if ((is_mixed[target[t.x]] | is_mixed[target[t.y]] | is_mixed[target[t.z]]) != 0)
      for (int k = 0; k < 3; ++k)
        if (is_mixed[target[t[k]]] != 0) state.add_plane_of(t, target[t[k]]);
  for (const VertexId v : left)
    if (is_mixed[v] != 0) result[v] = state.vertices[v].quadric.minimum();
  return result;
}

}  // namespace occlod
