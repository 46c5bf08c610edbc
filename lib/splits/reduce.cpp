// Implements occlod/simplify.h.
#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.h"
#include "base/option_checker.h"
#include "base/threads.h"
#include "occlod/simplify.h"
#include "splits/attribute_state.h"
#include "splits/build_steps.h"
#include "splits/compact_mesh.h"
#include "splits/refit.h"
#include "splits/simplify.h"
#include "splits/spatial_order.h"

namespace occlod {
namespace {

// Marks the vertices whose corners have several wedges: seams of the texture stay where they are.
std::vector<std::uint8_t> on_seams(std::span<const Triangle> faces, std::span<const Triangle> wedges,
                                   std::size_t vertex_count) {
  std::vector<WedgeId> first(vertex_count, no_id);
  std::vector<std::uint8_t> result(vertex_count, 0);
  for (std::size_t t = 0; t < faces.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      WedgeId& wedge = first[faces[t][k]];
      if (wedge == no_id) wedge = wedges[t][k];
      if (wedge != wedges[t][k]) result[faces[t][k]] = 1;
    }
  return result;
}

TriangleMesh reduced_mesh(const TriangleMesh& mesh, const ReducedFaces& reduced, const SimplifyOptions& options) {
  const std::vector<Triangle>& faces = reduced.faces;
  const std::vector<Triangle>& wedges = reduced.corners.empty() ? faces : reduced.corners;
  std::vector<glm::vec3> positions;
  if (options.refit) {
    const std::vector<std::uint8_t> held = on_seams(faces, wedges, mesh.vertex_count());
    positions = refit({std::span(mesh.positions).first(mesh.vertex_count()), mesh.triangles, reduced.target, faces},
                      held, !mesh.texture_coordinates.empty(), thread_count(options.threads));
  }
  TriangleMesh result =
      compact_mesh({options.refit ? positions : mesh.positions, mesh.normals, mesh.colors, mesh.texture_coordinates},
                   faces, wedges, mesh.vertex_count());
  if (const std::vector<MaterialId> materials = wedge_materials(mesh); !materials.empty())
    for (const Triangle& t : wedges) result.triangle_materials.push_back(materials[t.x]);
  result.materials = mesh.materials;
  result.textures = mesh.textures;
  result.texture_origin = mesh.texture_origin;
  result.origin = mesh.origin;
  result.up = mesh.up;
  return result;
}

}  // namespace

TriangleMesh simplify(const TriangleMesh& mesh, std::size_t max_triangles, const SimplifyOptions& options) {
  const OptionChecker check("simplify");
  check.in_range("boundary_weight", options.boundary_weight, 0.0, 1e6);
  check.in_range("attribute_weight", options.attribute_weight, 0.0, 1e6);
  check.in_range("threads", options.threads, 0, 1024);
  if (max_triangles == 0) throw Error({"simplify", "max_triangles", "is 0", "ask for at least one triangle"});
  check_input(mesh);
  if (mesh.triangle_count() <= max_triangles) return mesh;
  BuildOptions build;
  build.base_triangles = max_triangles;
  build.boundary_weight = options.boundary_weight;
  build.attribute_weight = options.attribute_weight;
  build.threads = options.threads;
  build.progress = options.progress;
  const LargeMemoryReuse reuse;
  const TriangleMesh ordered = in_spatial_order(mesh, thread_count(options.threads));
  TriangleMesh result = reduced_mesh(ordered, reduce(ordered, build), options);
  if (options.progress) (void)options.progress(1.0);
  return result;
}

}  // namespace occlod
