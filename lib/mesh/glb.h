// Meshes as glTF has them: a primitive for each material.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/file_input.h"
#include "mesh/materials.h"
#include "occlod/mesh.h"

namespace occlod {

// What has one material: its wedges, and its triangles by places in them.
struct GlbPrimitive {
  MaterialId material = 0;
  std::vector<WedgeId> wedges;
  std::vector<Triangle> triangles;

  // 65535 is no index.
  [[nodiscard]] bool has_short_indices() const noexcept { return wedges.size() < 65535; }
};

// A material's wedges come in the order of their first use; those of a mesh of one material as they are.
[[nodiscard]] std::vector<GlbPrimitive> glb_primitives(const TriangleMesh& mesh);

// The JSON of a binary glTF file and the places of what its buffer holds. The bytes of the buffer are the caller's.

// What glTF numbers.
namespace gltf {
inline constexpr int type_int8 = 5120, type_uint16 = 5123, type_uint32 = 5125, type_float = 5126;
inline constexpr int array_buffer = 34962, element_array_buffer = 34963;
}  // namespace gltf

// One scene of one node of one mesh without primitives, at first.
class GlbDocument {
 public:
  using Json = nlohmann::ordered_json;

  GlbDocument();

  [[nodiscard]] Json& json() noexcept { return json_; }
  [[nodiscard]] Json& node() { return json_["nodes"][0]; }
  [[nodiscard]] Json& primitives() { return json_["meshes"][0]["primitives"]; }

  // Makes room in the buffer, of a multiple of four bytes, and says from which byte on.
  std::uint64_t reserve(std::uint64_t bytes);
  // The same with a buffer view of it, whose number it returns. `target`: 0 for none.
  std::size_t add_view(std::uint64_t bytes, int target);
  // With a view of its own.
  std::size_t add_accessor(std::uint64_t bytes, int target, int component_type, std::size_t count, const char* type);
  // Not metallic, and blended where it is transparent.
  void add_material(const Material& material);
  // `image`: where it is, as glTF has it.
  void add_texture(const Texture& texture, Json image);

  // All that comes before the bytes of the buffer. Fails when the file would be larger than GLB files can be.
  [[nodiscard]] std::string head(const FileErrors& errors);

 private:
  Json json_;
  std::uint64_t bytes_ = 0;  // of the buffer
};

// The name of a file as a URI.
[[nodiscard]] std::string uri_of(const std::string& file);

// Of an sRGB channel: glTF's are linear.
[[nodiscard]] std::uint16_t linear_color(std::uint8_t encoded);

}  // namespace occlod
