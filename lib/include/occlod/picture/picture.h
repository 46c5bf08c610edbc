// Pictures of a refinement, made from item buffers: the same on every machine, no GL.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "occlod/math/bounds.h"
#include "occlod/mesh/triangle_mesh.h"
#include "occlod/picture/texture_image.h"
#include "occlod/raster/item_buffer.h"
#include "occlod/view/view.h"

namespace occlod {

// The active triangles of one placed object. The spans need live only during a call.
struct DrawObject {
  std::span<const glm::vec3> positions;  // object space
  std::span<const glm::u8vec4> colors;   // sRGB, one per vertex, or empty
  std::span<const Triangle> triangles;   // ids into positions
  glm::dmat4 object_to_world{1.0};       // affine
};

// Resets the target to the view's size and draws all objects. Triangle i of object k owns its pixels as item (number of
// triangles of the objects before k) + i. O(triangles + pixels covered).
void draw_items(ItemBuffer& target, std::span<const DrawObject> objects, const View& view);

// How shade() looks.
struct ShadeOptions {
  bool wire = true;  // dark lines along triangle edges, where triangles are large enough on screen to show them
  glm::vec3 base{0.80F, 0.70F, 0.58F};  // linear RGB in [0, 1] of objects without vertex colours and materials
  // One for each object, or empty: no textures. Materials and their images multiply vertex colours.
  std::span<const ObjectTexture> textures = {};
};

// Flat two-sided shading by a head light and a key light over the viewer's left shoulder, from an item buffer that
// draw_items() filled with the same objects and view. Steps in depth are outlined; the background is a vertical
// gradient. O(pixels).
[[nodiscard]] Image shade(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view,
                          const ShadeOptions& options = {});

// The same objects seen from `view`, usually from above, to show where refinement spent its triangles: those that own a
// pixel of `main_items`, which was drawn for `main_view`, are bright and warm, the others dark and cool. The frustum of
// main_view is drawn in yellow lines as far as the scene extends.
[[nodiscard]] Image birdseye(std::span<const DrawObject> objects, const ItemBuffer& main_items, const View& main_view,
                             const View& view);

// A coloured object with a box around it.
struct MarkedObject {
  Box box;                // object space
  glm::vec3 color{0.0F};  // linear RGB in [0, 1]
};

// The same objects seen from `view` in colours of their own, with the edges of their boxes in brighter lines and the
// frustum of main_view as above. marks: one for each object.
[[nodiscard]] Image birdseye_boxes(std::span<const DrawObject> objects, std::span<const MarkedObject> marks,
                                   const View& main_view, const View& view);

// A camera above the scene that sees the box of all objects and the eye of main_view, looking against its up direction.
[[nodiscard]] Camera birdseye_camera(std::span<const DrawObject> objects, const View& main_view);

// Writes a PNG file of 8 bits a channel beside `path` and renames. Throws Error that names the file.
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace occlod
