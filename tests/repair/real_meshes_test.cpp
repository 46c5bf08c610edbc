// Meshes as people have them: every one comes out as an oriented manifold, the same each time, or is refused with a
// reason.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/mesh.h"
#include "occlod/mesh_file.h"
#include "repair/repair_case.h"
#include "support/test_meshes.h"

namespace occlod::repair {
namespace {

void expect_sound_hierarchy(const TriangleMesh& mesh) {
  const TriangleMesh welded = clean(mesh, {}, "repaired").mesh;  // as the next reader has it
  const Hierarchy hierarchy = build_hierarchy(welded);
  const std::vector<std::string> violations = validate(hierarchy);
  EXPECT_TRUE(violations.empty()) << violations[0];
  EXPECT_TRUE(restores(hierarchy, welded));
}

void expect_repaired(const std::filesystem::path& path, const RepairOptions& options) {
  SCOPED_TRACE(path.filename());
  TriangleMesh mesh;
  try {
    mesh = read_mesh(path).mesh;
  } catch (const Error&) {
    return;  // tests/io says which and why
  }
  const RepairedMesh repaired = repair_soundly(mesh, options), again = repair_soundly(mesh, options);
  EXPECT_EQ(repaired.mesh.triangles, again.mesh.triangles);
  EXPECT_EQ(repaired.mesh.positions, again.mesh.positions);
  EXPECT_EQ(repair_soundly(repaired.mesh).changes.dropped(), 0U);
  if (!repaired.mesh.triangles.empty()) expect_sound_hierarchy(repaired.mesh);
}

TEST(RepairRealMeshes, HardOnesBecomeOrientedManifolds) {
  OCCLOD_FIND_TEST_MESH_OR_SKIP(folder, "hard");
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  RepairOptions filling;
  filling.fill_holes = 100;
  for (const std::filesystem::path& file : files) {
    expect_repaired(file, {});
    expect_repaired(file, filling);
  }
}

}  // namespace
}  // namespace occlod::repair
