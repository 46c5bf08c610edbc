#include "occlod/openmesh.h"

#include <fmt/format.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <cstdio>

#include "peers/peers.h"
#include "stopwatch.h"

namespace occlod::bench {
namespace {

using Mesh = OpenMesh::TriMesh_ArrayKernelT<>;

SimplifyRun simplify(Mesh mesh, std::size_t target) {
  const tool::Stopwatch stopwatch;
  OpenMesh::Decimater::DecimaterT<Mesh> decimater(mesh);
  OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
  decimater.add(quadric);
  decimater.module(quadric).unset_max_err();  // orders collapses, forbids none
  decimater.initialize();
  decimater.decimate_to_faces(0, target);
  mesh.garbage_collection();
  return {stopwatch.milliseconds(), from_openmesh(mesh)};
}

}  // namespace

std::vector<SimplifyRun> simplify_by_openmesh(const TriangleMesh& mesh, std::span<const std::size_t> targets) {
  Mesh input;
  if (const std::size_t refused = to_openmesh(mesh, input); refused > 0)
    fmt::print(stderr, "OpenMesh does without {} triangles that a half-edge mesh cannot hold\n", refused);
  std::vector<SimplifyRun> runs;
  for (const std::size_t target : targets) runs.push_back(simplify(input, target));
  return runs;
}

}  // namespace occlod::bench
