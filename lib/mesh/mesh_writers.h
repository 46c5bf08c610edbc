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

// Writes OBJ, and a file PATH with the extension .mtl when the mesh has materials. `path` is that of the mesh.
void write_obj(ChunkedWriter& out, const TriangleMesh& mesh, const std::filesystem::path& path);

// Writes GLB. Throws Error that names `path` for a mesh of more than 4 GiB, which a GLB file cannot hold.
void write_glb(ChunkedWriter& out, const TriangleMesh& mesh, const std::filesystem::path& path);

// Returns the names of the texture files as a mesh at `path` refers to them. Images that the mesh holds are written
// beside it, as STEM_<number>.png or with the extension of their format.
[[nodiscard]] std::vector<std::string> texture_files(const TriangleMesh& mesh, const std::filesystem::path& path);

// Returns the MIME type of an image from its first bytes when the mesh does not give it: image/png, image/jpeg or
// application/octet-stream.
[[nodiscard]] std::string mime_type_of(const Texture& texture);

// Converts the second texture coordinate to the other texture origin.
[[nodiscard]] inline float from_other_origin(float v) noexcept { return 1.0F - v; }

}  // namespace occlod
