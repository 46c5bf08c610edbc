// Draws pictures of refinements on the CPU: textures, shading and bird's-eye views. Decoding image files is up to the
// program.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "occlod/base.h"
#include "occlod/bounds.h"
#include "occlod/item_buffer.h"
#include "occlod/mesh.h"
#include "occlod/refiner.h"
#include "occlod/view.h"

namespace occlod {

// An image in memory.
struct Image {
  int width = 0;                    // pixels
  int height = 0;                   // pixels
  std::vector<glm::u8vec4> pixels;  // width * height, sRGB and alpha, rows from the top
};

// How texture coordinates address an image.
struct TextureAddress {
  TextureWrap wrap_s = TextureWrap::repeat;           // along the first coordinate
  TextureWrap wrap_t = TextureWrap::repeat;           // along the second
  TextureOrigin origin = TextureOrigin::bottom_left;  // where (0, 0) is
};

// An image with smaller versions of it, to be sampled at any scale. Immutable.
class TextureImage {
 public:
  // Takes an image of at least one pixel. Each smaller version has half the size of the one before and averages its
  // pixels in linear light; alpha is ignored. O(pixels) time; memory is a third more than the image's.
  explicit TextureImage(Image image, const TextureAddress& address = {});

  // Returns the width of the image, pixels.
  [[nodiscard]] int width() const noexcept { return levels_[0].width; }
  // Returns the height of the image, pixels.
  [[nodiscard]] int height() const noexcept { return levels_[0].height; }

  // Returns linear RGB at a texture coordinate. `across` and `down` are the changes of the coordinate from one pixel of
  // the picture to the next. Filters bilinearly within and linearly between two sizes of the image, at up to 16
  // positions along the longer of the two steps, so that surfaces seen at a flat angle stay sharp. Returns white when a
  // number is not finite.
  [[nodiscard]] glm::vec3 sample(const glm::dvec2& coordinate, const glm::dvec2& across, const glm::dvec2& down) const;

 private:
  [[nodiscard]] glm::vec3 sample_level(const glm::dvec2& coordinate, std::size_t level) const;
  [[nodiscard]] glm::vec3 sample_between(const glm::dvec2& coordinate, double level) const;

  std::vector<Image> levels_;  // each half the size of the one before, down to one pixel
  TextureAddress address_;
};

// Makes a checkerboard whose colours change from place to place, so that every shift of a texture can be seen.
// `squares` is the number along each side, at least 1; `square_px` the pixels along each side of a square, at least 1.
[[nodiscard]] Image checker_image(int squares = 32, int square_px = 32);

// A material with the image that it names.
struct DrawMaterial {
  glm::vec3 base_color{1.0F};           // linear RGB in [0, 1]
  const TextureImage* image = nullptr;  // multiplies base_color; null: no image
};

// The texture of one object. The spans need only stay valid during a call.
struct ObjectTexture {
  std::span<const glm::vec2> coordinates = {};        // one per vertex that triangles index, or empty: no images
  std::span<const MaterialId> vertex_materials = {};  // one per vertex; a triangle has the material of its first
                                                      // corner; empty: all have the first
  std::span<const DrawMaterial> materials = {};       // indexed by vertex_materials; empty: no texture
};

// The active triangles of one placed object. The spans need only stay valid during a call.
struct DrawObject {
  std::span<const glm::vec3> positions;      // object space
  std::span<const glm::u8vec4> colors = {};  // sRGB, one per vertex, or empty
  std::span<const Triangle> triangles = {};  // ids into positions
  glm::dmat4 object_to_world{1.0};           // affine
};

// Resets the target to the view's size and draws all objects. Triangle i of object k owns its pixels as item (number of
// triangles of the objects before k) + i. `threads`: how many to use, 0: one for each core; the picture does not depend
// on it. O(triangles + pixels covered).
void draw_items(ItemBuffer& target, std::span<const DrawObject> objects, const View& view, int threads = 0);

// Options of shade().
struct ShadeOptions {
  bool wire = true;  // dark lines along triangle edges, where triangles are large enough on the screen to show them
  glm::vec3 base{0.80F, 0.70F, 0.58F};  // linear RGB in [0, 1], for objects without vertex colours and materials
  // One for each object, or empty for no textures. Materials and their images multiply vertex colours.
  std::span<const ObjectTexture> textures = {};
};

// Shades an item buffer that draw_items() filled with the same objects and view: flat and two-sided, with a head light
// and a key light over the viewer's left shoulder. Steps in depth are outlined; the background is a vertical gradient.
// The result is the same on every machine. O(pixels).
[[nodiscard]] Image shade(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view,
                          const ShadeOptions& options = {});

// Draws what a Refiner chose of its objects, which are as many, and shades it. O(triangles + pixels covered).
[[nodiscard]] Image draw_picture(std::span<const RefineObject> objects, const Refinement& refinement, const View& view,
                                 const ShadeOptions& options = {});

// Draws the objects as seen from `view`, usually from above, to show where refinement spent its triangles: those that
// own a pixel of `main_items`, which was drawn for `main_view`, are bright and warm, the others dark and cool. The
// frustum of main_view is drawn in yellow lines as far as the scene extends.
[[nodiscard]] Image birdseye(std::span<const DrawObject> objects, const ItemBuffer& main_items, const View& main_view,
                             const View& view);

// A coloured object with a box around it.
struct MarkedObject {
  Box box;                // object space
  glm::vec3 color{0.0F};  // linear RGB in [0, 1]
};

// Draws the objects as seen from `view` in the colours of `marks`, one for each object, with the edges of their boxes
// in brighter lines and the frustum of main_view in yellow lines.
[[nodiscard]] Image birdseye_boxes(std::span<const DrawObject> objects, std::span<const MarkedObject> marks,
                                   const View& main_view, const View& view);

// Returns a camera above the scene that sees the box of all objects and the eye of main_view and looks against the up
// direction of main_view.
[[nodiscard]] Camera birdseye_camera(std::span<const DrawObject> objects, const View& main_view);

// Writes a PNG file of 8 bits a channel beside `path` and renames it. Throws Error that names the file.
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace occlod
