#include <algorithm>
#include <vector>

#include "occlod/hierarchy/cut_mesh.h"
#include "occlod/hierarchy/validate.h"
#include "triangle_key.h"

namespace occlod {
bool restores(const Hierarchy& hierarchy, const TriangleMesh& mesh) {
  if (hierarchy.input_triangle_count() != mesh.triangle_count()) return false;
  std::vector<TriangleKey> restored, input;
  restored.reserve(mesh.triangle_count());
  input.reserve(mesh.triangle_count());
  for (const Triangle& t : triangles_of(hierarchy, full_cut(hierarchy)))
    restored.push_back(key_of(t, hierarchy.positions()));
  for (const Triangle& t : mesh.triangles) input.push_back(key_of(t, mesh.positions));
  std::sort(restored.begin(), restored.end());
  std::sort(input.begin(), input.end());
  return restored == input;
}

}  // namespace occlod
