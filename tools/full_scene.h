// Draws the full meshes of placed objects, of any size, to see which triangle owns each pixel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "occlod/item_buffer.h"
#include "occlod/refiner.h"
#include "occlod/view.h"

namespace occlod::tool {

// Never changes: any number of threads may draw it, each into its own buffer. Triangles are kept in chunks of
// neighbours; chunks outside the frustum, or behind what is already drawn, are not drawn.
class FullScene {
 public:
  // Hierarchies must outlive it. Throws Error for 2^32 triangles or more. O(n log n), where meshes that repeat count
  // once.
  explicit FullScene(std::span<const RefineObject> objects);
  ~FullScene();
  FullScene(const FullScene&) = delete;
  FullScene& operator=(const FullScene&) = delete;

  struct Item {
    std::size_t object = 0;
    Triangle triangle{0};  // ids of its hierarchy's vertices
  };

  // Resets the buffer to the size of a perspective view and draws, like draw_items() of all triangles in some order.
  void draw(ItemBuffer& target, const View& view) const;
  // Returns the number of triangles of all objects.
  [[nodiscard]] std::size_t triangle_count() const noexcept;
  // Counts the triangles in chunks that may be inside the frustum of a perspective view.
  [[nodiscard]] std::size_t triangles_in_view(const View& view) const;
  // Returns the object and triangle of an item that owns a pixel.
  [[nodiscard]] Item item(std::uint32_t item) const;

 private:
  struct Mesh;
  struct Chunk;
  struct PlacedMesh {
    std::shared_ptr<const Mesh> mesh;
    RefineObject object;
    std::uint32_t first_item = 0;
  };
  void find_chunks(const View& view, std::vector<Chunk>& chunks) const;

  std::vector<PlacedMesh> meshes_;
};

}  // namespace occlod::tool
