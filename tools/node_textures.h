// Decodes the images of nodes, and keeps those of the last picture.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec2.hpp>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "front_mesh.h"
#include "object_textures.h"
#include "occlod/hlod.h"
#include "occlod/picture.h"

namespace occlod::tool {

class NodeTextures {
 public:
  // `hlods` are the placed HLODs of all fronts, and their materials as `textures` has them; both must outlive it.
  NodeTextures(std::span<const hlod::PlacedHlod> placed, const HlodTextures& textures)
      : placed_(placed), textures_(textures) {}

  // Returns the texture of each object of a front, valid until the next call: of the node's own image where it has one.
  // One that cannot be decoded is left out with a note, once.
  [[nodiscard]] std::vector<ObjectTexture> of(const FrontMesh& front);

 private:
  // What a node with an image shows.
  struct Own {
    std::unique_ptr<const TextureImage> image;  // null: it cannot be decoded
    std::vector<glm::vec2> coordinates;
    std::vector<DrawMaterial> materials;
    bool is_used = false;  // by the last picture
  };

  [[nodiscard]] ObjectTexture own_texture(const LaidObject& laid);
  [[nodiscard]] Own decoded(const LaidObject& laid) const;

  std::span<const hlod::PlacedHlod> placed_;
  const HlodTextures& textures_;
  std::unordered_map<std::uint64_t, Own> own_;  // by placed HLOD and node
};

}  // namespace occlod::tool
