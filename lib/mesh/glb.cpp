#include "mesh/glb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "base/file_input.h"
#include "mesh/glb_look.h"
#include "mesh/image_files.h"
#include "mesh/mesh_writers.h"

namespace occlod {

std::vector<GlbPrimitive> glb_primitives(const TriangleMesh& mesh) {
  const std::vector<Triangle>& corners = mesh.wedge_triangles();
  std::vector<GlbPrimitive> primitives;
  if (mesh.triangle_materials.empty()) {
    GlbPrimitive& all = primitives.emplace_back();
    all.wedges.resize(mesh.wedge_count());
    for (WedgeId w = 0; w < all.wedges.size(); ++w) all.wedges[w] = w;
    all.triangles = corners;
    return primitives;
  }
  std::vector<std::vector<std::size_t>> by_material(mesh.materials.size());
  for (std::size_t t = 0; t < corners.size(); ++t) by_material[mesh.triangle_materials[t]].push_back(t);
  std::vector<std::uint32_t> place(mesh.wedge_count());
  std::vector<std::uint32_t> seen_by(mesh.wedge_count(), no_id);
  for (std::size_t m = 0; m < by_material.size(); ++m) {
    if (by_material[m].empty()) continue;
    GlbPrimitive& primitive = primitives.emplace_back();
    primitive.material = static_cast<MaterialId>(m);
    for (const std::size_t t : by_material[m]) {
      Triangle triangle;
      for (int k = 0; k < 3; ++k) {
        const WedgeId w = corners[t][k];
        if (seen_by[w] != m) {
          seen_by[w] = static_cast<std::uint32_t>(m);
          place[w] = static_cast<std::uint32_t>(primitive.wedges.size());
          primitive.wedges.push_back(w);
        }
        triangle[k] = place[w];
      }
      primitive.triangles.push_back(triangle);
    }
  }
  return primitives;
}

namespace {

int wrap_mode(TextureWrap wrap) {
  return wrap == TextureWrap::repeat ? 10497 : wrap == TextureWrap::clamp ? 33071 : 33648;
}

void append_number(std::string& bytes, std::uint64_t number) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((number >> shift) & 0xffU);
}

}  // namespace

GlbDocument::GlbDocument() {
  json_["asset"] = {{"version", "2.0"}, {"generator", "occlod"}};
  json_["scene"] = 0;
  json_["scenes"][0]["nodes"][0] = 0;
  json_["nodes"][0]["mesh"] = 0;
  json_["meshes"][0]["primitives"] = Json::array();
}

std::uint64_t GlbDocument::reserve(std::uint64_t bytes) {
  const std::uint64_t offset = bytes_;
  bytes_ += (bytes + 3) / 4 * 4;
  return offset;
}

std::size_t GlbDocument::add_view(std::uint64_t bytes, int target) {
  Json view = {{"buffer", 0}, {"byteOffset", reserve(bytes)}, {"byteLength", bytes}};
  if (target != 0) view["target"] = target;
  json_["bufferViews"].push_back(std::move(view));
  return json_["bufferViews"].size() - 1;
}

std::size_t GlbDocument::add_accessor(std::uint64_t bytes, int target, int component_type, std::size_t count,
                                      const char* type) {
  const std::size_t view = add_view(bytes, target);
  json_["accessors"].push_back(
      {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
  return json_["accessors"].size() - 1;
}

namespace {

constexpr const char* transform_name = "KHR_texture_transform";

// Returns a reference to a texture. `strength` is the key of TextureMap::strength, if the reference has one.
GlbDocument::Json reference(const TextureMap& map, const char* strength = nullptr) {
  GlbDocument::Json info = {{"index", map.texture}};
  if (strength != nullptr && map.strength != 1.0F) info[strength] = map.strength;
  const TextureMap plain{.texture = map.texture, .strength = map.strength};
  if (map == plain) return info;
  info["extensions"][transform_name] = {
      {"offset", {map.offset.x, map.offset.y}}, {"rotation", map.rotation}, {"scale", {map.scale.x, map.scale.y}}};
  return info;
}

}  // namespace

void GlbDocument::add_material(const Material& material) {
  const glm::vec4& c = material.base_color;
  const Surface& surface = material.surface;
  Json look = {{"baseColorFactor", {c.r, c.g, c.b, c.a}}, {"metallicFactor", 0}};
  if (surface.metallic != 0.0F) look["metallicFactor"] = surface.metallic;
  if (surface.roughness != 1.0F) look["roughnessFactor"] = surface.roughness;
  if (material.texture != no_texture) look["baseColorTexture"] = {{"index", material.texture}};
  Json described;
  if (!material.name.empty()) described["name"] = material.name;
  const auto add_map = [&](Json& to, const char* key, const TextureMap& map, const char* strength) {
    if (map.texture == no_texture) return;
    to[key] = reference(map, strength);
    if (to[key].contains("extensions")) use_extension(transform_name, false);
  };
  add_map(look, "metallicRoughnessTexture", surface.metallic_map, nullptr);
  described["pbrMetallicRoughness"] = std::move(look);
  add_map(described, "normalTexture", surface.normal_map, "scale");
  add_map(described, "occlusionTexture", surface.occlusion_map, "strength");
  add_map(described, "emissiveTexture", surface.emissive_map, nullptr);
  const glm::vec3& e = surface.emissive;
  if (e != glm::vec3(0.0F)) described["emissiveFactor"] = {e.r, e.g, e.b};
  if (surface.alpha_mode == AlphaMode::mask) {
    described["alphaMode"] = "MASK";
    described["alphaCutoff"] = surface.alpha_cutoff;
  } else if (surface.alpha_mode == AlphaMode::blend || c.a < 1.0F) {
    described["alphaMode"] = "BLEND";
  }
  if (surface.double_sided) described["doubleSided"] = true;
  if (surface.unlit) {
    described["extensions"]["KHR_materials_unlit"] = Json::object();
    use_extension("KHR_materials_unlit", false);
  }
  json_["materials"].push_back(std::move(described));
}

std::size_t GlbDocument::add_image(Json image) {
  json_["images"].push_back(std::move(image));
  return json_["images"].size() - 1;
}

void GlbDocument::add_texture(const Texture& texture, std::size_t image, const std::string& mime_type) {
  const std::size_t index = json_["textures"].size();
  Json sampler = {{"wrapS", wrap_mode(texture.wrap_s)}, {"wrapT", wrap_mode(texture.wrap_t)}};
  if (texture.mag_filter != 0) sampler["magFilter"] = texture.mag_filter;
  if (texture.min_filter != 0) sampler["minFilter"] = texture.min_filter;
  json_["samplers"].push_back(std::move(sampler));
  const std::string extension = gltf_image_extension(mime_type).value_or("");
  Json described;
  if (extension.empty()) {
    described = {{"source", image}, {"sampler", index}};
  } else {
    described = {{"sampler", index}, {"extensions", {{extension, {{"source", image}}}}}};
    use_extension(extension, true);
  }
  json_["textures"].push_back(std::move(described));
}

void GlbDocument::use_extension(const std::string& name, bool is_required) {
  const auto add = [&](const char* list) {
    Json& names = json_[list];
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  add("extensionsUsed");
  if (is_required) add("extensionsRequired");
}

std::string GlbDocument::head(const FileErrors& errors) {
  json_["buffers"][0]["byteLength"] = bytes_;
  std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::uint64_t whole = 28 + text.size() + bytes_;
  if (whole > std::numeric_limits<std::uint32_t>::max())
    errors.fail("", "would be larger than the 4 GiB that a GLB file can have", "write .ply");
  std::string head = "glTF";
  append_number(head, 2);
  append_number(head, whole);
  append_number(head, text.size());
  head += "JSON";
  head += text;
  append_number(head, bytes_);
  head += std::string_view("BIN\0", 4);
  return head;
}

std::string uri_of(const std::string& file) {
  constexpr std::string_view plain = "-._~/!$&'()*+,;=:@";
  std::string uri;
  for (const char c : file) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (is_letter || plain.find(c) != std::string_view::npos)
      uri += c;
    else
      uri += fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

std::uint16_t linear_color(std::uint8_t encoded) {
  return static_cast<std::uint16_t>(std::lround(65535.0 * srgb_to_linear(encoded / 255.0)));
}

// Our own writer of binary glTF: tinygltf's writer holds the whole file in memory several times.

namespace {

using Json = GlbDocument::Json;
using namespace gltf;

class GlbWriter {
 public:
  GlbWriter(ChunkedWriter& out, const TriangleMesh& mesh, const MeshOutput& output)
      : out_(out), mesh_(mesh), output_(output), primitives_(glb_primitives(mesh)) {}

  void run(const FileErrors& errors) {
    const glm::dvec3& o = mesh_.origin;
    if (o != glm::dvec3(0.0)) document_.json()["nodes"][0]["translation"] = {o.x, o.y, o.z};
    for (const GlbPrimitive& primitive : primitives_) describe(primitive);
    const GlbLook look(mesh_, output_);
    look.describe(document_);
    out_.text("{}", document_.head(errors));
    for (const GlbPrimitive& primitive : primitives_) write(primitive);
    look.write(out_);
  }

 private:
  std::size_t add_accessor(std::uint64_t bytes, int target, int component_type, std::size_t count, const char* type) {
    return document_.add_accessor(bytes, target, component_type, count, type);
  }

  // Describes a primitive, with its data in the order in which write() writes them.
  void describe(const GlbPrimitive& primitive) {
    const std::size_t count = primitive.wedges.size();
    Json attributes;
    attributes["POSITION"] = add_accessor(12 * count, array_buffer, type_float, count, "VEC3");
    add_bounds(primitive);
    if (!mesh_.normals.empty())
      attributes["NORMAL"] = add_accessor(12 * count, array_buffer, type_float, count, "VEC3");
    if (!mesh_.texture_coordinates.empty())
      attributes["TEXCOORD_0"] = add_accessor(8 * count, array_buffer, type_float, count, "VEC2");
    if (!mesh_.colors.empty()) {
      attributes["COLOR_0"] = add_accessor(8 * count, array_buffer, type_uint16, count, "VEC4");
      document_.json()["accessors"].back()["normalized"] = true;
    }
    const bool is_short = primitive.has_short_indices();
    const std::size_t indices = 3 * primitive.triangles.size();
    Json described = {{"attributes", std::move(attributes)}};
    described["indices"] = add_accessor((is_short ? 2 : 4) * indices, element_array_buffer,
                                        is_short ? type_uint16 : type_uint32, indices, "SCALAR");
    if (!mesh_.materials.empty()) described["material"] = primitive.material;
    document_.primitives().push_back(std::move(described));
  }

  void add_bounds(const GlbPrimitive& primitive) {
    Json least = Json::array(), most = Json::array();
    for (int k = 0; k < 3; ++k) {
      float low = std::numeric_limits<float>::infinity(), high = -low;
      for (const WedgeId w : primitive.wedges) {
        const float x = mesh_.positions[w][k];
        if (!std::isfinite(x)) continue;
        low = std::min(low, x);
        high = std::max(high, x);
      }
      least.push_back(low <= high ? low : 0.0F);
      most.push_back(low <= high ? high : 0.0F);
    }
    document_.json()["accessors"].back()["min"] = std::move(least);
    document_.json()["accessors"].back()["max"] = std::move(most);
  }

  void write(const GlbPrimitive& primitive) {
    for (const WedgeId w : primitive.wedges) out_.vector(mesh_.positions[w]);
    for (const WedgeId w : primitive.wedges) {
      if (!mesh_.normals.empty()) out_.vector(mesh_.normals[w]);
    }
    const bool flip = mesh_.texture_origin != TextureOrigin::top_left;
    for (const WedgeId w : primitive.wedges) {
      if (mesh_.texture_coordinates.empty()) break;
      const glm::vec2& at = mesh_.texture_coordinates[w];
      out_.numbers(at.x, flip ? from_other_origin(at.y) : at.y);
    }
    for (const WedgeId w : primitive.wedges) {
      if (mesh_.colors.empty()) break;
      const glm::u8vec4& c = mesh_.colors[w];
      out_.numbers(linear_color(c.r), linear_color(c.g), linear_color(c.b), static_cast<std::uint16_t>(257 * c.a));
    }
    const bool is_short = primitive.has_short_indices();
    for (const Triangle& t : primitive.triangles) {
      if (is_short)
        out_.numbers(static_cast<std::uint16_t>(t.x), static_cast<std::uint16_t>(t.y), static_cast<std::uint16_t>(t.z));
      else
        out_.numbers(t.x, t.y, t.z);
    }
    if (is_short && primitive.triangles.size() % 2 != 0) out_.numbers(std::uint16_t{0});
  }

  ChunkedWriter& out_;
  const TriangleMesh& mesh_;
  const MeshOutput& output_;
  const std::vector<GlbPrimitive> primitives_;
  GlbDocument document_;
};

}  // namespace

void write_glb(ChunkedWriter& out, const TriangleMesh& mesh, const MeshOutput& output) {
  GlbWriter(out, mesh, output).run(FileErrors(output.path));
}

}  // namespace occlod
