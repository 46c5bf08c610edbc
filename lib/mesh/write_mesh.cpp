// Our own writers: OpenMesh's exporters need a half-edge mesh behind an interface of forty functions, and round
// coordinates in text. Numbers in text are the shortest that read back to the same bits.
#include "occlod/io/write_mesh.h"

#include <fmt/format.h>

#include <cassert>
#include <cctype>
#include <cstdint>
#include <glm/geometric.hpp>
#include <span>
#include <string>

#include "base/atomic_file.h"
#include "mesh/chunked_writer.h"
#include "mesh/file_format.h"
#include "base/file_input.h"
#include "mesh/mesh_writers.h"
#include "mesh/polygon_soup.h"

namespace occlod {
namespace {

// Without those of extra wedges.
std::span<const glm::vec3> vertices_of(const TriangleMesh& mesh) {
  return std::span(mesh.positions).first(mesh.vertex_count());
}

glm::vec2 from_bottom_left(const TriangleMesh& mesh, const glm::vec2& at) {
  return mesh.texture_origin == TextureOrigin::bottom_left ? at : glm::vec2(at.x, from_other_origin(at.y));
}

// Of each texture's number, where faces have to name one: there are several, or some have none.
bool needs_texture_numbers(const TriangleMesh& mesh) {
  return !mesh.textures.empty() && (mesh.textures.size() > 1 || mesh.materials.size() > 1);
}

// `counts`: of the file, of which `mesh` says all else.
void write_ply_header(ChunkedWriter& out, const TriangleMesh& mesh, const WrittenCounts& counts,
                      const std::filesystem::path& path) {
  out.text("ply\nformat binary_little_endian 1.0\n");
  for (const std::string& file : texture_files(mesh, path)) out.text("comment TextureFile {}\n", file);
  out.text("element vertex {}\nproperty float x\nproperty float y\nproperty float z\n", counts.vertices);
  if (!mesh.normals.empty()) out.text("property float nx\nproperty float ny\nproperty float nz\n");
  if (!mesh.colors.empty()) {
    out.text("property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n");
  }
  if (!mesh.texture_coordinates.empty()) out.text("property float s\nproperty float t\n");
  out.text("element face {}\nproperty list uchar uint vertex_indices\n", counts.triangles);
  if (needs_texture_numbers(mesh)) {
    if (!mesh.texture_coordinates.empty()) out.text("property list uchar float texcoord\n");
    out.text("property int texnumber\n");
  }
  out.text("end_header\n");
}

// A vertex for each wedge: readers that weld make one of those at one position, others show seams as they are. Faces
// repeat the texture coordinates where they name a texture, as MeshLab has it.
void write_ply(ChunkedWriter& out, const TriangleMesh& mesh, const std::filesystem::path& path) {
  write_ply_header(out, mesh, {mesh.wedge_count(), mesh.triangle_count()}, path);
  for (std::size_t w = 0; w < mesh.wedge_count(); ++w) {
    out.vector(mesh.positions[w]);
    if (!mesh.normals.empty()) out.vector(mesh.normals[w]);
    if (!mesh.colors.empty()) {
      const glm::u8vec4& color = mesh.colors[w];
      out.numbers(color.r, color.g, color.b, color.a);
    }
    if (mesh.texture_coordinates.empty()) continue;
    const glm::vec2 at = from_bottom_left(mesh, mesh.texture_coordinates[w]);
    out.numbers(at.x, at.y);
  }
  const bool has_numbers = needs_texture_numbers(mesh);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle& corners = mesh.wedge_triangles()[t];
    out.numbers(std::uint8_t{3}, corners.x, corners.y, corners.z);
    if (!has_numbers) continue;
    if (!mesh.texture_coordinates.empty()) out.numbers(std::uint8_t{6});
    for (int k = 0; k < 3 && !mesh.texture_coordinates.empty(); ++k) {
      const glm::vec2 at = from_bottom_left(mesh, mesh.texture_coordinates[corners[k]]);
      out.numbers(at.x, at.y);
    }
    const TextureId texture = mesh.materials.empty() ? no_texture : mesh.materials[mesh.material_of(t)].texture;
    out.numbers(texture == no_texture ? std::int32_t{-1} : std::int32_t{texture});
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
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (format == MeshFormat::gltf && extension != ".glb")
    errors.fail("", "glTF in text is read but not written", "use .glb, or .ply, .obj, .off or .stl");
  return format;
}

// Calls what(part, repeated, first): `first` is the number of the part's first vertex in the whole.
template <class What>
WrittenCounts for_each_part(const MeshParts& parts, const std::filesystem::path& path, const What& what) {
  WrittenCounts counts;
  parts([&](const TriangleMesh& part, std::size_t repeated) {
    const std::uint64_t first = counts.vertices - repeated;
    if (first + part.vertex_count() >= max_vertices)
      FileErrors(path).fail("", "would have too many vertices", "make a smaller mesh");
    what(part, repeated, first);
    counts.vertices = first + part.vertex_count();
    counts.triangles += part.triangle_count();
  });
  return counts;
}

WrittenCounts write_parts(ChunkedWriter& out, const MeshParts& parts, bool is_ply, const std::filesystem::path& path) {
  for_each_part(parts, path, [&](const TriangleMesh& part, std::size_t repeated, std::uint64_t) {
    for (const glm::vec3& p : vertices_of(part).subspan(repeated))
      is_ply ? out.vector(p) : out.text("v {} {} {}\n", p.x, p.y, p.z);
  });
  return for_each_part(parts, path, [&](const TriangleMesh& part, std::size_t, std::uint64_t first) {
    for (const Triangle& t : part.triangles) {
      const Triangle whole = t + static_cast<VertexId>(first + (is_ply ? 0 : 1));
      is_ply ? out.numbers(std::uint8_t{3}, whole.x, whole.y, whole.z)
             : out.text("f {} {} {}\n", whole.x, whole.y, whole.z);
    }
  });
}

MeshFormat format_of_parts(const std::filesystem::path& path) {
  const MeshFormat format = format_to_write(path);
  if (format != MeshFormat::ply && format != MeshFormat::obj)
    FileErrors(path).fail("", "only PLY and OBJ files are written in parts", "use .ply or .obj");
  return format;
}

}  // namespace

void check_mesh_parts_output(const std::filesystem::path& path) {
  (void)format_of_parts(path);
  AtomicFile::check(path);
}

WrittenCounts write_mesh_parts(const std::filesystem::path& path, const MeshParts& parts) {
  const bool is_ply = format_of_parts(path) == MeshFormat::ply;
  AtomicFile file(path);
  ChunkedWriter out(file);
  if (is_ply) write_ply_header(out, {}, for_each_part(parts, path, [](const auto&...) {}), path);
  const WrittenCounts counts = write_parts(out, parts, is_ply, path);
  out.flush();
  file.commit();
  return counts;
}

void check_mesh_output(const std::filesystem::path& path) {
  (void)format_to_write(path);
  AtomicFile::check(path);
}

void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh) {
  assert(mesh.normals.empty() || mesh.normals.size() == mesh.wedge_count());
  assert(mesh.colors.empty() || mesh.colors.size() == mesh.wedge_count());
  assert(mesh.texture_coordinates.empty() || mesh.texture_coordinates.size() == mesh.wedge_count());
  const MeshFormat format = format_to_write(path);
  AtomicFile file(path);
  ChunkedWriter out(file);
  switch (format) {
    case MeshFormat::ply:
      write_ply(out, mesh, path);
      break;
    case MeshFormat::obj:
      write_obj(out, mesh, path);
      break;
    case MeshFormat::off:
      write_off(out, mesh);
      break;
    case MeshFormat::stl:
      write_stl(out, mesh);
      break;
    case MeshFormat::gltf:
      write_glb(out, mesh, path);
      break;
  }
  out.flush();
  file.commit();
}

}  // namespace occlod
