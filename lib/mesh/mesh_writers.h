// Writers of formats with materials, which write_mesh() calls, and the buffered output that they share.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <glm/vec3.hpp>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "occlod/mesh.h"

namespace occlod {

// Collects bytes and writes them in large blocks.
class ChunkedWriter {
 public:
  explicit ChunkedWriter(AtomicFile& file) : file_(file) {}

  template <class... Args>
  void text(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(chunk_), format, std::forward<Args>(args)...);
    if (chunk_.size() >= chunk_size) flush();
  }
  // Writes the bytes of `values` in little-endian order, without gaps.
  template <class... Numbers>
  void numbers(Numbers... values) {
    constexpr std::size_t size = (sizeof(Numbers) + ...);
    chunk_.resize(chunk_.size() + size);
    char* at = chunk_.data() + chunk_.size() - size;
    ((put(at, values), at += sizeof(Numbers)), ...);
    if (chunk_.size() >= chunk_size) flush();
  }
  void vector(const glm::vec3& v) { numbers(v.x, v.y, v.z); }
  void vector(const glm::dvec3& v) { numbers(v.x, v.y, v.z); }
  void flush() {
    file_.write(std::as_bytes(std::span(chunk_.data(), chunk_.size())));
    chunk_.clear();
  }

 private:
  static constexpr std::size_t chunk_size = std::size_t{1} << 18;

  template <class Number>
  static void put(char* at, Number value) {
    auto bytes = std::bit_cast<std::array<char, sizeof(Number)>>(value);
    if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
    std::memcpy(at, bytes.data(), bytes.size());
  }

  AtomicFile& file_;
  fmt::memory_buffer chunk_;
};

// Where the writers write, and where they find images. They append a line to `notes` for each that is not there or
// that the format cannot have.
struct MeshOutput {
  const std::filesystem::path& path;          // of the mesh
  const std::filesystem::path& image_folder;  // that names of images are relative to
  std::vector<std::string>& notes;
};

// Writes OBJ, and a file PATH with the extension .mtl when the mesh has materials.
void write_obj(ChunkedWriter& out, const TriangleMesh& mesh, const MeshOutput& output);

// Writes GLB with the images in it. Throws Error that names the path for a mesh of more than 4 GiB, which a GLB file
// cannot hold.
void write_glb(ChunkedWriter& out, const TriangleMesh& mesh, const MeshOutput& output);

// Returns the names of the texture files as the mesh that is written refers to them. Images that the mesh holds are
// written beside it, as STEM_<number>.png or with the extension of their format.
[[nodiscard]] std::vector<std::string> texture_files(const TriangleMesh& mesh, const MeshOutput& output);

// Appends a note when an image file is not there.
void note_missing(const std::string& file, const MeshOutput& output);

// Converts the second texture coordinate to the other texture origin.
[[nodiscard]] inline float from_other_origin(float v) noexcept { return 1.0F - v; }

}  // namespace occlod
