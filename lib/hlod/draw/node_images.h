// Keeps what nodes look like from one view, so that several devices that draw the same frame rasterize each node once.
// Users have no such choice: bench/papers draws each frame by many strategies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <span>
#include <unordered_map>
#include <vector>

#include "occlod/device.h"
#include "raster/depth_image.h"

namespace occlod::hlod {

// Tells apart views of placed HLODs: images are the same while this is.
struct ImageView {
  int width = 0;
  int height = 0;
  std::vector<const Hlod*> hlods;
  std::vector<glm::mat4> object_to_clip;  // per HLOD

  friend bool operator==(const ImageView&, const ImageView&) = default;
};

// Holds the pixels that ranges of nodes cover. They do not depend on what else is drawn, and neither do fragments.
// Takes 4 bytes a pixel between the first and the last that a node covers in each row.
class NodeImages {
 public:
  struct Image {
    DrawnPixels drawn;
    std::uint64_t triangles = 0;
    std::size_t first_range = 0, range_count = 0, first_row = 0;  // places of what belongs to it
  };

  // Forgets all images unless the view is the same as before.
  void begin(const ImageView& view);

  // Returns the image of a draw without a cut, or null. It lives until the next call of begin() or add().
  [[nodiscard]] const Image* find(const NodeDraw& draw) const;
  // Adds the image of a draw that find() does not know. draw_into(DepthImage) draws it into an empty image.
  template <typename DrawInto>
  const Image& add(const NodeDraw& draw, std::uint64_t triangles, const DrawInto& draw_into) {
    return keep(draw, triangles, draw_into(empty_image()));
  }
  // Draws an image into a target of the view's size.
  void blend(const Image& image, const DepthImage& target) const;

 private:
  struct Row {
    int x0 = 0, x1 = 0;     // pixels that may be covered
    std::size_t first = 0;  // place in pixels_
  };

  [[nodiscard]] DepthImage empty_image();
  const Image& keep(const NodeDraw& draw, std::uint64_t triangles, const DrawnPixels& drawn);
  void keep_row(const DepthImage& image, const PixelRect& rect, int y);

  ImageView view_;
  std::vector<float> scratch_;                            // an image of the view's size, empty between calls of add()
  std::unordered_multimap<std::uint64_t, Image> images_;  // by object and node
  std::vector<DrawRange> ranges_;
  std::vector<Row> rows_;
  std::vector<float> pixels_;
};

}  // namespace occlod::hlod
