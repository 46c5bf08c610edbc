// A binary glTF file of clusters: arrays for renderers that choose clusters themselves, and the input as a mesh for all
// others.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "base/file_input.h"
#include "hlod/tiles/encode_tile.h"
#include "mesh/glb.h"
#include "mesh/glb_look.h"
#include "mesh/image_files.h"
#include "mesh/mesh_writers.h"
#include "occlod/clusters.h"

namespace occlod::hlod {
namespace {

using Json = GlbDocument::Json;
using tiles::ByteStream;

enum class ViewKind { attributes, indices, table };

class ClusterWriter {
 public:
  ClusterWriter(const ClusterLod& lod, bool compresses) : lod_(lod), mesh_(lod.vertices), compresses_(compresses) {}

  void run(ChunkedWriter& out, const MeshOutput& output) {
    const glm::dvec3& o = mesh_.origin;
    if (o != glm::dvec3(0.0)) document_.node()["translation"] = {o.x, o.y, o.z};
    const Json attributes = add_vertices();
    const std::size_t index_view = add_indices();
    add_primitives(attributes, index_view);
    const GlbLook look(mesh_, output);
    Json& extras = document_.json()["meshes"][0]["extras"]["clusters"];
    extras = {{"version", 1}, {"levels", lod_.clusters.empty() ? 0 : lod_.clusters.back().level + 1}};
    extras["indices"] = add_accessor(index_view, 0, lod_.indices.size(), gltf::type_uint32, "SCALAR");
    extras["groupCount"] = lod_.groups.size();
    extras["groups"] = add_groups();
    extras["clusterCount"] = lod_.clusters.size();
    extras["clusters"] = add_clusters();
    look.describe(document_);
    if (compresses_) {
      document_.use_extension("EXT_meshopt_compression", true);
      // This buffer is for readers without the extension. There are none, because the extension is required.
      document_.json()["buffers"][1] = {{"byteLength", fallback_bytes_},
                                        {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}};
    }
    out.text("{}", document_.head(FileErrors(output.path)));
    for (const std::string& bytes : contents_) {
      for (const char byte : bytes) out.numbers(static_cast<std::uint8_t>(byte));
      for (std::size_t i = bytes.size(); i % 4 != 0; ++i) out.numbers(std::uint8_t{0});
    }
    look.write(out);
  }

 private:
  Json add_vertices() {
    const std::size_t count = mesh_.positions.size();
    Json attributes;
    ByteStream positions(12, count);
    glm::vec3 least(std::numeric_limits<float>::infinity()), most(-least);
    for (const glm::vec3& p : mesh_.positions) {
      positions.add(p.x, p.y, p.z);
      least = glm::min(least, p);
      most = glm::max(most, p);
    }
    attributes["POSITION"] = add_attribute(positions, gltf::type_float, "VEC3");
    document_.json()["accessors"].back()["min"] = {least.x, least.y, least.z};
    document_.json()["accessors"].back()["max"] = {most.x, most.y, most.z};
    if (!mesh_.normals.empty()) {
      ByteStream normals(12, count);
      for (const glm::vec3& n : mesh_.normals) normals.add(n.x, n.y, n.z);
      attributes["NORMAL"] = add_attribute(normals, gltf::type_float, "VEC3");
    }
    if (!mesh_.texture_coordinates.empty()) {
      const bool flip = mesh_.texture_origin != TextureOrigin::top_left;
      ByteStream places(8, count);
      for (const glm::vec2& at : mesh_.texture_coordinates) places.add(at.x, flip ? from_other_origin(at.y) : at.y);
      attributes["TEXCOORD_0"] = add_attribute(places, gltf::type_float, "VEC2");
    }
    if (!mesh_.colors.empty()) {
      ByteStream colors(8, count);
      for (const glm::u8vec4& c : mesh_.colors)
        colors.add(linear_color(c.r), linear_color(c.g), linear_color(c.b), static_cast<std::uint16_t>(257 * c.a));
      attributes["COLOR_0"] = add_attribute(colors, gltf::type_uint16, "VEC4");
      document_.json()["accessors"].back()["normalized"] = true;
    }
    return attributes;
  }

  std::size_t add_indices() {
    ByteStream stream(4, lod_.indices.size());
    for (const std::uint32_t index : lod_.indices) stream.add(index);
    return add_view(stream, ViewKind::indices);
  }

  // Adds the input, a primitive for each material.
  void add_primitives(const Json& attributes, std::size_t index_view) {
    std::vector<std::uint64_t> counts(std::max<std::size_t>(1, mesh_.materials.size()), 0);
    for (const Cluster& cluster : lod_.clusters)
      if (cluster.level == 0) counts[cluster.material] += cluster.index_count;
    std::uint64_t first = 0;
    for (std::size_t material = 0; material < counts.size(); ++material) {
      if (counts[material] == 0) continue;
      Json primitive = {{"attributes", attributes}};
      primitive["indices"] = add_accessor(index_view, 4 * first, counts[material], gltf::type_uint32, "SCALAR");
      if (!mesh_.materials.empty()) primitive["material"] = material;
      document_.primitives().push_back(std::move(primitive));
      first += counts[material];
    }
  }

  std::size_t add_groups() {
    ByteStream stream(32, lod_.groups.size());
    for (const ClusterGroup& group : lod_.groups) {
      const auto& [c, radius] = group.sphere;
      stream.add(c.x, c.y, c.z, radius, group.error, group.first_cluster, group.cluster_count, group.level);
    }
    return add_view(stream, ViewKind::table);
  }

  std::size_t add_clusters() {
    ByteStream stream(48, lod_.clusters.size());
    for (const Cluster& cluster : lod_.clusters) {
      const auto& [c, radius] = cluster.sphere;
      stream.add(c.x, c.y, c.z, radius, cluster.error, cluster.first_index, cluster.index_count, cluster.vertex_count,
                 cluster.group, cluster.refined, std::uint32_t{cluster.material}, cluster.level);
    }
    return add_view(stream, ViewKind::table);
  }

  std::size_t add_attribute(const ByteStream& stream, int component_type, const char* type) {
    return add_accessor(add_view(stream, ViewKind::attributes), 0, stream.count(), component_type, type);
  }

  std::size_t add_accessor(std::size_t view, std::uint64_t offset, std::size_t count, int component_type,
                           const char* type) {
    Json accessor = {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}};
    if (offset > 0) accessor["byteOffset"] = offset;
    document_.json()["accessors"].push_back(std::move(accessor));
    return document_.json()["accessors"].size() - 1;
  }

  std::size_t add_view(const ByteStream& stream, ViewKind kind) {
    contents_.push_back(!compresses_                ? stream.bytes()
                        : kind == ViewKind::indices ? tiles::encode_triangles(lod_.indices, mesh_.positions.size())
                                                    : tiles::encode_vertices(stream));
    const std::size_t bytes = contents_.back().size();
    Json view = {{"buffer", 0}, {"byteOffset", document_.reserve(bytes)}, {"byteLength", bytes}};
    if (compresses_) {
      view["byteStride"] = stream.stride();
      view["mode"] = kind == ViewKind::indices ? "TRIANGLES" : "ATTRIBUTES";
      view["count"] = stream.count();
      view = {{"buffer", 1},
              {"byteOffset", fallback_bytes_},
              {"byteLength", stream.bytes().size()},
              {"extensions", {{"EXT_meshopt_compression", std::move(view)}}}};
      fallback_bytes_ += stream.bytes().size();  // a multiple of 4
    }
    if (kind == ViewKind::attributes) view["byteStride"] = stream.stride();
    if (kind != ViewKind::table)
      view["target"] = kind == ViewKind::indices ? gltf::element_array_buffer : gltf::array_buffer;
    Json& views = document_.json()["bufferViews"];
    views.push_back(std::move(view));
    return views.size() - 1;
  }

  const ClusterLod& lod_;
  const TriangleMesh& mesh_;
  const bool compresses_;
  GlbDocument document_;
  std::vector<std::string> contents_;  // of the buffer, each padded to four bytes
  std::uint64_t fallback_bytes_ = 0;   // size of the buffer that readers fill
};

}  // namespace

std::vector<std::string> write_clusters(const std::filesystem::path& path, const ClusterLod& lod,
                                        const ClusterFileOptions& options) {
  if (options.compresses && !tiles::has_meshopt())
    throw Error({path.string(), "", "cannot be compressed: this build is without meshoptimizer",
                 "write it uncompressed, or build with OCCLOD_WITH_MESHOPTIMIZER"});
  const std::filesystem::path image_folder = options.image_folder.empty() ? folder_of(path) : options.image_folder;
  std::vector<std::string> notes;
  AtomicFile file(path);
  ChunkedWriter out(file);
  ClusterWriter(lod, options.compresses).run(out, {path, image_folder, notes});
  out.flush();
  file.commit();
  return notes;
}

}  // namespace occlod::hlod
