// Converts between TriangleMesh and OpenMesh's triangle meshes. Opt-in: include it where OpenMesh is found and linked.
#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Utils/color_cast.hh>
#include <cstddef>
#include <vector>

#include "occlod/mesh.h"

namespace occlod {

// Replaces the content of `out`, a TriMesh_ArrayKernelT. Vertex i becomes vertex handle i. Normals and colours are
// copied where both sides have them (request_vertex_normals(), request_vertex_colors() before), those of a vertex's
// first wedge; merge_wedges() before this gives their mean. Points are positions, relative to mesh.origin. Returns how
// many triangles OpenMesh refused because a half-edge mesh cannot hold them: those with a repeated corner, on a
// non-manifold edge or against the orientation of a neighbour. O(n).
template <class Mesh>
[[nodiscard]] std::size_t to_openmesh(const TriangleMesh& mesh, Mesh& out) {
  using Scalar = typename OpenMesh::vector_traits<typename Mesh::Point>::value_type;
  using NormalScalar = typename OpenMesh::vector_traits<typename Mesh::Normal>::value_type;
  out.clean();
  out.reserve(mesh.vertex_count(), 3 * mesh.vertex_count(), mesh.triangle_count());
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const glm::vec3& p = mesh.positions[v];
    out.add_vertex(typename Mesh::Point(static_cast<Scalar>(p.x), static_cast<Scalar>(p.y), static_cast<Scalar>(p.z)));
  }
  for (const auto vertex : out.vertices()) {
    const auto i = static_cast<std::size_t>(vertex.idx());
    if (out.has_vertex_normals() && !mesh.normals.empty()) {
      const glm::vec3& n = mesh.normals[i];
      out.set_normal(vertex, typename Mesh::Normal(static_cast<NormalScalar>(n.x), static_cast<NormalScalar>(n.y),
                                                   static_cast<NormalScalar>(n.z)));
    }
    if (out.has_vertex_colors() && !mesh.colors.empty()) {
      const glm::u8vec4& c = mesh.colors[i];
      out.set_color(vertex, OpenMesh::color_cast<typename Mesh::Color>(OpenMesh::Vec4uc(c.r, c.g, c.b, c.a)));
    }
  }
  std::size_t refused = 0;
  const auto handle = [&](VertexId v) { return out.vertex_handle(v); };
  for (const Triangle& t : mesh.triangles) {
    const bool repeated = t.x == t.y || t.y == t.z || t.z == t.x;
    refused += repeated || !out.add_face(handle(t.x), handle(t.y), handle(t.z)).is_valid();
  }
  return refused;
}

// The vertices and faces of `mesh` that are not marked as deleted, in their order, with normals and colours where it
// has them. O(n).
template <class Mesh>
[[nodiscard]] TriangleMesh from_openmesh(const Mesh& mesh) {
  TriangleMesh out;
  out.positions.reserve(mesh.n_vertices());
  std::vector<VertexId> id(mesh.n_vertices(), no_id);
  for (const auto vertex : mesh.vertices()) {
    if (mesh.has_vertex_status() && mesh.status(vertex).deleted()) continue;
    id[static_cast<std::size_t>(vertex.idx())] = static_cast<VertexId>(out.positions.size());
    const auto& p = mesh.point(vertex);
    out.positions.emplace_back(p[0], p[1], p[2]);
    if (mesh.has_vertex_normals()) {
      const auto& n = mesh.normal(vertex);
      out.normals.emplace_back(n[0], n[1], n[2]);
    }
    if (mesh.has_vertex_colors()) {
      const auto c = OpenMesh::color_cast<OpenMesh::Vec4uc>(mesh.color(vertex));
      out.colors.emplace_back(c[0], c[1], c[2], c[3]);
    }
  }
  out.triangles.reserve(mesh.n_faces());
  for (const auto face : mesh.faces()) {
    if (mesh.has_face_status() && mesh.status(face).deleted()) continue;
    Triangle triangle(no_id);
    int corner = 0;
    for (const auto vertex : mesh.fv_range(face)) triangle[corner++] = id[static_cast<std::size_t>(vertex.idx())];
    out.triangles.push_back(triangle);
  }
  return out;
}

}  // namespace occlod
