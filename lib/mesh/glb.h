// Binary glTF (GLB) for writers: a mesh as primitives, one per material, and the JSON of the file.
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

// The part of a mesh with one material: its wedges, and its triangles as indices into them.
struct GlbPrimitive {
  MaterialId material = 0;
  std::vector<WedgeId> wedges;
  std::vector<Triangle> triangles;

  // True when 16-bit indices suffice; 65535 is not a valid index.
  [[nodiscard]] bool has_short_indices() const noexcept { return wedges.size() < 65535; }
};

// Splits a mesh into primitives. A material's wedges come in the order of their first use; those of a mesh with a
// single material keep their order.
[[nodiscard]] std::vector<GlbPrimitive> glb_primitives(const TriangleMesh& mesh);

// Constants of glTF.
namespace gltf {
inline constexpr int type_int8 = 5120, type_uint16 = 5123, type_uint32 = 5125, type_float = 5126;
inline constexpr int array_buffer = 34962, element_array_buffer = 34963;
}  // namespace gltf

// The JSON of a binary glTF file and the layout of its buffer; the caller writes the bytes of the buffer. It starts
// with one scene of one node of one mesh without primitives.
class GlbDocument {
 public:
  using Json = nlohmann::ordered_json;

  GlbDocument();

  [[nodiscard]] Json& json() noexcept { return json_; }
  [[nodiscard]] Json& node() { return json_["nodes"][0]; }
  [[nodiscard]] Json& primitives() { return json_["meshes"][0]["primitives"]; }

  // Reserves a multiple of four bytes in the buffer and returns the position of the first.
  std::uint64_t reserve(std::uint64_t bytes);
  // Reserves bytes in the buffer with a buffer view over them, and returns the view's number. `target` is 0 for none.
  std::size_t add_view(std::uint64_t bytes, int target);
  // Reserves bytes in the buffer for an accessor with its own buffer view, and returns the accessor's number.
  std::size_t add_accessor(std::uint64_t bytes, int target, int component_type, std::size_t count, const char* type);
  // Adds a material, whose textures are those of the document.
  void add_material(const Material& material);
  // Adds an image object of glTF, with its URI or buffer view, and returns its number.
  std::size_t add_image(Json image);
  // Adds a texture with one of the images, which has a MIME type that glTF or an extension knows.
  void add_texture(const Texture& texture, std::size_t image, const std::string& mime_type);
  // Names an extension once among those that the file uses, and those that it requires.
  void use_extension(const std::string& name, bool is_required);

  // Returns everything in the file before the bytes of the buffer. Throws Error when the file would exceed the size of
  // GLB files.
  [[nodiscard]] std::string head(const FileErrors& errors);

 private:
  Json json_;
  std::uint64_t bytes_ = 0;  // size of the buffer
};

// Returns the name of a file as a URI.
[[nodiscard]] std::string uri_of(const std::string& file);

// Converts an sRGB channel to linear light, which glTF stores.
[[nodiscard]] std::uint16_t linear_color(std::uint8_t encoded);

}  // namespace occlod
