// Our own writer of binary glTF: tinygltf's holds the whole file in memory several times.
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/file_input.h"
#include "mesh/glb_document.h"
#include "mesh/glb_primitives.h"
#include "mesh/mesh_writers.h"

namespace occlod {
namespace {

using Json = GlbDocument::Json;
using namespace gltf;

class GlbWriter {
 public:
  GlbWriter(ChunkedWriter& out, const TriangleMesh& mesh) : out_(out), mesh_(mesh), primitives_(glb_primitives(mesh)) {}

  void run(const FileErrors& errors) {
    for (const GlbPrimitive& primitive : primitives_) describe(primitive);
    for (const Material& material : mesh_.materials) document_.add_material(material);
    for (const Texture& texture : mesh_.textures) document_.add_texture(texture, image_of(texture));
    out_.text("{}", document_.head(errors));
    for (const GlbPrimitive& primitive : primitives_) write(primitive);
    for (const Texture& texture : mesh_.textures) write_image(texture);
  }

 private:
  std::size_t add_accessor(std::uint64_t bytes, int target, int component_type, std::size_t count, const char* type) {
    return document_.add_accessor(bytes, target, component_type, count, type);
  }

  // In the order in which write() writes.
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

  Json image_of(const Texture& texture) {
    if (texture.bytes.empty()) return {{"uri", uri_of(texture.file)}};
    return {{"bufferView", document_.add_view(texture.bytes.size(), 0)}, {"mimeType", mime_type_of(texture)}};
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

  void write_image(const Texture& texture) {
    if (texture.bytes.empty()) return;
    for (const std::uint8_t byte : texture.bytes) out_.numbers(byte);
    for (std::size_t i = texture.bytes.size(); i % 4 != 0; ++i) out_.numbers(std::uint8_t{0});
  }

  ChunkedWriter& out_;
  const TriangleMesh& mesh_;
  const std::vector<GlbPrimitive> primitives_;
  GlbDocument document_;
};

}  // namespace

void write_glb(ChunkedWriter& out, const TriangleMesh& mesh, const std::filesystem::path& path) {
  GlbWriter(out, mesh).run(FileErrors(path));
}

}  // namespace occlod
