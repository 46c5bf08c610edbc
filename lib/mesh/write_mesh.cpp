#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cstdint>
#include <glm/geometric.hpp>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "base/atomic_file.h"
#include "base/file_input.h"
#include "base/text.h"
#include "mesh/image_files.h"
#include "mesh/materials.h"
#include "mesh/mesh_files.h"
#include "mesh/mesh_writers.h"
#include "mesh/origin.h"
#include "mesh/polygon_soup.h"
#include "occlod/base.h"
#include "occlod/mesh_file.h"

namespace occlod {
namespace {

namespace fs = std::filesystem;

// True when readers find the name again: it is on one line, has no blanks around it, and is no comment.
bool is_plain(const std::string& name) {
  if (name.empty() || name.front() == '#' || name.front() == ' ' || name.back() == ' ' || name.back() == '\\')
    return false;
  return std::ranges::all_of(name, [](char c) { return static_cast<unsigned char>(c) >= ' ' && c != 0x7f; });
}

// Returns a different name for each material: its own if readers find it again and no earlier material has it,
// otherwise a new one.
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

// Returns the name of a file as a line of text holds it, so that readers find the file: a first character that means
// something else to them comes after "./". Throws Error for a name that no line can end with.
std::string name_in_text(const std::string& file) {
  if (file.empty()) return file;
  const auto is_control = [](unsigned char c) { return c < ' ' || c == 0x7f; };
  if (std::ranges::any_of(file, is_control) || file.back() == ' ' || file.back() == '\\')
    throw Error({fmt::format("the file name {}", in_quotes(file)), "",
                 "has a control character, or a blank or backslash at its end, which OBJ and PLY files cannot hold",
                 "rename that file, or write .glb"});
  constexpr std::string_view special = "#- \"";
  return special.find(file.front()) == std::string_view::npos ? file : "./" + file;
}

// Returns the shortest digits of an sRGB value that readers convert to this linear one.
std::string encoded(float linear) {
  const double value = linear_to_srgb(static_cast<double>(linear));
  for (int digits = 1; digits < 17; ++digits) {
    const std::string text = fmt::format("{:.{}g}", value, digits);
    double read = 0.0;
    static_cast<void>(parse_double(text.data(), text.data() + text.size(), read));
    if (static_cast<float>(srgb_to_linear(read)) == std::clamp(linear, 0.0F, 1.0F)) return text;
  }
  return fmt::format("{}", value);
}

// True when MTL has words for how a map is placed, and how strong it is.
bool can_write(const TextureMap& map) { return map.rotation == 0.0F && map.strength == 1.0F; }

void write_mtl(const TriangleMesh& mesh, const std::vector<std::string>& names, const MeshOutput& output) {
  const std::vector<std::string> files = texture_files(mesh, output);
  AtomicFile file(fs::path(output.path).replace_extension(".mtl"));
  ChunkedWriter out(file);
  for (std::size_t m = 0; m < mesh.materials.size(); ++m) {
    const Material& material = mesh.materials[m];
    const glm::vec4& color = material.base_color;
    out.text("newmtl {}\nKd {} {} {}\n", names[m], encoded(color.r), encoded(color.g), encoded(color.b));
    if (color.a != 1.0F) out.text("d {}\n", color.a);
    const auto write_map = [&](const char* keyword, const TextureMap& map) {
      if (map.texture == no_texture) return;
      out.text("{} ", keyword);
      const Texture& texture = mesh.textures[map.texture];
      if (texture.wrap_s == TextureWrap::clamp && texture.wrap_t == TextureWrap::clamp) out.text("-clamp on ");
      const glm::dvec2 scale(map.scale), offset(map.offset.x, 1.0 - scale.y - static_cast<double>(map.offset.y));
      if (scale != glm::dvec2(1.0)) out.text("-s {} {} ", scale.x, scale.y);
      if (offset != glm::dvec2(0.0)) out.text("-o {} {} ", offset.x, offset.y);
      out.text("{}\n", name_in_text(files[map.texture]));
    };
    write_map("map_Kd", {.texture = material.texture});
    const Surface &surface = material.surface, plain;
    if (surface.roughness != plain.roughness) out.text("Pr {}\n", surface.roughness);
    if (surface.metallic != plain.metallic) out.text("Pm {}\n", surface.metallic);
    const glm::vec3& light = surface.emissive;
    if (light != plain.emissive || surface.emissive_map.texture != no_texture)
      out.text("Ke {} {} {}\n", encoded(light.r), encoded(light.g), encoded(light.b));
    if (can_write(surface.emissive_map)) write_map("map_Ke", surface.emissive_map);
    if (can_write(surface.normal_map)) write_map("norm", surface.normal_map);
  }
  out.flush();
  file.commit();
}

// Writes coordinates as text that reads back to the same positions.
class CoordinateText {
 public:
  // A reader would find an origin for the shortest digits of floats that are far away; their doubles are exact.
  explicit CoordinateText(const TriangleMesh& mesh)
      : origin_(mesh.origin),
        has_all_digits_(origin_ != glm::dvec3(0.0) ||
                        (!mesh.positions.empty() && is_far(bounding_box(mesh.positions)))) {}

  void put(ChunkedWriter& out, const glm::vec3& p) const {
    if (!has_all_digits_) return out.text("{} {} {}", p.x, p.y, p.z);
    const glm::dvec3 q = origin_ + glm::dvec3(p);
    out.text("{} {} {}", q.x, q.y, q.z);
  }

 private:
  glm::dvec3 origin_;
  bool has_all_digits_;
};

// Writes vertices. A colour is on the line of its vertex, so when there are colours, each wedge becomes a vertex with
// its own position.
void write_vertices(ChunkedWriter& out, const TriangleMesh& mesh) {
  const std::size_t count = mesh.colors.empty() ? mesh.vertex_count() : mesh.wedge_count();
  const CoordinateText coordinates(mesh);
  for (std::size_t v = 0; v < count; ++v) {
    out.text("v ");
    coordinates.put(out, mesh.positions[v]);
    if (mesh.colors.empty()) {
      out.text("\n");
      continue;
    }
    const glm::dvec3 color = glm::dvec3(mesh.colors[v]) / 255.0;
    out.text(" {:.4f} {:.4f} {:.4f}\n", color.r, color.g, color.b);
  }
}

void write_attributes(ChunkedWriter& out, const TriangleMesh& mesh) {
  const bool flip = mesh.texture_origin != TextureOrigin::bottom_left;
  for (const glm::vec2& at : mesh.texture_coordinates)
    out.text("vt {} {}\n", at.x, flip ? from_other_origin(at.y) : at.y);
  for (const glm::vec3& n : mesh.normals) out.text("vn {} {} {}\n", n.x, n.y, n.z);
}

// Names the materials in their order before the first face when the faces do not, so that readers number them alike.
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

void write_obj(ChunkedWriter& out, const TriangleMesh& mesh, const MeshOutput& output) {
  const std::vector<std::string> names = material_names(mesh);
  if (!names.empty()) {
    write_mtl(mesh, names, output);
    out.text("mtllib {}\n", name_in_text(output.path.filename().replace_extension(".mtl").string()));
  }
  write_vertices(out, mesh);
  write_attributes(out, mesh);
  declare_materials(out, mesh, names);
  write_faces(out, mesh, names);
}

std::vector<std::string> texture_files(const TriangleMesh& mesh, const MeshOutput& output) {
  const fs::path& path = output.path;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < mesh.textures.size(); ++i) {
    const Texture& texture = mesh.textures[i];
    if (texture.bytes.empty()) {
      names.push_back(name_that_leads(texture.file, {output.image_folder, folder_of(path)}));
      note_missing(texture.file, output);
      continue;
    }
    names.push_back(fmt::format("{}_{}{}", path.stem().string(), i, image_extension(image_type(texture))));
    AtomicFile file(path.parent_path() / names.back());
    file.write(std::as_bytes(std::span(texture.bytes)));
    file.commit();
  }
  return names;
}

void note_missing(const std::string& file, const MeshOutput& output) {
  std::error_code unknown;
  if (fs::is_regular_file(image_path(file, output.image_folder), unknown)) return;
  const std::string note =
      fmt::format("the image {} is not in {}", in_quotes(file), in_quotes(output.image_folder.string()));
  if (std::ranges::find(output.notes, note) == output.notes.end()) output.notes.push_back(note);
}

// Our own writers: OpenMesh's exporters need a half-edge mesh behind an interface of forty functions, and round
// coordinates in text. Our text has the shortest numbers that read back to the same bits.

namespace {

// True when a library of OBJ has all of a material.
bool fits_mtl(const Material& material) {
  const Surface& surface = material.surface;
  Surface written;
  written.metallic = surface.metallic;
  written.roughness = surface.roughness;
  written.emissive = surface.emissive;
  if (can_write(surface.emissive_map)) written.emissive_map = surface.emissive_map;
  if (can_write(surface.normal_map)) written.normal_map = surface.normal_map;
  return surface == written;
}

// True when the texture of a material is all that it has. How metallic and rough it is does not count: every material
// of glTF says so.
bool is_texture(const Material& material) {
  Surface plain;
  plain.metallic = material.surface.metallic;
  plain.roughness = material.surface.roughness;
  return material.surface == plain && material.base_color == Material{}.base_color;
}

// Appends a note when materials have more than the format can say.
void note_materials(const TriangleMesh& mesh, const MeshOutput& output, bool (*fits)(const Material&),
                    const char* what) {
  const auto count = mesh.materials.size() - static_cast<std::size_t>(std::ranges::count_if(mesh.materials, fits));
  if (count > 0)
    output.notes.push_back(fmt::format("{} has {} only: {} of {} materials have more (use .glb)",
                                       output.path.extension().string(), what, count, mesh.materials.size()));
}

// Returns the positions of the vertices, without those of extra wedges.
std::span<const glm::vec3> vertices_of(const TriangleMesh& mesh) {
  return std::span(mesh.positions).first(mesh.vertex_count());
}

glm::vec2 from_bottom_left(const TriangleMesh& mesh, const glm::vec2& at) {
  return mesh.texture_origin == TextureOrigin::bottom_left ? at : glm::vec2(at.x, from_other_origin(at.y));
}

// True when faces have to name their textures by number: there are several, or some faces have none.
bool needs_texture_numbers(const TriangleMesh& mesh) {
  return !mesh.textures.empty() && (mesh.textures.size() > 1 || mesh.materials.size() > 1);
}

// `counts` are those of the file; everything else is taken from `mesh`.
void write_ply_header(ChunkedWriter& out, const TriangleMesh& mesh, const WrittenCounts& counts,
                      const MeshOutput& output) {
  out.text("ply\nformat binary_little_endian 1.0\n");
  for (const std::string& file : texture_files(mesh, output)) out.text("comment TextureFile {}\n", name_in_text(file));
  const char* const type = mesh.origin == glm::dvec3(0.0) ? "float" : "double";
  out.text("element vertex {}\nproperty {} x\nproperty {} y\nproperty {} z\n", counts.vertices, type, type, type);
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

// Writes a vertex for each wedge: readers that weld merge those with equal positions, and others show seams correctly.
// When faces name a texture they repeat the texture coordinates, as MeshLab does.
void write_ply(ChunkedWriter& out, const TriangleMesh& mesh, const MeshOutput& output) {
  write_ply_header(out, mesh, {mesh.wedge_count(), mesh.triangle_count()}, output);
  for (std::size_t w = 0; w < mesh.wedge_count(); ++w) {
    if (mesh.origin == glm::dvec3(0.0))
      out.vector(mesh.positions[w]);
    else
      out.vector(mesh.origin + glm::dvec3(mesh.positions[w]));
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
  const CoordinateText coordinates(mesh);
  for (const glm::vec3& p : vertices_of(mesh)) {
    coordinates.put(out, p);
    out.text("\n");
  }
  for (const Triangle& t : mesh.triangles) out.text("3 {} {} {}\n", t.x, t.y, t.z);
}

glm::vec3 facet_normal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 area = glm::cross(b - a, c - a);
  const double length = glm::length(area);
  return length > 0.0 ? glm::vec3(area / length) : glm::vec3(0.0f);
}

void write_stl(ChunkedWriter& out, const TriangleMesh& mesh) {
  const glm::dvec3& o = mesh.origin;
  const bool is_relative = o != glm::dvec3(0.0);
  out.text("{:80}", is_relative ? fmt::format("binary STL, relative to {} {} {}", o.x, o.y, o.z).substr(0, 80)
                                : std::string("binary STL"));
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

// Calls what(part, repeated, first), where `first` is the number of the part's first vertex in the whole mesh.
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
  std::vector<std::string> notes;  // stays empty: parts have no images
  if (is_ply) write_ply_header(out, {}, for_each_part(parts, path, [](const auto&...) {}), {path, path, notes});
  const WrittenCounts counts = write_parts(out, parts, is_ply, path);
  out.flush();
  file.commit();
  return counts;
}

void check_mesh_output(const std::filesystem::path& path) {
  (void)format_to_write(path);
  AtomicFile::check(path);
}

std::vector<std::string> write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh) {
  return write_mesh(path, mesh, folder_of(path));
}

std::vector<std::string> write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh,
                                    const std::filesystem::path& image_folder) {
  assert(mesh.normals.empty() || mesh.normals.size() == mesh.wedge_count());
  assert(mesh.colors.empty() || mesh.colors.size() == mesh.wedge_count());
  assert(mesh.texture_coordinates.empty() || mesh.texture_coordinates.size() == mesh.wedge_count());
  const MeshFormat format = format_to_write(path);
  FileGroup together;  // with the material library and the images
  std::vector<std::string> notes;
  const MeshOutput output{path, image_folder, notes};
  AtomicFile file(path);
  ChunkedWriter out(file);
  switch (format) {
    case MeshFormat::ply:
      note_materials(mesh, output, is_texture, "textures of base colours");
      write_ply(out, mesh, output);
      break;
    case MeshFormat::obj:
      note_materials(mesh, output, fits_mtl, "what .mtl has words for");
      write_obj(out, mesh, output);
      break;
    case MeshFormat::off:
      write_off(out, mesh);
      break;
    case MeshFormat::stl:
      write_stl(out, mesh);
      break;
    case MeshFormat::gltf:
      write_glb(out, mesh, output);
      break;
  }
  out.flush();
  file.commit();
  together.commit();
  return notes;
}

}  // namespace occlod
