// View-dependent refinement put together from the pieces of OpenMesh's Tools/VDPM: vertex forest, front, vertex_split()
// and collapse(). The package has no program that joins them for an arbitrary mesh, so the joining is ours: leaves as
// fundamental cuts and forced splits (truly selective refinement: Kim & Lee 2001), and one sweep over the front a view.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "occlod/mesh.h"
#include "occlod/view.h"

namespace occlod::bench {

// The base mesh and the vertex forest, which any number of refiners share.
class VdpmForest {
 public:
  // By half-edge collapses in the order of their quadric error, none of which flips a face. Throws std::runtime_error
  // for a mesh that is no closed manifold.
  VdpmForest(const TriangleMesh& mesh, std::size_t base_triangles);
  ~VdpmForest();

 private:
  friend class VdpmRefiner;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct VdpmChanges {
  std::size_t splits = 0;
  std::size_t forced_splits = 0;  // of those, only because another depends on them
  std::size_t merges = 0;
};

class VdpmRefiner {
 public:
  explicit VdpmRefiner(const VdpmForest& forest);  // outlives this
  ~VdpmRefiner();

  // Back to the base mesh.
  void restart();
  // One sweep over the front: splits the nodes inside the frustum that may face the eye and whose error is more than
  // `tolerance` times their distance, merges those whose parent is none of these.
  VdpmChanges refine(const View& view, double tolerance);
  // Splits every node: the input mesh, with its vertex ids.
  VdpmChanges refine_all();

  [[nodiscard]] std::size_t triangles() const;
  [[nodiscard]] std::uint64_t hash() const;  // of the front
  [[nodiscard]] TriangleMesh mesh() const;   // with the vertices of the input, used or not

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace occlod::bench
