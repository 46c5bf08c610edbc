// Meshes of nodes of HLODs, as Python sees them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "occlod/hlod.h"
#include "occlod/mesh.h"

namespace occlod::python {

// The mesh of one node: views of the HLOD's arrays, or copies where meshes come and go.
struct PythonNodeMesh {
  hlod::Hlod hlod;
  hlod::NodeMesh mesh;
  std::shared_ptr<const void> copies;  // of its arrays; null for views
};

// Throws Error when the mesh is damaged or not there.
[[nodiscard]] PythonNodeMesh node_mesh(const hlod::Hlod& hlod, hlod::NodeId node);

// A mesh without vertices, with the materials, textures, origin and axes of an HLOD.
[[nodiscard]] TriangleMesh mesh_like(const hlod::HlodView& data);

// Appends triangles of a node, three indices each, with copies of the vertices that they use.
void append_triangles(TriangleMesh& mesh, const hlod::NodeMesh& node, std::span<const std::uint16_t> indices);

}  // namespace occlod::python
