// What a frame of an HLOD has drawn, to be drawn again: into pictures, and from other eyes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "occlod/build_hlod.h"
#include "occlod/device.h"
#include "occlod/picture.h"
#include "occlod/traverser.h"
#include "occlod/view.h"

namespace occlod::tool {

// Draws of a frame that outlive it; of cuts only their splits.
struct Front {
  std::vector<hlod::DrawnNode> draws;
  std::vector<hlod::DrawRange> ranges;
};

[[nodiscard]] Front front_of(const hlod::Frame& frame);
// All nodes of level 0 that may be inside the frustum: the input itself.
[[nodiscard]] Front full_front(std::span<const hlod::PlacedHlod> placed, const View& view);

// The triangles of a front, one object of a picture for each of its draws, in the same order. Reuses its memory.
class FrontMesh {
 public:
  // The HLODs outlive what objects() returns. Throws Error when a mapped file is damaged.
  void assign(const Front& front, std::span<const hlod::PlacedHlod> placed);
  // Valid until the next assign().
  [[nodiscard]] std::span<const DrawObject> objects() const { return objects_; }
  // One for each of them, empty where `materials` are: by placed HLOD, those that its vertices index. Likewise.
  [[nodiscard]] std::vector<ObjectTexture> textures(std::span<const std::span<const DrawMaterial>> materials) const;
  [[nodiscard]] std::size_t triangle_count() const { return triangles_.size(); }

 private:
  void append(const hlod::DrawnNode& draw, std::span<const hlod::DrawRange> ranges, const hlod::PlacedHlod& placed);
  // Attributes of a cut's vertices: those of the node's mesh, then those of its splits.
  struct CutAttributes {
    std::vector<glm::u8vec4> colors;
    std::vector<glm::vec2> texture_coordinates;
    std::vector<MaterialId> materials;
  };
  // What textures need of the vertices of an object.
  struct Laid {
    std::uint32_t placed = 0;  // HLOD
    std::span<const glm::vec2> texture_coordinates;
    std::span<const MaterialId> materials;
  };

  void append_triangles(std::span<const std::uint16_t> indices);

  std::vector<DrawObject> objects_;
  std::vector<Triangle> triangles_;                // of all objects, one after the other
  std::vector<std::vector<glm::vec3>> positions_;  // of the k-th object whose vertices are on their way
  std::vector<hlod::NodeCut> cuts_;                // of the k-th object
  std::vector<CutAttributes> attributes_;          // of the k-th object, if that is a cut
  std::vector<Laid> laid_;                         // of the k-th object
};

}  // namespace occlod::tool
