// glTF 2.0, text and binary, through tinygltf: the triangles of every mesh that the default scene places, in world
// space. tinygltf parses; what it leaves unchecked, that accessors stay inside their buffers and nodes form a tree, is
// checked here.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <filesystem>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <new>
#include <set>
#include <string>
#include <system_error>

#include "io/polygon_soup.h"
#include "io/tinygltf.h"

namespace occlod {
namespace {

constexpr const char* remedy = "export the mesh again";
constexpr std::size_t most_depth = 256;  // of the node tree: deeper ones are taken for cycles

// Typed reading of one accessor.
class Accessor {
 public:
  Accessor(const tinygltf::Model& model, int index, int components, const FileErrors& errors) {
    if (index < 0 || static_cast<std::size_t>(index) >= model.accessors.size())
      errors.fail("", fmt::format("refers to accessor {}, which is not there", index), remedy);
    const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
    const std::string place = fmt::format("accessor {}", index);
    if (accessor.sparse.isSparse)
      errors.fail(place, "is sparse, which is not supported", "export the mesh without sparse accessors");
    component_type_ = accessor.componentType;
    components_ = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
    if (components_ < components) errors.fail(place, "has too few components", remedy);
    count_ = accessor.count;
    normalized_ = accessor.normalized;
    const auto view_index = static_cast<std::size_t>(accessor.bufferView);
    if (accessor.bufferView < 0 || view_index >= model.bufferViews.size()) errors.fail(place, "has no data", remedy);
    const tinygltf::BufferView& view = model.bufferViews[view_index];
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model.buffers.size())
      errors.fail(place, "has no buffer", remedy);
    const std::vector<unsigned char>& buffer = model.buffers[static_cast<std::size_t>(view.buffer)].data;
    const int stride = accessor.ByteStride(view);
    const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component_type_)) * components_;
    if (stride <= 0 || size <= 0) errors.fail(place, "has elements of unknown size", remedy);
    stride_ = static_cast<std::size_t>(stride);
    const std::size_t offset = view.byteOffset + accessor.byteOffset;
    const bool fits =
        offset <= buffer.size() &&
        (count_ == 0 || (static_cast<std::size_t>(size) <= buffer.size() - offset &&
                         count_ - 1 <= (buffer.size() - offset - static_cast<std::size_t>(size)) / stride_));
    if (!fits) errors.fail(place, "reaches beyond its buffer: the file was cut or is malformed", remedy);
    data_ = buffer.data() + offset;
  }

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] int components() const { return components_; }

  // Component k of element i; normalized integers become fractions.
  [[nodiscard]] double value(std::size_t i, int k) const {
    switch (component_type_) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return fraction(load<std::uint8_t>(i, k));
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return fraction(load<std::uint16_t>(i, k));
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return load<std::uint32_t>(i, k);
      case TINYGLTF_COMPONENT_TYPE_BYTE:
        return fraction(load<std::int8_t>(i, k));
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        return fraction(load<std::int16_t>(i, k));
      case TINYGLTF_COMPONENT_TYPE_INT:
        return load<std::int32_t>(i, k);
      case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return static_cast<double>(load<float>(i, k));
      default:
        return load<double>(i, k);
    }
  }

 private:
  template <typename T>
  [[nodiscard]] T load(std::size_t i, int k) const {
    T x;
    std::memcpy(&x, data_ + i * stride_ + static_cast<std::size_t>(k) * sizeof(T), sizeof(T));
    return x;
  }

  template <typename T>
  [[nodiscard]] double fraction(T x) const {
    return normalized_ ? std::max(-1.0, static_cast<double>(x) / std::numeric_limits<T>::max())
                       : static_cast<double>(x);
  }

  const unsigned char* data_ = nullptr;
  std::size_t count_ = 0;
  std::size_t stride_ = 0;
  int component_type_ = 0;
  int components_ = 0;
  bool normalized_ = false;
};

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
  GltfReader(const tinygltf::Model& model, const FileErrors& errors) : model_(model), errors_(errors) {}

  PolygonSoup run() {
    for (const std::string& extension : model_.extensionsRequired)
      if (extension != "KHR_mesh_quantization" && extension.rfind("KHR_materials", 0) != 0 &&
          extension != "KHR_texture_transform")
        errors_.fail("", fmt::format("needs the extension {}, which is not supported", extension),
                     "export the mesh without it");
    for (const int root : roots()) visit(root, glm::dmat4(1.0), 0);
    pad_attributes();
    soup_.left_out.materials = materials_.size();
    return std::move(soup_);
  }

 private:
  // The nodes of the default scene, or every node without a parent.
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
    if (depth > most_depth || ++visits_ > model_.nodes.size())
      errors_.fail(fmt::format("node {}", index), "is not part of a tree of nodes", remedy);
    const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
    const glm::dmat4 to_world = above * local_transform(node);
    if (node.mesh >= 0) {
      if (static_cast<std::size_t>(node.mesh) >= model_.meshes.size())
        errors_.fail(fmt::format("node {}", index), fmt::format("refers to mesh {}, which is not there", node.mesh),
                     remedy);
      ++soup_.left_out.groups;
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
    const Accessor positions(model_, position->second, 3, errors_);
    const std::size_t first = soup_.positions.size();
    if (positions.count() > max_vertices - first) errors_.fail("", "has more than 2^32 - 2 vertices", "split the mesh");
    for (std::size_t i = 0; i < positions.count(); ++i) {
      const glm::dvec4 p =
          to_world * glm::dvec4(positions.value(i, 0), positions.value(i, 1), positions.value(i, 2), 1.0);
      soup_.add_vertex(p.x, p.y, p.z, 0);
    }
    count_left_out(primitive, positions.count());
    add_normals(primitive, to_world, first, positions.count());
    add_colors(primitive, first, positions.count());
    add_triangles(primitive, mode, first, positions.count(), glm::determinant(glm::dmat3(to_world)) < 0.0);
  }

  void count_left_out(const tinygltf::Primitive& primitive, std::size_t vertices) {
    for (const auto& [name, accessor] : primitive.attributes) {
      if (name.starts_with("TEXCOORD_")) soup_.left_out.texture_coordinates += vertices;
      if (name.starts_with("COLOR_") && name != "COLOR_0") soup_.left_out.colors += vertices;
    }
    if (primitive.material >= 0) materials_.insert(primitive.material);
  }

  void add_normals(const tinygltf::Primitive& primitive, const glm::dmat4& to_world, std::size_t first,
                   std::size_t count) {
    const auto found = primitive.attributes.find("NORMAL");
    if (found == primitive.attributes.end()) return;
    const Accessor normals(model_, found->second, 3, errors_);
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
    const Accessor colors(model_, found->second, 3, errors_);
    if (colors.count() < count)
      errors_.fail(fmt::format("accessor {}", found->second), "has fewer colours than there are vertices", remedy);
    soup_.colors.resize(first, glm::u8vec4(255));
    for (std::size_t i = 0; i < count; ++i) {
      glm::u8vec4 color(255);
      for (int k = 0; k < std::min(colors.components(), 4); ++k) color[k] = color_component(colors.value(i, k));
      soup_.colors.push_back(color);
    }
  }

  void add_triangles(const tinygltf::Primitive& primitive, int mode, std::size_t first, std::size_t vertices,
                     bool mirrored) {
    std::vector<std::uint64_t> indices(vertices);
    for (std::size_t i = 0; i < vertices; ++i) indices[i] = i;
    if (primitive.indices >= 0) {
      const Accessor accessor(model_, primitive.indices, 1, errors_);
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
      if (mirrored) std::swap(corners[1], corners[2]);  // as glTF asks: the front stays the front
      for (const std::uint64_t corner : corners) soup_.add_corner(static_cast<VertexId>(first + corner));
      soup_.end_polygon(0);
    }
  }

  static std::array<std::uint64_t, 3> corners_of(const std::vector<std::uint64_t>& indices, int mode, std::size_t t) {
    if (mode == TINYGLTF_MODE_TRIANGLES) return {indices[3 * t], indices[3 * t + 1], indices[3 * t + 2]};
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN) return {indices[0], indices[t + 1], indices[t + 2]};
    // Every second triangle of a strip runs the other way round.
    return {indices[t], indices[t + 1 + t % 2], indices[t + 2 - t % 2]};
  }

  // Primitives without an attribute that others have get a neutral one.
  void pad_attributes() {
    if (!soup_.normals.empty()) soup_.normals.resize(soup_.positions.size(), glm::vec3(0.0F));
    if (!soup_.colors.empty()) soup_.colors.resize(soup_.positions.size(), glm::u8vec4(255));
  }

  const tinygltf::Model& model_;
  const FileErrors& errors_;
  PolygonSoup soup_;
  std::size_t visits_ = 0;
  std::set<int> materials_;
};

// tinygltf's own callbacks expand names through the shell and read from anything of that name, even an endless device.
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
  // Textures are not read.
  loader.SetImageLoader([](tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int,
                           void*) { return true; },
                        nullptr);
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
  } catch (const std::exception&) {  // it assumes that all parts of a binary file are there
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
