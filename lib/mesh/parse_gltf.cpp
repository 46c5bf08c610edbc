// Reads glTF 2.0, text and binary, through tinygltf: the triangles of every mesh that the default scene places, in
// world space, skins and morph targets as they are without an animation. tinygltf parses; that nodes form a tree is
// checked here.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <filesystem>
#include <glm/mat2x2.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "base/strict_json.h"
#include "mesh/data_uri.h"
#include "mesh/gltf_accessor.h"
#include "mesh/gltf_features.h"
#include "mesh/gltf_materials.h"
#include "mesh/gltf_names.h"
#include "mesh/gltf_pose.h"
#include "mesh/materials.h"
#include "mesh/mesh_files.h"
#include "mesh/polygon_soup.h"
#include "mesh/tinygltf.h"

namespace occlod {
namespace {

constexpr const char* remedy = gltf_remedy;
constexpr std::size_t max_depth = 256;  // depth of the node tree; a deeper one is treated as a cycle

// What is carried of extensions; all others are counted.
constexpr std::array<std::string_view, 11> carried_extensions{
    "KHR_mesh_quantization",   "KHR_texture_transform", "KHR_materials_unlit",    "EXT_meshopt_compression",
    "EXT_mesh_gpu_instancing", "EXT_texture_webp",      "KHR_texture_basisu",     "MSFT_texture_dds",
    "EXT_texture_avif",        "EXT_mesh_features",     "EXT_structural_metadata"};

bool is_carried(std::string_view extension) {
  return std::ranges::find(carried_extensions, extension) != carried_extensions.end();
}

class GltfReader {
 public:
  // `text` is the JSON of the model.
  GltfReader(const tinygltf::Model& model, std::string_view text, const FileErrors& errors)
      : model_(model),
        text_(text),
        errors_(errors),
        views_(model, errors),
        skins_(views_),
        materials_(views_, soup_),
        features_(views_, soup_) {}

  PolygonSoup run() {
    for (const std::string& extension : model_.extensionsRequired) check_extension(extension);
    for (const int root : roots()) visit(root, glm::dmat4(1.0), {}, 0);
    pad_attributes();
    drop_unnamed_features(soup_);
    count_left_out();
    soup_.texture_origin = TextureOrigin::top_left;
    soup_.up = UpAxis::y;
    return std::move(soup_);
  }

 private:
  // Refuses required extensions that are not supported. Of the older model of specular colours, the diffuse colour is.
  void check_extension(const std::string& name) const {
    if (is_carried(name) || name == "KHR_materials_pbrSpecularGlossiness") return;
    if (name == draco) fail_draco();
    errors_.fail("", fmt::format("needs the extension {}, which is not supported", in_quotes(name)),
                 "export the mesh without it");
  }
  [[noreturn]] void fail_draco() const {
    errors_.fail("", "is compressed with Draco, which is not supported",
                 "decompress the file: gltf-transform copy IN OUT, or export it without Draco");
  }

  // Counts what the file has and a mesh lacks, apart from what nodes place.
  void count_left_out() {
    LeftOut& left_out = soup_.left_out;
    for (const auto& [name, count] : count_extensions(text_))
      if (!is_carried(name)) left_out.add(name, count);
    for (const std::string& name : model_.extensionsUsed)
      if (!is_carried(name) && left_out.count(name) == 0) left_out.add(name);
    left_out.add("extras", count_key(text_, "extras"));
    left_out.add("animations", model_.animations.size());
    left_out.add("cameras", model_.cameras.size());
    left_out.add("copyright", model_.asset.copyright.empty() ? 0 : 1);
    left_out.add("other scenes", model_.scenes.empty() ? 0 : model_.scenes.size() - 1);
    std::vector<bool> is_placed(model_.meshes.size(), false);
    for (const int mesh : placed_meshes_) is_placed[static_cast<std::size_t>(mesh)] = true;
    left_out.add("meshes that the scene does not place",
                 static_cast<std::uint64_t>(std::count(is_placed.begin(), is_placed.end(), false)));
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

  // `name_above` is that of the nearest node above that has one.
  void visit(int index, const glm::dmat4& above, const std::string& name_above, std::size_t depth) {
    if (index < 0 || static_cast<std::size_t>(index) >= model_.nodes.size())
      errors_.fail("", fmt::format("refers to node {}, which is not there", index), remedy);
    // A tree visits each node once; more visits than nodes means that nodes are shared or form a cycle.
    if (depth > max_depth || ++visits_ > model_.nodes.size())
      errors_.fail(fmt::format("node {}", index), "is not part of a tree of nodes", remedy);
    const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
    const glm::dmat4 to_world = above * local_transform(node);
    const std::string& name = node.name.empty() ? name_above : node.name;
    if (node.mesh >= 0) place(node, index, to_world, name);
    for (const int child : node.children) visit(child, to_world, name, depth + 1);
  }

  // Adds the mesh of a node, as often as it has instances. Joints alone place a mesh with a skin, and only once.
  void place(const tinygltf::Node& node, int index, const glm::dmat4& to_world, const std::string& name) {
    if (static_cast<std::size_t>(node.mesh) >= model_.meshes.size())
      errors_.fail(fmt::format("node {}", index), fmt::format("refers to mesh {}, which is not there", node.mesh),
                   remedy);
    placed_meshes_.insert(node.mesh);
    const tinygltf::Mesh& mesh = model_.meshes[static_cast<std::size_t>(node.mesh)];
    features_.begin_node(readable(name.empty() ? mesh.name : name));
    const std::vector<double>& weights = node.weights.empty() ? mesh.weights : node.weights;
    if (node.skin >= 0) {
      soup_.left_out.add("skins (as the joints are placed)");
      soup_.left_out.add("instances of skins", node.extensions.contains("EXT_mesh_gpu_instancing") ? 1 : 0);
      const std::vector<glm::dmat4>& joints = skins_.matrices(node.skin);
      for (const tinygltf::Primitive& primitive : mesh.primitives) add(primitive, to_world, &joints, weights);
      return;
    }
    for (const glm::dmat4& instance : instances_of(views_, node, soup_.left_out))
      for (const tinygltf::Primitive& primitive : mesh.primitives)
        add(primitive, to_world * instance, nullptr, weights);
  }

  void add(const tinygltf::Primitive& primitive, const glm::dmat4& to_world, const std::vector<glm::dmat4>* joints,
           const std::vector<double>& weights) {
    const auto position = primitive.attributes.find("POSITION");
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    constexpr std::array<const char*, TINYGLTF_MODE_TRIANGLES> without_surface{"points", "lines", "line loops",
                                                                               "line strips"};
    if (mode < TINYGLTF_MODE_TRIANGLES)
      return soup_.left_out.add(fmt::format("primitives of {}", without_surface[static_cast<std::size_t>(mode)]));
    if (position == primitive.attributes.end()) return soup_.left_out.add("primitives without POSITION");
    if (primitive.extensions.contains(draco)) fail_draco();
    const MorphedAttribute positions(views_, primitive, "POSITION", weights);
    const std::size_t first = soup_.positions.size();
    if (positions.count() > max_vertices - first) errors_.fail("", "has more than 2^32 - 2 vertices", "split the mesh");
    const GltfPlacement placement(views_, primitive, positions.count(), to_world, joints);
    for (std::size_t i = 0; i < positions.count(); ++i) {
      const glm::dvec4 p = placement.of_vertex(i) * glm::dvec4(positions.value(i), 1.0);
      soup_.add_vertex(p.x, p.y, p.z, 0);
    }
    // A file without materials gets none.
    std::optional<MaterialId> material;
    if (!model_.materials.empty()) material = materials_.id_of(primitive.material);
    const GltfLookup lookup = material ? materials_.lookup(*material) : GltfLookup{};
    features_.begin_primitive(primitive, positions.count());
    count_left_out(primitive, lookup.set, positions.count(), placement.is_skinned());
    add_normals(primitive, placement, weights, first, positions.count());
    add_colors(primitive, first, positions.count());
    add_texture_coordinates(primitive, lookup, first, positions.count());
    add_triangles(primitive, mode, first, positions.count(), placement);
    if (material) soup_.polygon_materials.resize(soup_.polygon_count(), *material);
  }

  void count_left_out(const tinygltf::Primitive& primitive, int set, std::size_t vertices, bool is_skinned) {
    const std::string used = fmt::format("TEXCOORD_{}", set);
    const auto is_kept = [&](const std::string& name) {
      const bool poses = name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_");
      return name == "POSITION" || name == "NORMAL" || name == "COLOR_0" || name == used ||
             name == features_.attribute() || (is_skinned && poses);
    };
    for (const auto& [name, accessor] : primitive.attributes)
      if (!is_kept(name)) soup_.left_out.add(name, vertices);
    soup_.left_out.add("morph targets (at their default weights)", primitive.targets.size());
    for (const auto& target : primitive.targets)
      for (const auto& [name, accessor] : target)
        if (name != "POSITION" && name != "NORMAL") soup_.left_out.add(name + " of morph targets", vertices);
  }

  void add_normals(const tinygltf::Primitive& primitive, const GltfPlacement& placement,
                   const std::vector<double>& weights, std::size_t first, std::size_t count) {
    const auto found = primitive.attributes.find("NORMAL");
    if (found == primitive.attributes.end()) return;
    const MorphedAttribute normals(views_, primitive, "NORMAL", weights);
    if (normals.count() < count)
      errors_.fail(fmt::format("accessor {}", found->second), "has fewer normals than there are vertices", remedy);
    const auto to_world_of = [&](std::size_t i) {
      return glm::transpose(glm::inverse(glm::dmat3(placement.of_vertex(i))));
    };
    glm::dmat3 to_world(1.0);
    soup_.normals.resize(first, glm::vec3(0.0F));
    for (std::size_t i = 0; i < count; ++i) {
      if (i == 0 || placement.is_skinned()) to_world = to_world_of(i);
      soup_.normals.emplace_back(to_world * normals.value(i));
    }
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
    const glm::dmat2 matrix = lookup.matrix();
    soup_.texture_coordinates.resize(first, glm::vec2(0.0F));
    for (std::size_t i = 0; i < count; ++i) {
      glm::dvec2 at(coordinates.value(i, 0), coordinates.value(i, 1));
      if (lookup.is_transformed()) at = lookup.offset + matrix * at;
      soup_.texture_coordinates.emplace_back(to_float(at.x), to_float(at.y));
    }
  }

  void add_triangles(const tinygltf::Primitive& primitive, int mode, std::size_t first, std::size_t vertices,
                     const GltfPlacement& placement) {
    const auto mirrors = [&](std::uint64_t vertex) {
      return glm::determinant(glm::dmat3(placement.of_vertex(vertex))) < 0.0;
    };
    bool is_mirrored = !placement.is_skinned() && mirrors(0);
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
      if (placement.is_skinned()) is_mirrored = mirrors(corners[0]);
      if (is_mirrored) std::swap(corners[1], corners[2]);  // as glTF requires: the front stays the front
      for (const std::uint64_t corner : corners) soup_.add_corner(static_cast<VertexId>(first + corner));
      soup_.end_polygon(0);
      soup_.give_feature(soup_.polygon_count() - 1, features_.of_vertex(corners[0]));
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
  std::string_view text_;
  const FileErrors& errors_;
  PolygonSoup soup_;
  GltfViews views_;
  GltfSkins skins_;
  GltfMaterials materials_;
  GltfFeatures features_;
  std::set<int> placed_meshes_;
  std::size_t visits_ = 0;
};

// What tinygltf reads beside the file itself. Its own callbacks expand names through the shell and read any kind of
// file, even an endless device, and it knows data URIs of a few media types only.
class FilesBeside {
 public:
  explicit FilesBeside(std::string folder) : folder_(std::move(folder)) {}

  // The result refers to this object.
  [[nodiscard]] tinygltf::FsCallbacks callbacks() {
    tinygltf::FsCallbacks files{};
    files.user_data = this;
    files.FileExists = [](const std::string& name, void* self) {
      return static_cast<FilesBeside*>(self)->data_uri(name).has_value() || !existing(name).empty();
    };
    files.ExpandFilePath = [](const std::string& name, void*) { return name; };
    files.ReadWholeFile = [](std::vector<unsigned char>* bytes, std::string* problem, const std::string& name,
                             void* self) {
      if (const auto uri = static_cast<FilesBeside*>(self)->data_uri(name))
        return static_cast<FilesBeside*>(self)->decode(*uri, *bytes);
      return tinygltf::ReadWholeFile(bytes, problem, existing(name), nullptr);
    };
    files.WriteWholeFile = &tinygltf::WriteWholeFile;
    return files;
  }
  // Returns what is wrong with a data URI, if anything is.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  // Returns a name as it is, or with '+' where tinygltf has made a blank of it; empty when there is no such file.
  [[nodiscard]] static std::string existing(std::string name) {
    std::error_code unknown;
    if (std::filesystem::is_regular_file(name, unknown)) return name;
    std::ranges::replace(name, ' ', '+');
    return std::filesystem::is_regular_file(name, unknown) ? name : std::string();
  }

  // tinygltf takes data URIs that it does not know for names of files in the folder.
  [[nodiscard]] std::optional<DataUri> data_uri(std::string_view name) const {
    if (name.starts_with(folder_)) name.remove_prefix(folder_.size());
    while (name.starts_with('/')) name.remove_prefix(1);
    return parse_data_uri(name);
  }

  bool decode(const DataUri& uri, std::vector<unsigned char>& bytes) {
    const auto decoded = uri.is_base64 ? decode_base64(uri.data) : std::nullopt;
    if (decoded)
      bytes = *decoded;
    else
      problem_ = fmt::format("has a buffer as a data URI of media type {}, which is not base64",
                             uri.media_type.empty() ? "text/plain" : in_quotes(uri.media_type));
    return decoded.has_value();
  }

  std::string folder_;
  std::string problem_;
};

}  // namespace

PolygonSoup parse_gltf(std::string_view bytes, const FileErrors& errors) {
  if (is_nested_too_deeply(gltf_text(bytes)))
    errors.fail("", fmt::format("has JSON with more than {} nested arrays and objects", max_json_depth),
                "export the mesh without extras");
  const std::string folder = std::filesystem::path(errors.subject()).parent_path().string();
  FilesBeside files(folder);
  tinygltf::TinyGLTF loader;
  loader.SetFsCallbacks(files.callbacks());
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
  if (!files.problem().empty()) errors.fail("", files.problem(), remedy);
  if (!read) {
    std::replace(problem.begin(), problem.end(), '\n', ' ');
    errors.fail("", "is not a glTF file that can be read: " + in_quotes(problem), remedy);
  }
  PolygonSoup soup = GltfReader(model, gltf_text(bytes), errors).run();
  soup.check(errors);
  return soup;
}

}  // namespace occlod
