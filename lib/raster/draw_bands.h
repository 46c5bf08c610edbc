// Draws many triangles into one image on several threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/item_buffer.h"
#include "occlod/mesh.h"
#include "raster/depth_image.h"

namespace occlod::raster {

// Triangles of one object. The spans need only stay valid during the call that takes them.
struct DrawPart {
  std::span<const glm::vec3> positions;  // object space
  std::span<const Triangle> triangles;   // into positions
  glm::mat4 object_to_clip;
  std::uint32_t first_item = 0;  // of draw_items()
};

// Draws parts one after the other, on up to `threads` threads: each draws bands of rows, with the triangles that
// meet them, in their order. So every pixel is what one thread would draw, to the bit. Keeps its memory.
class BandDrawing {
 public:
  // Returns a rectangle that contains every pixel drawn.
  PixelRect draw_depth(const DepthImage& target, std::span<const DrawPart> parts, unsigned threads);
  void draw_items(ItemBuffer& target, std::span<const DrawPart> parts, unsigned threads);

 private:
  template <class MakeWriter>
  PixelRect draw(std::span<const DrawPart> parts, int width, int height, unsigned threads, const MakeWriter& writer);
  void find_rows(std::span<const DrawPart> parts, int width, int height, unsigned threads);
  template <class Writer>
  void draw_rows(std::span<const DrawPart> parts, int width, int height, const RowRange& rows,
                 const Writer& writer) const;

  // Rows inside the image that a triangle meets; images have at most 2^14.
  struct Rows {
    std::uint16_t first = 0, end = 0;
  };
  std::vector<Rows> rows_;        // of the triangles of all parts
  std::vector<PixelRect> drawn_;  // by band
};

}  // namespace occlod::raster
