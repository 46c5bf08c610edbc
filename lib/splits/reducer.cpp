#include "splits/reducer.h"

#include "base/memory.h"
#include "base/option_checker.h"
#include "base/threads.h"
#include "splits/attribute_state.h"
#include "splits/build_steps.h"
#include "splits/compact_mesh.h"
#include "splits/refit.h"
#include "splits/spatial_order.h"

namespace occlod {
namespace {

void check(const TriangleMesh& mesh, const SimplifyOptions& options) {
  const OptionChecker checker("simplify");
  checker.in_range("boundary_weight", options.boundary_weight, 0.0, 1e6);
  checker.in_range("attribute_weight", options.attribute_weight, 0.0, 1e6);
  checker.in_range("threads", options.threads, 0, 1024);
  check_input(mesh);
}

// Of a mesh and options that have passed the check.
TriangleMesh checked_in_spatial_order(const TriangleMesh& mesh, const SimplifyOptions& options) {
  check(mesh, options);
  return in_spatial_order(mesh, thread_count(options.threads));
}

// The last tetrahedron of a closed surface collapses to nothing.
[[noreturn]] void refuse(std::size_t triangles, std::size_t most, std::size_t least_possible) {
  throw Error(
      {"mesh", "",
       "has nothing left with at most " + std::to_string(most) + " of its " + std::to_string(triangles) + " triangles",
       "allow more: the fewest are " + std::to_string(least_possible)});
}

}  // namespace

Reducer::Reducer(const TriangleMesh& mesh, const SimplifyOptions& options)
    : options_(options),
      threads_(thread_count(options.threads)),
      mesh_(checked_in_spatial_order(mesh, options)),
      materials_(wedge_materials(mesh_)) {}

std::vector<glm::vec3> Reducer::refitted(const ReducedFaces& reduced, std::span<const Triangle> wedges,
                                         std::span<const std::uint8_t> locked) const {
  const Reduction reduction{std::span(mesh_.positions).first(mesh_.vertex_count()),
                            mesh_.triangles,
                            reduced.target,
                            reduced.faces,
                            reduced.minima,
                            reduced.scale};
  const bool along_normals = !mesh_.texture_coordinates.empty();  // which leaves seams where the texture has them
  std::vector<std::uint8_t> held(mesh_.vertex_count(), 0);
  if (!along_normals) held = on_seams(reduced.faces, wedges, mesh_.vertex_count());
  for (std::size_t v = 0; v < locked.size(); ++v) held[v] |= locked[v];
  return refit(reduction, {.held = held, .along_normals = along_normals}, threads_);
}

TriangleMesh Reducer::reduced(std::size_t max_triangles, std::span<const std::uint8_t> locked,
                              const std::function<bool(double)>& progress) const {
  BuildOptions build;
  build.base_triangles = max_triangles;
  build.boundary_weight = options_.boundary_weight;
  build.attribute_weight = options_.attribute_weight;
  build.threads = options_.threads;
  build.progress = progress;
  const ReducedFaces reduced = reduce(mesh_, build, locked);
  if (reduced.faces.empty() && locked.empty()) refuse(mesh_.triangle_count(), max_triangles, reduced.least_possible);
  const std::vector<Triangle>& wedges = reduced.corners.empty() ? reduced.faces : reduced.corners;
  std::vector<glm::vec3> moved;
  if (options_.refit) moved = refitted(reduced, wedges, locked);
  const WedgeArrays arrays{options_.refit ? moved : mesh_.positions, mesh_.normals, mesh_.colors,
                           mesh_.texture_coordinates};
  TriangleMesh result = compact_mesh(arrays, reduced.faces, wedges, mesh_.vertex_count());
  if (!materials_.empty())
    for (const Triangle& t : wedges) result.triangle_materials.push_back(materials_[t.x]);
  result.materials = mesh_.materials;
  result.textures = mesh_.textures;
  result.texture_origin = mesh_.texture_origin;
  result.origin = mesh_.origin;
  result.up = mesh_.up;
  return result;
}

TriangleMesh simplify(const TriangleMesh& mesh, std::size_t max_triangles, const SimplifyOptions& options) {
  if (max_triangles == 0) throw Error({"simplify", "max_triangles", "is 0", "ask for at least one triangle"});
  const LargeMemoryReuse reuse;
  TriangleMesh result;
  if (mesh.triangle_count() > max_triangles) {
    result = Reducer(mesh, options).reduced(max_triangles, {}, options.progress);
  } else {
    check(mesh, options);
    result = mesh;
  }
  if (options.progress) (void)options.progress(1.0);
  return result;
}

}  // namespace occlod
