// From pieces of a mesh to the mesh, in arrays that may be larger than memory.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "base/large_vector.h"
#include "occlod/hlod/triangle_source.h"
#include "occlod/mesh/mesh_report.h"
#include "hlod/store/wedge_mesh.h"

namespace occlod::hlod {

// Keeps what a source gives.
class PieceCollector final : public TriangleSink {
 public:
  // Cleans the piece. Throws Error as TriangleSink says.
  void add(const TriangleMesh& piece) override;
  // Of all pieces so far.
  [[nodiscard]] std::span<const glm::vec3> positions() const { return raw_.positions; }
  // After all pieces: positions to the lattice, as clean() has it of a mesh whose positions were rounded: triangles
  // with two corners at one place go, and vertices that no other uses. Throws Error when no triangle is left. O(n).
  void round(float lattice_step);
  // After all pieces: the mesh with its vertices along a Morton curve, those of one cell in the order in which
  // triangles use them first. Vertices at one position become one, equal attributes there one wedge. Takes what was
  // collected. O(n log n).
  [[nodiscard]] WedgeMesh weld(unsigned threads);
  // Sums of what cleaning has counted, but for topology.
  [[nodiscard]] const MeshReport& report() const { return report_; }

 private:
  class Welder;

  void count(const MeshReport& of_piece);
  void append(const TriangleMesh& piece);

  WedgeMesh raw_;  // a vertex for each wedge of each piece; `triangles` only
  std::size_t pieces_ = 0;
  MeshReport report_;
};

}  // namespace occlod::hlod
