// Reads glTF 2.0, text and binary, through tinygltf: the triangles of every mesh that the default scene places, in
// world space. tinygltf parses; that nodes form a tree is checked here.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <filesystem>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <new>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "mesh/gltf_accessor.h"
#include "mesh/materials.h"
#include "mesh/mesh_files.h"
#include "mesh/polygon_soup.h"
#include "mesh/tinygltf.h"

namespace occlod {
namespace {

// How a material looks up its base colour texture.
struct GltfLookup {
  int set = 0;                  // TEXCOORD_<set>
  bool is_transformed = false;  // KHR_texture_transform, given by the fields below:
  glm::dvec2 row_u{1.0, 0.0};   // u' = dot(row_u, uv) + offset.x
  glm::dvec2 row_v{0.0, 1.0};   // v' = dot(row_v, uv) + offset.y
  glm::dvec2 offset{0.0};
};

// Fills the materials and textures of a soup, as far as the base colour needs them: all materials of the file in their
// order, followed by one without a name if a primitive has no material. Throws Error for textures and images that do
// not exist.
class GltfMaterials {
 public:
  GltfMaterials(GltfViews& views, PolygonSoup& soup);

  // Returns the id of a material of the file; a negative number stands for a primitive without material. Throws Error
  // when the material does not exist.
  [[nodiscard]] MaterialId id_of(int material);
  // Returns the texture lookup of a material.
  [[nodiscard]] const GltfLookup& lookup(MaterialId id) const { return lookups_[id]; }

 private:
  void add(const tinygltf::Material& material);
  [[nodiscard]] TextureId texture(int index);
  void fill(Texture& texture, int image_index);

  GltfViews& views_;
  PolygonSoup& soup_;
  std::vector<GltfLookup> lookups_;  // by material
  std::map<int, TextureId> textures_;
};

TextureWrap wrap_of(int mode) {
  if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return TextureWrap::clamp;
  return mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? TextureWrap::mirror : TextureWrap::repeat;
}

double number_or(const tinygltf::Value& value, double otherwise) {
  return value.IsNumber() ? value.GetNumberAsDouble() : otherwise;
}

glm::dvec2 pair_or(const tinygltf::Value& value, double otherwise) {
  glm::dvec2 pair(otherwise);
  if (!value.IsArray()) return pair;
  for (int k = 0; k < 2 && static_cast<std::size_t>(k) < value.ArrayLen(); ++k)
    pair[k] = number_or(value.Get(k), otherwise);
  return pair;
}

// The rotation is counter-clockwise seen with v upwards, so that the example of the extension (offset 0 1, a quarter
// turn, scale 0.5) shows the lower left quarter of the image, as the extension says.
GltfLookup lookup_of(const tinygltf::TextureInfo& info) {
  GltfLookup lookup;
  lookup.set = std::max(info.texCoord, 0);
  const auto found = info.extensions.find("KHR_texture_transform");
  if (found == info.extensions.end()) return lookup;
  const tinygltf::Value& transform = found->second;
  const glm::dvec2 scale = pair_or(transform.Get("scale"), 1.0);
  const double angle = number_or(transform.Get("rotation"), 0.0);
  lookup.is_transformed = true;
  lookup.offset = pair_or(transform.Get("offset"), 0.0);
  lookup.row_u = {std::cos(angle) * scale.x, std::sin(angle) * scale.y};
  lookup.row_v = {-std::sin(angle) * scale.x, std::cos(angle) * scale.y};
  if (transform.Get("texCoord").IsNumber()) lookup.set = std::max(transform.Get("texCoord").GetNumberAsInt(), 0);
  return lookup;
}

// Returns the image of a texture, also when an extension gives its format.
int source_of(const tinygltf::Texture& texture) {
  if (texture.source >= 0) return texture.source;
  for (const char* name : {"EXT_texture_webp", "KHR_texture_basisu", "MSFT_texture_dds"}) {
    const auto found = texture.extensions.find(name);
    if (found != texture.extensions.end() && found->second.Get("source").IsNumber())
      return found->second.Get("source").GetNumberAsInt();
  }
  return -1;
}

GltfMaterials::GltfMaterials(GltfViews& views, PolygonSoup& soup) : views_(views), soup_(soup) {
  const std::vector<tinygltf::Material>& materials = views.model().materials;
  if (materials.size() >= max_materials)
    views.errors().fail("", fmt::format("has {} materials, which is more than {}", materials.size(), max_materials - 1),
                        "split the mesh into parts");
  for (const tinygltf::Material& material : materials) add(material);
}

MaterialId GltfMaterials::id_of(int material) {
  const std::size_t count = views_.model().materials.size();
  if (material >= 0 && static_cast<std::size_t>(material) >= count)
    views_.errors().fail("", fmt::format("refers to material {}, which is not there", material), gltf_remedy);
  if (material >= 0) return static_cast<MaterialId>(material);
  if (soup_.materials.size() == count) {
    soup_.materials.emplace_back();
    lookups_.emplace_back();
  }
  return static_cast<MaterialId>(count);
}

void GltfMaterials::add(const tinygltf::Material& material) {
  const tinygltf::PbrMetallicRoughness& look = material.pbrMetallicRoughness;
  Material& added = soup_.materials.emplace_back();
  added.name = material.name;
  for (int k = 0; k < 4 && static_cast<std::size_t>(k) < look.baseColorFactor.size(); ++k) {
    const double value = look.baseColorFactor[static_cast<std::size_t>(k)];
    added.base_color[k] = value > 0.0 ? static_cast<float>(std::min(value, 1.0)) : 0.0F;
  }
  if (look.baseColorTexture.index >= 0) added.texture = texture(look.baseColorTexture.index);
  lookups_.push_back(lookup_of(look.baseColorTexture));
  for (const int other : {look.metallicRoughnessTexture.index, material.normalTexture.index,
                          material.occlusionTexture.index, material.emissiveTexture.index})
    soup_.left_out.add("textures beside the base colour", other >= 0);
}

TextureId GltfMaterials::texture(int index) {
  const tinygltf::Model& model = views_.model();
  const FileErrors& errors = views_.errors();
  if (const auto found = textures_.find(index); found != textures_.end()) return found->second;
  if (static_cast<std::size_t>(index) >= model.textures.size())
    errors.fail("", fmt::format("refers to texture {}, which is not there", index), gltf_remedy);
  const tinygltf::Texture& texture = model.textures[static_cast<std::size_t>(index)];
  Texture added;
  const int image = source_of(texture);
  if (image < 0) return textures_.emplace(index, no_texture).first->second;
  fill(added, image);
  if (texture.sampler >= 0) {
    if (static_cast<std::size_t>(texture.sampler) >= model.samplers.size())
      errors.fail("", fmt::format("refers to sampler {}, which is not there", texture.sampler), gltf_remedy);
    const tinygltf::Sampler& sampler = model.samplers[static_cast<std::size_t>(texture.sampler)];
    added.wrap_s = wrap_of(sampler.wrapS);
    added.wrap_t = wrap_of(sampler.wrapT);
  }
  soup_.textures.push_back(std::move(added));
  return textures_.emplace(index, static_cast<TextureId>(soup_.textures.size() - 1)).first->second;
}

void GltfMaterials::fill(Texture& texture, int image_index) {
  const tinygltf::Model& model = views_.model();
  if (static_cast<std::size_t>(image_index) >= model.images.size())
    views_.errors().fail("", fmt::format("refers to image {}, which is not there", image_index), gltf_remedy);
  const tinygltf::Image& image = model.images[static_cast<std::size_t>(image_index)];
  if (!image.uri.empty()) {
    texture.file = file_name_of_uri(image.uri);
    return;
  }
  texture.mime_type = image.mimeType;
  texture.bytes = image.image;  // from a data URI
  if (image.bufferView < 0) return;
  const std::string place = fmt::format("image {}", image_index);
  const GltfViews::View view = views_.view(image.bufferView, place);
  if (view.length > view.bytes.size())
    views_.errors().fail(place, "reaches beyond its buffer: the file was cut or is malformed", gltf_remedy);
  texture.bytes.assign(view.bytes.begin(), view.bytes.begin() + static_cast<std::ptrdiff_t>(view.length));
}

constexpr const char* remedy = gltf_remedy;
constexpr std::size_t max_depth = 256;  // depth of the node tree; a deeper one is treated as a cycle

glm::dmat4 local_transform(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
  glm::dmat4 m(1.0);
  if (node.translation.size() == 3) m = glm::translate(m, glm::make_vec3(node.translation.data()));
  if (node.rotation.size() == 4)
    m *= glm::mat4_cast(glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]));
  if (node.scale.size() == 3) m = glm::scale(m, glm::make_vec3(node.scale.data()));
  return m;
}

class GltfReader {
 public:
  GltfReader(const tinygltf::Model& model, const FileErrors& errors)
      : model_(model), errors_(errors), views_(model, errors), materials_(views_, soup_) {}

  PolygonSoup run() {
    for (const std::string& extension : model_.extensionsRequired) check_extension(extension);
    for (const int root : roots()) visit(root, glm::dmat4(1.0), 0);
    pad_attributes();
    soup_.texture_origin = TextureOrigin::top_left;
    return std::move(soup_);
  }

 private:
  // Refuses required extensions that are not supported. Extensions of images do not matter here: the program that draws
  // decodes them.
  void check_extension(const std::string& name) const {
    constexpr std::array<std::string_view, 6> known{"KHR_mesh_quantization",   "KHR_texture_transform",
                                                    "EXT_meshopt_compression", "EXT_texture_webp",
                                                    "KHR_texture_basisu",      "MSFT_texture_dds"};
    if (name.starts_with("KHR_materials") || std::ranges::find(known, name) != known.end()) return;
    if (name == draco) fail_draco();
    errors_.fail("", fmt::format("needs the extension {}, which is not supported", name), "export the mesh without it");
  }
  [[noreturn]] void fail_draco() const {
    errors_.fail("", "is compressed with Draco, which is not supported",
                 "decompress the file: gltf-transform copy IN OUT, or export it without Draco");
  }

  // Returns the root nodes of the default scene, or all nodes without a parent.
  [[nodiscard]] std::vector<int> roots() const {
    const int scene = model_.defaultScene >= 0 ? model_.defaultScene : 0;
    if (static_cast<std::size_t>(scene) < model_.scenes.size())
      return model_.scenes[static_cast<std::size_t>(scene)].nodes;
    std::vector<bool> is_child(model_.nodes.size(), false);
    for (const tinygltf::Node& node : model_.nodes)
      for (const int child : node.children)
        if (child >= 0 && static_cast<std::size_t>(child) < is_child.size())
          is_child[static_cast<std::size_t>(child)] = true;
    std::vector<int> nodes;
    for (std::size_t i = 0; i < is_child.size(); ++i)
      if (!is_child[i]) nodes.push_back(static_cast<int>(i));
    return nodes;
  }

  void visit(int index, const glm::dmat4& above, std::size_t depth) {
    if (index < 0 || static_cast<std::size_t>(index) >= model_.nodes.size())
      errors_.fail("", fmt::format("refers to node {}, which is not there", index), remedy);
    // A tree visits each node once; more visits than nodes means that nodes are shared or form a cycle.
    if (depth > max_depth || ++visits_ > model_.nodes.size())
      errors_.fail(fmt::format("node {}", index), "is not part of a tree of nodes", remedy);
    const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
    const glm::dmat4 to_world = above * local_transform(node);
    if (node.mesh >= 0) {
      if (static_cast<std::size_t>(node.mesh) >= model_.meshes.size())
        errors_.fail(fmt::format("node {}", index), fmt::format("refers to mesh {}, which is not there", node.mesh),
                     remedy);
      soup_.left_out.add("nodes");
      for (const tinygltf::Primitive& primitive : model_.meshes[static_cast<std::size_t>(node.mesh)].primitives)
        add(primitive, to_world);
    }
    for (const int child : node.children) visit(child, to_world, depth + 1);
  }

  void add(const tinygltf::Primitive& primitive, const glm::dmat4& to_world) {
    const auto position = primitive.attributes.find("POSITION");
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    if (position == primitive.attributes.end() || mode < TINYGLTF_MODE_TRIANGLES)
      return;  // points and lines have no surface
    if (primitive.extensions.contains(draco)) fail_draco();
    const GltfAccessor positions(views_, position->second, 3);
    const std::size_t first = soup_.positions.size();
    if (positions.count() > max_vertices - first) errors_.fail("", "has more than 2^32 - 2 vertices", "split the mesh");
    for (std::size_t i = 0; i < positions.count(); ++i) {
      const glm::dvec4 p =
          to_world * glm::dvec4(positions.value(i, 0), positions.value(i, 1), positions.value(i, 2), 1.0);
      soup_.add_vertex(p.x, p.y, p.z, 0);
    }
    // A file without materials gets none.
    std::optional<MaterialId> material;
    if (!model_.materials.empty()) material = materials_.id_of(primitive.material);
    const GltfLookup lookup = material ? materials_.lookup(*material) : GltfLookup{};
    count_left_out(primitive, lookup.set, positions.count());
    add_normals(primitive, to_world, first, positions.count());
    add_colors(primitive, first, positions.count());
    add_texture_coordinates(primitive, lookup, first, positions.count());
    add_triangles(primitive, mode, first, positions.count(), glm::determinant(glm::dmat3(to_world)) < 0.0);
    if (material) soup_.polygon_materials.resize(soup_.polygon_count(), *material);
  }

  void count_left_out(const tinygltf::Primitive& primitive, int set, std::size_t vertices) {
    const std::string used = fmt::format("TEXCOORD_{}", set);
    for (const auto& [name, accessor] : primitive.attributes) {
      if (name.starts_with("TEXCOORD_") && name != used) soup_.left_out.add(name, vertices);
      if (name.starts_with("COLOR_") && name != "COLOR_0") soup_.left_out.add(name, vertices);
    }
  }

  void add_normals(const tinygltf::Primitive& primitive, const glm::dmat4& to_world, std::size_t first,
                   std::size_t count) {
    const auto found = primitive.attributes.find("NORMAL");
    if (found == primitive.attributes.end()) return;
    const GltfAccessor normals(views_, found->second, 3);
    if (normals.count() < count)
      errors_.fail(fmt::format("accessor {}", found->second), "has fewer normals than there are vertices", remedy);
    const glm::dmat3 to_world_normal = glm::transpose(glm::inverse(glm::dmat3(to_world)));
    soup_.normals.resize(first, glm::vec3(0.0F));
    for (std::size_t i = 0; i < count; ++i)
      soup_.normals.emplace_back(to_world_normal *
                                 glm::dvec3(normals.value(i, 0), normals.value(i, 1), normals.value(i, 2)));
  }

  void add_colors(const tinygltf::Primitive& primitive, std::size_t first, std::size_t count) {
    const auto found = primitive.attributes.find("COLOR_0");
    if (found == primitive.attributes.end()) return;
    const GltfAccessor colors(views_, found->second, 3);
    if (colors.count() < count)
      errors_.fail(fmt::format("accessor {}", found->second), "has fewer colours than there are vertices", remedy);
    soup_.colors.resize(first, glm::u8vec4(255));
    for (std::size_t i = 0; i < count; ++i) {
      glm::u8vec4 color(255);
      for (int k = 0; k < 3; ++k) color[k] = color_component(linear_to_srgb(colors.value(i, k)));
      if (colors.components() >= 4) color.a = color_component(colors.value(i, 3));
      soup_.colors.push_back(color);
    }
  }

  void add_texture_coordinates(const tinygltf::Primitive& primitive, const GltfLookup& lookup, std::size_t first,
                               std::size_t count) {
    const auto found = primitive.attributes.find(fmt::format("TEXCOORD_{}", lookup.set));
    if (found == primitive.attributes.end()) return;
    const GltfAccessor coordinates(views_, found->second, 2);
    if (coordinates.count() < count)
      errors_.fail(fmt::format("accessor {}", found->second), "has fewer texture coordinates than there are vertices",
                   remedy);
    soup_.texture_coordinates.resize(first, glm::vec2(0.0F));
    for (std::size_t i = 0; i < count; ++i) {
      glm::dvec2 at(coordinates.value(i, 0), coordinates.value(i, 1));
      if (lookup.is_transformed)
        at = lookup.offset + glm::dvec2(glm::dot(lookup.row_u, at), glm::dot(lookup.row_v, at));
      soup_.texture_coordinates.emplace_back(to_float(at.x), to_float(at.y));
    }
  }

  void add_triangles(const tinygltf::Primitive& primitive, int mode, std::size_t first, std::size_t vertices,
                     bool mirrored) {
    std::vector<std::uint64_t> indices(vertices);
    for (std::size_t i = 0; i < vertices; ++i) indices[i] = i;
    if (primitive.indices >= 0) {
      const GltfAccessor accessor(views_, primitive.indices, 1);
      indices.resize(accessor.count());
      for (std::size_t i = 0; i < indices.size(); ++i) {
        const double index = accessor.value(i, 0);
        if (!(index >= 0.0 && index < static_cast<double>(vertices)))
          errors_.fail(fmt::format("accessor {}", primitive.indices),
                       fmt::format("uses vertex {}, but the primitive has only {}", index, vertices), remedy);
        indices[i] = static_cast<std::uint64_t>(index);
      }
    }
    const std::size_t triangles =
        mode == TINYGLTF_MODE_TRIANGLES ? indices.size() / 3 : std::max<std::size_t>(indices.size(), 2) - 2;
    for (std::size_t t = 0; t < triangles; ++t) {
      std::array<std::uint64_t, 3> corners = corners_of(indices, mode, t);
      if (mirrored) std::swap(corners[1], corners[2]);  // as glTF requires: the front stays the front
      for (const std::uint64_t corner : corners) soup_.add_corner(static_cast<VertexId>(first + corner));
      soup_.end_polygon(0);
    }
  }

  static std::array<std::uint64_t, 3> corners_of(const std::vector<std::uint64_t>& indices, int mode, std::size_t t) {
    if (mode == TINYGLTF_MODE_TRIANGLES) return {indices[3 * t], indices[3 * t + 1], indices[3 * t + 2]};
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN) return {indices[0], indices[t + 1], indices[t + 2]};
    // Every second triangle of a strip is reversed.
    return {indices[t], indices[t + 1 + t % 2], indices[t + 2 - t % 2]};
  }

  // Gives primitives a neutral value for attributes that only other primitives have.
  void pad_attributes() {
    if (!soup_.normals.empty()) soup_.normals.resize(soup_.positions.size(), glm::vec3(0.0F));
    if (!soup_.colors.empty()) soup_.colors.resize(soup_.positions.size(), glm::u8vec4(255));
    if (!soup_.texture_coordinates.empty()) soup_.texture_coordinates.resize(soup_.positions.size(), glm::vec2(0.0F));
  }

  static constexpr const char* draco = "KHR_draco_mesh_compression";

  const tinygltf::Model& model_;
  const FileErrors& errors_;
  PolygonSoup soup_;
  GltfViews views_;
  GltfMaterials materials_;
  std::size_t visits_ = 0;
};

// tinygltf's own callbacks expand names through the shell and read any kind of file, even an endless device.
tinygltf::FsCallbacks plain_files() {
  tinygltf::FsCallbacks files{};
  files.FileExists = [](const std::string& name, void*) {
    std::error_code unknown;
    return std::filesystem::is_regular_file(name, unknown);
  };
  files.ExpandFilePath = [](const std::string& name, void*) { return name; };
  files.ReadWholeFile = &tinygltf::ReadWholeFile;
  files.WriteWholeFile = &tinygltf::WriteWholeFile;
  return files;
}

}  // namespace

PolygonSoup parse_gltf(std::string_view bytes, const FileErrors& errors) {
  tinygltf::TinyGLTF loader;
  loader.SetFsCallbacks(plain_files());
  // Images are not decoded; those in buffer views are looked up later, where the view is checked.
  loader.SetImageLoader(
      [](tinygltf::Image* image, const int, std::string*, std::string*, int, int, const unsigned char* data, int size,
         void*) {
        if (image->bufferView < 0) image->image.assign(data, data + size);
        return true;
      },
      nullptr);
  std::string patched;
  bytes = with_missing_buffers(bytes, patched);
  tinygltf::Model model;
  std::string problem, warning;
  const std::string folder = std::filesystem::path(errors.subject()).parent_path().string();
  const auto size = static_cast<unsigned int>(std::min<std::size_t>(bytes.size(), 0xffffffffU));
  bool read = false;
  try {
    read = bytes.substr(0, 4) == "glTF"
               ? loader.LoadBinaryFromMemory(&model, &problem, &warning,
                                             reinterpret_cast<const unsigned char*>(bytes.data()), size, folder)
               : loader.LoadASCIIFromString(&model, &problem, &warning, bytes.data(), size, folder);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {  // tinygltf assumes that all parts of a binary file exist
    problem = "its parts do not fit together";
  }
  if (!read) {
    std::replace(problem.begin(), problem.end(), '\n', ' ');
    errors.fail("", "is not a glTF file that can be read: " + in_quotes(problem), remedy);
  }
  PolygonSoup soup = GltfReader(model, errors).run();
  soup.check(errors);
  return soup;
}

}  // namespace occlod
