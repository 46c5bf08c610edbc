// Tilesets and their contents, read back by the glTF reader.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "base/file_input.h"
#include "hlod/tiles/encode_tile.h"
#include "occlod/build_hlod.h"
#include "occlod/mesh.h"
#include "occlod/mesh_file.h"
#include "support/meshes.h"

namespace occlod::tiles::test {

// Is removed with all that is in it.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "occlod-tiles-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder");
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

// A content as a client that turns it to z up has it.
[[nodiscard]] inline TriangleMesh read_content(const std::filesystem::path& file) {
  TriangleMesh mesh = read_mesh(file).mesh;
  for (glm::vec3& p : mesh.positions) p = {p.x, -p.z, p.y};
  for (glm::vec3& n : mesh.normals) n = {n.x, -n.z, n.y};
  return mesh;
}

[[nodiscard]] inline TriangleMesh decoded(const TileContent& content) {
  const Folder folder;
  std::ofstream(folder / "tile.glb", std::ios::binary) << content.bytes;
  return read_content(folder / "tile.glb");
}

// A sheet of n x n cells of unit size, with hills of this height; its texture coordinates cover the unit square.
[[nodiscard]] inline TriangleMesh wavy_sheet(int n, float height) {
  TriangleMesh mesh = occlod::test::grid(n, n);
  for (glm::vec3& p : mesh.positions) {
    const glm::vec2 at(p);
    mesh.texture_coordinates.push_back(at);
    p = glm::vec3(at * static_cast<float>(n), height * std::sin(20.0F * at.x) * std::cos(15.0F * at.y));
  }
  return mesh;
}

[[nodiscard]] inline hlod::Hlod nested_hlod(const TriangleMesh& mesh, std::uint32_t node_triangles = 64,
                                            hlod::Borders borders = hlod::Borders::free) {
  hlod::HlodBuildOptions options;
  options.node_triangles = node_triangles;
  options.grouping = hlod::Grouping::nested;
  options.borders = borders;
  return hlod::build_hlod(mesh, options);
}

}  // namespace occlod::tiles::test
