#include "scene/mesh_joiner.h"

#include <fmt/format.h>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <utility>

#include "occlod/core/error.h"

namespace occlod {
namespace {

// Objects without any have (0, 0).
void append_texture_coordinates(TriangleMesh& all, const TriangleMesh& mesh, VertexId first) {
  if (mesh.texture_coordinates.empty()) return;
  all.texture_coordinates.resize(first, glm::vec2(0.0F));
  for (glm::vec2 at : mesh.texture_coordinates) {
    if (mesh.texture_origin != all.texture_origin) at.y = 1.0F - at.y;
    all.texture_coordinates.push_back(at);
  }
}

}  // namespace

void append_placed(TriangleMesh& all, const TriangleMesh& mesh, const glm::dmat4& object_to_world) {
  const auto first = static_cast<VertexId>(all.positions.size());
  for (const glm::vec3& p : mesh.positions) all.positions.emplace_back(object_to_world * glm::dvec4(p, 1.0));
  const glm::dmat3 linear(object_to_world);
  const glm::dmat3 normals_to_world = glm::transpose(glm::inverse(linear));
  for (const glm::vec3& normal : mesh.normals)
    all.normals.emplace_back(glm::normalize(normals_to_world * glm::dvec3(normal)));
  all.colors.insert(all.colors.end(), mesh.colors.begin(), mesh.colors.end());
  append_texture_coordinates(all, mesh, first);
  const bool is_mirrored = glm::determinant(linear) < 0.0;
  for (Triangle t : mesh.wedge_triangles()) {
    if (is_mirrored) std::swap(t.y, t.z);
    all.triangles.push_back(t + first);
  }
}

MeshJoiner::MeshJoiner(std::string name, const std::filesystem::path& folder)
    : name_(std::move(name)), materials_(all_, name_, folder) {}

void MeshJoiner::add(const TriangleMesh& mesh, const glm::dmat4& object_to_world, const std::string& source_name) {
  if (all_.positions.size() + mesh.positions.size() > std::numeric_limits<VertexId>::max())
    throw Error(
        {name_, fmt::format("/objects/{}", count_), "makes 2^32 vertices or more of all objects", "use fewer objects"});
  if (all_.texture_coordinates.empty()) all_.texture_origin = mesh.texture_origin;
  append_placed(all_, mesh, object_to_world);
  materials_.add_triangles(mesh, source_name);
  ++count_;
}

TriangleMesh MeshJoiner::finish() {
  const std::size_t vertices = all_.positions.size();
  if (all_.normals.size() != vertices) all_.normals.clear();
  if (all_.colors.size() != vertices) all_.colors.clear();
  if (!all_.texture_coordinates.empty()) all_.texture_coordinates.resize(vertices, glm::vec2(0.0F));
  materials_.finish();
  return std::move(all_);
}

}  // namespace occlod
