#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "base/arithmetic.h"
#include "base/memory.h"
#include "base/option_checker.h"
#include "base/threads.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "splits/build_progress.h"
#include "splits/build_steps.h"
#include "splits/hierarchy_data.h"
#include "splits/positions.h"
#include "splits/simplify.h"
#include "splits/spatial_order.h"

namespace occlod {
namespace {

constexpr const char* clean_it = "run clean() on the mesh first";

[[noreturn]] void fail(const std::string& place, const std::string& problem) {
  throw Error({"mesh", place, problem, clean_it});
}

void check_sizes(const TriangleMesh& mesh) {
  const auto check = [&](std::size_t size, std::size_t wanted, const char* what) {
    if (size != 0 && size != wanted)
      fail("", "has " + std::to_string(size) + " " + what + ", not " + std::to_string(wanted));
  };
  if (mesh.extra_wedges.size() > mesh.positions.size()) fail("", "has more extra wedges than positions");
  check(mesh.normals.size(), mesh.wedge_count(), "normals");
  check(mesh.colors.size(), mesh.wedge_count(), "colors");
  check(mesh.texture_coordinates.size(), mesh.wedge_count(), "texture coordinates");
  check(mesh.triangle_materials.size(), mesh.triangle_count(), "materials of triangles");
  check(mesh.corners.size(), mesh.triangle_count(), "triangles of wedges");
  if (mesh.corners.empty() && !mesh.extra_wedges.empty()) fail("", "has extra wedges that no triangle uses");
}

// Checks that extra wedges are sorted by vertex and lie at their vertices, and that corners use wedges of their
// vertices, each with only one material.
void check_wedges(const TriangleMesh& mesh) {
  VertexId last = 0;
  for (std::size_t i = 0; i < mesh.extra_wedges.size(); ++i) {
    const VertexId v = mesh.extra_wedges[i];
    if (v >= mesh.vertex_count() || v < last || mesh.positions[mesh.vertex_count() + i] != mesh.positions[v])
      fail("extra wedge " + std::to_string(i), "is out of order or away from its vertex");
    last = v;
  }
  for (std::size_t w = 0; w < mesh.texture_coordinates.size(); ++w)
    if (!std::isfinite(mesh.texture_coordinates[w].x) || !std::isfinite(mesh.texture_coordinates[w].y))
      fail("wedge " + std::to_string(w), "has texture coordinates that are not finite");
  for (std::size_t t = 0; t < mesh.corners.size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (mesh.corners[t][k] >= mesh.wedge_count() || mesh.vertex_of(mesh.corners[t][k]) != mesh.triangles[t][k])
        fail("triangle " + std::to_string(t), "has a wedge of another vertex");
  std::vector<std::uint32_t> materials(mesh.triangle_materials.empty() ? 0 : mesh.wedge_count(), no_id);
  for (std::size_t t = 0; t < mesh.triangle_materials.size(); ++t) {
    if (mesh.triangle_materials[t] >= mesh.materials.size())
      fail("triangle " + std::to_string(t), "has a material that is not there");
    for (int k = 0; k < 3; ++k) {
      std::uint32_t& material = materials[mesh.wedge_triangles()[t][k]];
      if (material != no_id && material != mesh.triangle_materials[t])
        fail("triangle " + std::to_string(t), "shares a wedge with a triangle of another material");
      material = mesh.triangle_materials[t];
    }
  }
  for (std::size_t m = 0; m < mesh.materials.size(); ++m)
    if (mesh.materials[m].texture_beyond(mesh.textures.size()) != no_texture)
      fail("material " + std::to_string(m), "names a texture that is not there");
}

}  // namespace

void check_input(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw Error({"mesh", "", "has no triangles", "give a mesh with at least one"});
  check_sizes(mesh);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::vec3& p = mesh.positions[v];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw Error({"mesh", "vertex " + std::to_string(v), "is not finite", clean_it});
    if (largest_coordinate(p) > farthest_coordinate)
      throw Error(
          {"mesh", "vertex " + std::to_string(v), "is farther than 1.5e37 from the origin", "scale the mesh down"});
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& corners = mesh.triangles[t];
    const std::size_t n = mesh.vertex_count();
    if (corners.x >= n || corners.y >= n || corners.z >= n || corners.x == corners.y || corners.y == corners.z ||
        corners.z == corners.x)
      throw Error({"mesh", "triangle " + std::to_string(t), "repeats a corner or refers to a vertex that is not there",
                   clean_it});
  }
  check_wedges(mesh);
}

void check_welded(const TriangleMesh& mesh) {
  PositionIds ids(mesh.vertex_count());
  for (VertexId v = 0; v < mesh.vertex_count(); ++v)
    if (const std::uint32_t id = ids.add(mesh.positions[v]); id != v)
      throw Error(
          {"mesh", "vertex " + std::to_string(v), "has the position of vertex " + std::to_string(id), clean_it});
}

namespace {

void check_options(const BuildOptions& options) {
  const OptionChecker check("build");
  check.in_range("boundary_weight", options.boundary_weight, 0.0, 1e6);
  check.in_range("attribute_weight", options.attribute_weight, 0.0, 1e6);
  check.in_range("threads", options.threads, 0, 1024);
}

}  // namespace

Hierarchy build_hierarchy(const TriangleMesh& mesh, const BuildOptions& options) {
  check_options(options);
  check_input(mesh);
  const unsigned threads = thread_count(options.threads);
  const LargeMemoryReuse reuse;
  TriangleMesh ordered = in_spatial_order(mesh, threads);
  CollapseSequence sequence = simplify(ordered, options);
  if (options.error_bound == ErrorBound::measured) measure_errors(ordered, sequence);
  Hierarchy hierarchy = make_hierarchy(bound_subtrees(assemble(ordered, std::move(sequence), threads), threads));
  BuildProgress(options.progress).reach(1.0);
  return hierarchy;
}

}  // namespace occlod
