// Pictures of a refinement, made from item buffers: the same on every machine, no GL.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "occlod/mesh/triangle_mesh.h"
#include "occlod/raster/item_buffer.h"
#include "occlod/view/view.h"

namespace occlod {

struct Image {
  int width = 0;
  int height = 0;
  std::vector<glm::u8vec4> pixels;  // sRGB, rows from the top
};

// The active triangles of one placed object.
struct DrawObject {
  std::span<const glm::vec3> positions;  // object space
  std::span<const glm::u8vec4> colors;   // per vertex, or empty
  std::span<const Triangle> triangles;
  glm::dmat4 object_to_world{1.0};
};

// Resets the target to the view's size and draws all objects; triangle i of object k owns its pixels as item (triangles
// of the objects before k) + i.
void draw_items(ItemBuffer& target, std::span<const DrawObject> objects, const View& view);

struct ShadeOptions {
  bool wire = true;  // dark lines along triangle edges, where triangles are large enough on screen to show them
  glm::vec3 base{0.80F, 0.70F, 0.58F};  // linear colour of objects without vertex colours
};

// Flat two-sided shading by a head light and a key light over the viewer's left shoulder, from an item buffer that
// draw_items() filled with the same objects and view. Steps in depth are outlined; the background is a vertical
// gradient.
[[nodiscard]] Image shade(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view,
                          const ShadeOptions& options = {});

// The same objects seen from `view` (usually from above), each triangle coloured by whether `main_items`, drawn for
// `main_view`, shows it: visible ones bright and warm, unseen ones dark and cool, so that one sees what was refined
// where; the frustum of main_view is drawn as yellow lines as far as the scene reaches.
[[nodiscard]] Image birdseye(std::span<const DrawObject> objects, const ItemBuffer& main_items, const View& main_view,
                             const View& view);

// A camera above the scene that sees the box of all objects and the main eye, looking against main_view's up direction.
[[nodiscard]] Camera birdseye_camera(std::span<const DrawObject> objects, const View& main_view);

// Writes beside the target and renames. Throws Error.
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace occlod
