// Our own writers: OpenMesh's exporters need a half-edge mesh behind an interface of forty functions, and round
// coordinates in text. Numbers in text are the shortest that read back to the same bits.
#include "occlod/io/write_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <glm/geometric.hpp>
#include <iterator>
#include <span>
#include <utility>

#include "io/atomic_file.h"
#include "io/file_format.h"
#include "io/file_input.h"

namespace occlod {
namespace {

// Collects bytes and writes them in large blocks.
class ChunkedWriter {
 public:
  explicit ChunkedWriter(AtomicFile& file) : file_(file) {}

  template <class... Args>
  void text(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(chunk_), format, std::forward<Args>(args)...);
    if (chunk_.size() >= chunk_size) flush();
  }
  // The bytes of `values` in little-endian order, without gaps.
  template <class... Numbers>
  void numbers(Numbers... values) {
    constexpr std::size_t size = (sizeof(Numbers) + ...);
    chunk_.resize(chunk_.size() + size);
    char* at = chunk_.data() + chunk_.size() - size;
    ((put(at, values), at += sizeof(Numbers)), ...);
    if (chunk_.size() >= chunk_size) flush();
  }
  void vector(const glm::vec3& v) { numbers(v.x, v.y, v.z); }
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

// Without those of extra wedges.
std::span<const glm::vec3> vertices_of(const TriangleMesh& mesh) {
  return std::span(mesh.positions).first(mesh.vertex_count());
}

void write_ply(ChunkedWriter& out, const TriangleMesh& mesh) {
  out.text("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.vertex_count());
  out.text("property float x\nproperty float y\nproperty float z\n");
  if (!mesh.normals.empty()) out.text("property float nx\nproperty float ny\nproperty float nz\n");
  if (!mesh.colors.empty()) {
    out.text("property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n");
  }
  out.text("element face {}\nproperty list uchar uint vertex_indices\nend_header\n", mesh.triangle_count());
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    out.vector(mesh.positions[v]);
    if (!mesh.normals.empty()) out.vector(mesh.normals[v]);
    if (mesh.colors.empty()) continue;
    const glm::u8vec4& color = mesh.colors[v];
    out.numbers(color.r, color.g, color.b, color.a);
  }
  for (const Triangle& t : mesh.triangles) out.numbers(std::uint8_t{3}, t.x, t.y, t.z);
}

void write_obj(ChunkedWriter& out, const TriangleMesh& mesh) {
  for (const glm::vec3& p : vertices_of(mesh)) out.text("v {} {} {}\n", p.x, p.y, p.z);
  for (const Triangle& t : mesh.triangles) {
    out.text("f {} {} {}\n", std::uint64_t{t.x} + 1, std::uint64_t{t.y} + 1, std::uint64_t{t.z} + 1);
  }
}

void write_off(ChunkedWriter& out, const TriangleMesh& mesh) {
  out.text("OFF\n{} {} 0\n", mesh.vertex_count(), mesh.triangle_count());
  for (const glm::vec3& p : vertices_of(mesh)) out.text("{} {} {}\n", p.x, p.y, p.z);
  for (const Triangle& t : mesh.triangles) out.text("3 {} {} {}\n", t.x, t.y, t.z);
}

glm::vec3 facet_normal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 area = glm::cross(b - a, c - a);
  const double length = glm::length(area);
  return length > 0.0 ? glm::vec3(area / length) : glm::vec3(0.0f);
}

void write_stl(ChunkedWriter& out, const TriangleMesh& mesh) {
  out.text("{:80}", "binary STL");
  out.numbers(static_cast<std::uint32_t>(mesh.triangle_count()));
  for (const Triangle& t : mesh.triangles) {
    out.vector(facet_normal(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]));
    for (int corner = 0; corner < 3; ++corner) out.vector(mesh.positions[t[corner]]);
    out.numbers(std::uint16_t{0});
  }
}

MeshFormat format_to_write(const std::filesystem::path& path) {
  const FileErrors errors(path);
  const MeshFormat format = format_of(path, errors);
  if (format == MeshFormat::gltf) errors.fail("", "glTF is read but not written", "use .ply, .obj, .off or .stl");
  return format;
}

}  // namespace

void check_mesh_output(const std::filesystem::path& path) {
  (void)format_to_write(path);
  AtomicFile::check(path);
}

void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh) {
  assert(mesh.normals.empty() || mesh.normals.size() == mesh.wedge_count());
  assert(mesh.colors.empty() || mesh.colors.size() == mesh.wedge_count());
  const MeshFormat format = format_to_write(path);
  AtomicFile file(path);
  ChunkedWriter out(file);
  switch (format) {
    case MeshFormat::ply:
      write_ply(out, mesh);
      break;
    case MeshFormat::obj:
      write_obj(out, mesh);
      break;
    case MeshFormat::off:
      write_off(out, mesh);
      break;
    case MeshFormat::stl:
      write_stl(out, mesh);
      break;
    case MeshFormat::gltf:  // refused above
      break;
  }
  out.flush();
  file.commit();
}

}  // namespace occlod
