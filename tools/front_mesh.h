// Converts what a frame of an HLOD has drawn for drawing it again: into pictures, and from other eyes.
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

// Holds draws of a frame beyond its lifetime; of cuts, only the number of splits.
struct Front {
  std::vector<hlod::DrawnNode> draws;
  std::vector<hlod::DrawRange> ranges;
};

[[nodiscard]] Front front_of(const hlod::Frame& frame);
// Returns all nodes of level 0, whose triangles are the input's, wherever their boxes say that they are.
[[nodiscard]] Front full_front(std::span<const hlod::PlacedHlod> placed);

// Holds what textures need of an object of a picture.
struct LaidObject {
  std::uint32_t placed = 0;  // HLOD
  hlod::NodeId node = 0;
  std::span<const glm::vec2> texture_coordinates;  // per vertex
  std::span<const MaterialId> materials;           // likewise
  hlod::NodeMesh mesh;                             // without an image where it is a cut
};

// Holds the triangles of a front as objects of a picture, one per draw, in the same order. Reuses its memory.
class FrontMesh {
 public:
  // The HLODs must outlive the result of objects(). Throws Error when a mapped file is damaged.
  void assign(const Front& front, std::span<const hlod::PlacedHlod> placed);
  // Returns the objects, valid until the next assign().
  [[nodiscard]] std::span<const DrawObject> objects() const { return objects_; }
  // Returns what textures need of each object, valid until the next assign().
  [[nodiscard]] std::span<const LaidObject> laid() const { return laid_; }
  [[nodiscard]] std::size_t triangle_count() const { return triangles_.size(); }

 private:
  void append(const hlod::DrawnNode& draw, std::span<const hlod::DrawRange> ranges, const hlod::PlacedHlod& placed);
  // Holds attributes of a cut's vertices: those of the node's mesh, then those of its splits.
  struct CutAttributes {
    std::vector<glm::u8vec4> colors;
    std::vector<glm::vec2> texture_coordinates;
    std::vector<MaterialId> materials;
  };

  void append_triangles(std::span<const std::uint16_t> indices);

  std::vector<DrawObject> objects_;
  std::vector<Triangle> triangles_;                // of all objects, one after the other
  std::vector<std::vector<glm::vec3>> positions_;  // of the k-th object whose vertices morph
  std::vector<hlod::NodeCut> cuts_;                // per cut
  std::vector<CutAttributes> attributes_;          // per object; empty unless it is a cut
  std::vector<LaidObject> laid_;                   // per object
};

}  // namespace occlod::tool
