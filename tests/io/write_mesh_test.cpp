#include "occlod/io/write_mesh.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/mesh_files.h"
#include "occlod/io/atomic_file.h"
#include "support/meshes.h"

namespace occlod {
namespace {

namespace fs = std::filesystem;

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

// Coordinates whose shortest decimals are long, tiny or huge: text must bring back the same bits.
TriangleMesh awkward_mesh() {
  TriangleMesh mesh = test::noisy_sphere(2, 3);
  mesh.positions[0] = {1.0f / 3.0f, std::numeric_limits<float>::denorm_min(),
                       std::nextafter(farthest_coordinate, 0.0f)};
  mesh.positions[1] = {-16777216.0f, 1e-30f, 0.1f};
  return mesh;
}

TEST(WriteMesh, IndexedFormatsBringBackTheSameMesh) {
  const test::TestFolder folder;
  const TriangleMesh mesh = awkward_mesh();
  for (const char* name : {"a.ply", "a.obj", "a.off", "A.PLY", "A.Obj"}) {
    write_mesh(folder.path() / name, mesh);
    const CleanMesh back = read_mesh(folder.path() / name);
    EXPECT_EQ(back.mesh.positions, mesh.positions) << name;
    EXPECT_EQ(back.mesh.triangles, mesh.triangles) << name;
  }
}

TEST(WriteMesh, StlBringsBackTheSameTriangles) {
  const test::TestFolder folder;
  const TriangleMesh mesh = awkward_mesh();
  write_mesh(folder.path() / "a.stl", mesh);
  EXPECT_EQ(fs::file_size(folder.path() / "a.stl"), 84 + 50 * mesh.triangle_count());
  const TriangleMesh back = read_mesh(folder.path() / "a.stl").mesh;
  ASSERT_EQ(back.triangle_count(), mesh.triangle_count());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      EXPECT_EQ(back.positions[back.triangles[t][corner]], mesh.positions[mesh.triangles[t][corner]]);
    }
  }
}

TEST(WriteMesh, StlFacetsPointOutward) {
  const test::TestFolder folder;
  write_mesh(folder.path() / "a.stl", test::grid(1, 1));
  const std::string bytes = test::bytes_of(folder.path() / "a.stl");
  EXPECT_EQ(bytes.substr(84, 12), test::Bytes().add_point(0, 0, 1).str());
}

TEST(WriteMesh, PlyCarriesNormalsAndColours) {
  const test::TestFolder folder;
  TriangleMesh mesh = test::tetrahedron();
  mesh.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0.6f, 0, 0.8f}};
  mesh.colors = {{0, 1, 2, 3}, {255, 254, 253, 252}, {7, 7, 7, 7}, {9, 0, 0, 255}};
  write_mesh(folder.path() / "a.ply", mesh);
  const TriangleMesh back = read_mesh(folder.path() / "a.ply").mesh;
  EXPECT_EQ(back.colors, mesh.colors);
  ASSERT_EQ(back.normals.size(), 4u);
  for (std::size_t v = 0; v < 4; ++v) {
    for (int i = 0; i < 3; ++i) EXPECT_FLOAT_EQ(back.normals[v][i], mesh.normals[v][i]);
  }
}

TEST(WriteMesh, FailureLeavesWhatWasThere) {
  const test::TestFolder folder;
  const TriangleMesh mesh = test::tetrahedron();
  EXPECT_THROW(write_mesh(folder.path() / "missing" / "a.ply", mesh), Error);
  EXPECT_THROW(write_mesh(folder.path() / "a.xyz", mesh), Error);
  EXPECT_THROW(write_mesh(folder.path() / "a", mesh), Error);
  fs::create_directory(folder.path() / "folder.ply");
  EXPECT_THROW(write_mesh(folder.path() / "folder.ply", mesh), Error);
  EXPECT_TRUE(fs::is_directory(folder.path() / "folder.ply"));
  EXPECT_EQ(files_in(folder.path()), 1u);  // and no temporary is left
}

TEST(AtomicFile, AppearsOnlyOnCommit) {
  const test::TestFolder folder;
  const fs::path path = folder.write("a.txt", "old");
  {
    AtomicFile file(path);
    file.stream() << "half";
    file.stream().flush();
    EXPECT_EQ(test::bytes_of(path), "old");
  }
  EXPECT_EQ(test::bytes_of(path), "old");
  EXPECT_EQ(files_in(folder.path()), 1u);
  {
    AtomicFile file(path);
    file.stream() << "new";
    file.write(std::as_bytes(std::span("er", 2)));
    file.commit();
    EXPECT_EQ(test::bytes_of(path), "newer");
  }
  EXPECT_EQ(test::bytes_of(path), "newer");
  EXPECT_EQ(files_in(folder.path()), 1u);
}

TEST(AtomicFile, ReportsAFailedWriteAndKeepsTheOldFile) {
  const test::TestFolder folder;
  const fs::path path = folder.write("a.txt", "old");
  AtomicFile file(path);
  file.stream().setstate(std::ios::badbit);  // as after a full disk
  EXPECT_THROW(file.commit(), Error);
  EXPECT_EQ(test::bytes_of(path), "old");
}

// Of the hidden files beside the target only those go that a process of the same machine, which has ended, left there
// more than a minute ago for the same target. No process has the largest number.
TEST(AtomicFile, RemovesWhatKilledProcessesLeft) {
  const test::TestFolder folder;
  const auto leave = [&](const std::string& name, bool is_old) {
    const fs::path path = folder.write(name, "half");
    if (is_old) fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(1));
    return path;
  };
  const std::string ended = "2147483647-0.tmp", at_work = std::to_string(getpid()) + "-77.tmp";
  const fs::path leftover = leave(".a.txt." + ended, true);
  const std::vector<fs::path> others = {leave(".a.txt." + at_work, true), leave(".a.txt.2147483647-1.tmp", false),
                                        leave(".b.txt." + ended, true),   leave(".a.txt.x-0.tmp", true),
                                        leave(".a.txt.2147483647", true), leave(".a.txt.-5-0.tmp", true)};
  AtomicFile file(folder.path() / "a.txt");
  file.commit();
  EXPECT_FALSE(fs::exists(leftover));
  for (const fs::path& other : others) EXPECT_TRUE(fs::exists(other)) << other;
}

TEST(AtomicFile, KeepsPermissionsAndFollowsLinks) {
  const test::TestFolder folder;
  const fs::path path = folder.write("a.txt", "old");
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink(path, folder.path() / "link");
  AtomicFile file(folder.path() / "link");
  file.stream() << "new";
  file.commit();
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
  EXPECT_EQ(test::bytes_of(path), "new");
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

// Two blocks' worth of bytes: the monitor sees the file before it is begun, each block and the commit, and counts
// whole.
TEST(WriteMonitor, SeesEveryBlock) {
  const test::TestFolder folder;
  const std::vector<std::byte> bytes((std::size_t{1} << 22) + 1);
  std::vector<std::uint64_t> seen;
  {
    const WriteMonitor monitor([&](std::uint64_t written) {
      EXPECT_EQ(files_in(folder.path()), seen.empty() ? 0u : 1u);
      seen.push_back(written);
    });
    AtomicFile file(folder.path() / "a");
    file.write(bytes);
    file.commit();
  }
  AtomicFile unseen(folder.path() / "b");
  EXPECT_EQ(seen, (std::vector<std::uint64_t>{0, 0, bytes.size() - 1, bytes.size()}));
  EXPECT_EQ(test::bytes_of(folder.path() / "a").size(), bytes.size());
}

TEST(WriteMonitor, EndsTheWritingAtAnyPointWithTheOldFileInPlace) {
  const test::TestFolder folder;
  const fs::path path = folder.write("a.ply", "old");
  const TriangleMesh mesh = test::octahedron_sphere(2);
  int calls = 0;
  const WriteMonitor count([&](std::uint64_t) { ++calls; });
  write_mesh(folder.path() / "b.ply", mesh);
  ASSERT_GE(calls, 3);  // begin, one block, commit
  for (int last = 1; last <= calls; ++last) {
    int left = last;
    const WriteMonitor stop([&](std::uint64_t) {
      if (--left == 0) throw std::runtime_error("stop");
    });
    EXPECT_THROW(write_mesh(path, mesh), std::runtime_error);
    EXPECT_EQ(test::bytes_of(path), "old");
    EXPECT_EQ(files_in(folder.path()), 2u);
  }
}

TEST(AtomicFile, RefusesDevices) { EXPECT_THROW(AtomicFile("/dev/null"), Error); }

}  // namespace
}  // namespace occlod
