// The materials, textures and images of a mesh in a binary glTF file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mesh/glb.h"
#include "mesh/image_files.h"
#include "mesh/mesh_writers.h"
#include "occlod/mesh.h"

namespace occlod {

// Chooses the images that the file will hold: those of textures, each once. What glTF has no image for is left out,
// with a note.
class GlbLook {
 public:
  // `mesh` must outlive this.
  GlbLook(const TriangleMesh& mesh, const MeshOutput& output);

  // Adds all materials, in their order, and what they use. The images come next in the buffer.
  void describe(GlbDocument& document) const;
  // Writes these images.
  void write(ChunkedWriter& out) const;

 private:
  // An image of the document.
  struct Image {
    TextureId texture;  // the first that shows it
    std::string type;   // MIME
    ImageBytes file_bytes;

    [[nodiscard]] std::span<const std::uint8_t> bytes_of(const Texture& from) const {
      if (from.bytes.empty()) return file_bytes;
      return from.bytes;
    }
  };

  std::optional<std::size_t> image_of(TextureId t, const MeshOutput& output);

  const TriangleMesh& mesh_;
  std::vector<Image> images_;
  std::vector<std::pair<TextureId, std::size_t>> textures_;  // of the document: which of the mesh, with which image
  std::vector<TextureId> new_ids_;                           // by texture of the mesh; no_texture: left out
};

}  // namespace occlod
