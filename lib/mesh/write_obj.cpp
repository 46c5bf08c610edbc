#include <set>

#include "mesh/mesh_writers.h"
#include "mesh/srgb.h"

namespace occlod {
namespace {

namespace fs = std::filesystem;

std::string extension_of(const Texture& texture) {
  const std::string type = mime_type_of(texture);
  if (type == "image/png") return ".png";
  if (type == "image/jpeg") return ".jpg";
  return type.starts_with("image/") ? "." + type.substr(6) : ".bin";
}

// Whether readers find such a name again: on one line, without blanks around it, and no comment.
bool is_plain(const std::string& name) {
  if (name.empty() || name.front() == '#' || name.front() == ' ' || name.back() == ' ' || name.back() == '\\')
    return false;
  return std::ranges::all_of(name, [](char c) { return static_cast<unsigned char>(c) >= ' ' && c != 0x7f; });
}

// The materials' own names where they can be told apart.
std::vector<std::string> material_names(const TriangleMesh& mesh) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const Material& material : mesh.materials) taken.insert(material.name);
  std::set<std::string> used;
  for (std::size_t m = 0; m < mesh.materials.size(); ++m) {
    std::string name = mesh.materials[m].name;
    if (!is_plain(name) || used.contains(name)) {
      name = fmt::format("material_{}", m);
      while (taken.contains(name)) name += '_';
      taken.insert(name);
    }
    used.insert(name);
    names.push_back(std::move(name));
  }
  return names;
}

void write_mtl(const TriangleMesh& mesh, const std::vector<std::string>& names, const fs::path& mesh_path) {
  const std::vector<std::string> files = texture_files(mesh, mesh_path);
  AtomicFile file(fs::path(mesh_path).replace_extension(".mtl"));
  ChunkedWriter out(file);
  for (std::size_t m = 0; m < mesh.materials.size(); ++m) {
    const Material& material = mesh.materials[m];
    const glm::vec4& color = material.base_color;
    const auto encoded = [](float linear) { return linear_to_srgb(static_cast<double>(linear)); };
    out.text("newmtl {}\nKd {} {} {}\n", names[m], encoded(color.r), encoded(color.g), encoded(color.b));
    if (color.a != 1.0F) out.text("d {}\n", color.a);
    if (material.texture == no_texture) continue;
    const Texture& texture = mesh.textures[material.texture];
    const bool clamps = texture.wrap_s == TextureWrap::clamp && texture.wrap_t == TextureWrap::clamp;
    out.text("map_Kd {}{}\n", clamps ? "-clamp on " : "", files[material.texture]);
  }
  out.flush();
  file.commit();
}

// A colour stands on the line of its vertex: where there are colours, each wedge is a vertex, at the place of its own.
void write_vertices(ChunkedWriter& out, const TriangleMesh& mesh) {
  const std::size_t count = mesh.colors.empty() ? mesh.vertex_count() : mesh.wedge_count();
  for (std::size_t v = 0; v < count; ++v) {
    const glm::vec3& p = mesh.positions[v];
    if (mesh.colors.empty()) {
      out.text("v {} {} {}\n", p.x, p.y, p.z);
      continue;
    }
    const glm::dvec3 color = glm::dvec3(mesh.colors[v]) / 255.0;
    out.text("v {} {} {} {:.4f} {:.4f} {:.4f}\n", p.x, p.y, p.z, color.r, color.g, color.b);
  }
}

void write_attributes(ChunkedWriter& out, const TriangleMesh& mesh) {
  const bool flip = mesh.texture_origin != TextureOrigin::bottom_left;
  for (const glm::vec2& at : mesh.texture_coordinates)
    out.text("vt {} {}\n", at.x, flip ? from_other_origin(at.y) : at.y);
  for (const glm::vec3& n : mesh.normals) out.text("vn {} {} {}\n", n.x, n.y, n.z);
}

// Names them in their order where the faces do not, so that they are numbered as they are.
void declare_materials(ChunkedWriter& out, const TriangleMesh& mesh, const std::vector<std::string>& names) {
  MaterialId next = 0;
  for (const MaterialId material : mesh.triangle_materials) {
    if (material > next) break;
    next = static_cast<MaterialId>(next + (material == next));
  }
  if (next == names.size() || (names.size() == 1 && mesh.triangle_materials.empty())) return;
  for (const std::string& name : names) out.text("usemtl {}\n", name);
}

void write_faces(ChunkedWriter& out, const TriangleMesh& mesh, const std::vector<std::string>& names) {
  const bool has_texture = !mesh.texture_coordinates.empty(), has_normals = !mesh.normals.empty();
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const MaterialId material = mesh.material_of(t);
    if (!names.empty() && (t == 0 || material != mesh.material_of(t - 1))) out.text("usemtl {}\n", names[material]);
    const Triangle& vertices = mesh.colors.empty() ? mesh.triangles[t] : mesh.wedge_triangles()[t];
    out.text("f");
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t v = std::uint64_t{vertices[k]} + 1, w = std::uint64_t{mesh.wedge_triangles()[t][k]} + 1;
      if (has_texture && has_normals)
        out.text(" {}/{}/{}", v, w, w);
      else if (has_texture)
        out.text(" {}/{}", v, w);
      else if (has_normals)
        out.text(" {}//{}", v, w);
      else
        out.text(" {}", v);
    }
    out.text("\n");
  }
}

}  // namespace

void write_obj(ChunkedWriter& out, const TriangleMesh& mesh, const fs::path& path) {
  const std::vector<std::string> names = material_names(mesh);
  if (!names.empty()) {
    write_mtl(mesh, names, path);
    out.text("mtllib {}\n", path.filename().replace_extension(".mtl").string());
  }
  write_vertices(out, mesh);
  write_attributes(out, mesh);
  declare_materials(out, mesh, names);
  write_faces(out, mesh, names);
}

std::string mime_type_of(const Texture& texture) {
  if (!texture.mime_type.empty()) return texture.mime_type;
  const auto begins_with = [&](std::initializer_list<std::uint8_t> bytes) {
    return texture.bytes.size() >= bytes.size() && std::equal(bytes.begin(), bytes.end(), texture.bytes.begin());
  };
  if (begins_with({0x89, 'P', 'N', 'G'})) return "image/png";
  return begins_with({0xff, 0xd8}) ? "image/jpeg" : "application/octet-stream";
}

std::vector<std::string> texture_files(const TriangleMesh& mesh, const fs::path& path) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < mesh.textures.size(); ++i) {
    const Texture& texture = mesh.textures[i];
    if (texture.bytes.empty()) {
      names.push_back(texture.file);
      continue;
    }
    names.push_back(fmt::format("{}_{}{}", path.stem().string(), i, extension_of(texture)));
    AtomicFile file(path.parent_path() / names.back());
    file.write(std::as_bytes(std::span(texture.bytes)));
    file.commit();
  }
  return names;
}

}  // namespace occlod
