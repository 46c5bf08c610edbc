// The images of an HLOD, for tiles that get images of their own: which of them are divided among tiles, and their
// texels at every size.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/memory.h"
#include "hlod/texture/charts.h"
#include "mesh/image_codec.h"
#include "occlod/base.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"
#include "occlod/tiles.h"

namespace occlod::tiles {

// Texels around each chart of a tile: bilinear filtering needs one, the next smaller size of the image another.
inline constexpr int gutter = 2;

// An image at one size. Texel (x, y) of size k stands for those of size k - 1 from (2 x, 2 y) on.
struct ImageLevel {
  int width = 0, height = 0;
  std::span<glm::u8vec4> pixels;     // sRGB and alpha, rows from the top
  std::span<std::uint8_t> coverage;  // how much of it lies in triangles of level 0, of 255; 0: nothing

  [[nodiscard]] std::size_t count() const noexcept {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  [[nodiscard]] std::size_t at(std::int64_t x, std::int64_t y) const noexcept {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

// One image that is divided among tiles.
struct SourceImage {
  TextureWrap wrap_s = TextureWrap::repeat, wrap_t = TextureWrap::repeat;
  bool is_jpeg = false;
  std::vector<ImageLevel> levels;  // down to one texel

  // Returns the place in pixels of texel (x, y) of a size, however far outside of the image it is.
  [[nodiscard]] std::size_t at(const ImageLevel& level, std::int64_t x, std::int64_t y) const noexcept;
};

// Decodes each image once. The pixels of all lie in one piece of large memory (base/memory.h), 7 bytes for each of the
// finest: so they leave main memory under a MemoryLimit, however small each image is.
class SourceTextures {
 public:
  // Divides no image.
  SourceTextures() = default;
  SourceTextures(SourceTextures&&) = default;
  SourceTextures& operator=(SourceTextures&&) = default;
  SourceTextures(const SourceTextures&) = delete;
  SourceTextures& operator=(const SourceTextures&) = delete;
  ~SourceTextures() = default;
  // Finds the images that can be divided, from what all nodes of level 0 show of them, and reads them from
  // `image_folder`. Images stay shared where all charts together would take more than twice their texels (bricks that
  // many walls show) and where materials have further maps. Calls `next` before each node of level 0, twice. Throws
  // Error for damaged files. O(texels + n log n).
  SourceTextures(const hlod::Hlod& hlod, const std::filesystem::path& image_folder, unsigned threads,
                 const std::function<void()>& next);

  // Has the image of a node for its only one, without pixels before show(). Materials that `is_shown_by` marks show it,
  // and texture coordinates of meshes lead to it.
  SourceTextures(ImageSize image, std::span<const std::uint8_t> is_shown_by, TextureOrigin origin);
  // Gives that image its pixels; `mesh` is that of the node. O(texels).
  void show(const Texels& texels, const TriangleMesh& mesh);

  // Returns the number of the image that a material shows, divided among tiles; no_id for any other.
  [[nodiscard]] std::uint32_t image_of(MaterialId material) const noexcept {
    return material < image_of_.size() ? image_of_[material] : no_id;
  }
  [[nodiscard]] const SourceImage& image(std::uint32_t number) const noexcept { return images_[number]; }
  [[nodiscard]] const std::vector<SourceImage>& images() const noexcept { return images_; }
  // Returns JPEG where all images that are divided are, else PNG.
  [[nodiscard]] TextureFormat usual_format() const noexcept;
  [[nodiscard]] const std::vector<SharedImage>& shared() const noexcept { return shared_; }

  // Returns the place of texture coordinates in an image, texels from its top left corner.
  [[nodiscard]] glm::dvec2 texels(std::uint32_t image, const glm::vec2& coordinates) const noexcept;
  // Returns the texture coordinates of a place in [0, 1] from the top left corner of a tile's image, and the reverse.
  [[nodiscard]] glm::vec2 coordinates(const glm::dvec2& place) const noexcept;
  [[nodiscard]] glm::dvec2 place(const glm::vec2& coordinates) const noexcept;

 private:
  class Planner;

  // Gives all sizes of all images their places.
  void make_space();
  // Fills the finest size of an image, and marks none of it as shown.
  void fill(std::uint32_t image, const Texels& texels, unsigned threads);
  // Marks the texels that a triangle with these texture coordinates shows.
  void cover(std::uint32_t image, const glm::vec2& a, const glm::vec2& b, const glm::vec2& c);
  // Fills the coarser sizes of an image.
  void fill_coarser(std::uint32_t image, unsigned threads);

  TextureOrigin origin_ = TextureOrigin::top_left;
  std::vector<std::uint32_t> image_of_;  // by material
  std::vector<SourceImage> images_;
  std::vector<SharedImage> shared_;
  UninitializedVector<glm::u8vec4> pixels_;     // of all images, each with all its sizes
  UninitializedVector<std::uint8_t> coverage_;  // likewise
};

// Returns linear light of an sRGB value, and the reverse.
[[nodiscard]] float linear_of(std::uint8_t srgb) noexcept;
[[nodiscard]] std::uint8_t srgb_of(float linear) noexcept;

// The mean of texels by weight, in linear light, where transparent ones count by their alpha.
class TexelMean {
 public:
  void add(const glm::u8vec4& texel, float weight) noexcept;
  [[nodiscard]] bool is_empty() const noexcept { return !(weight_ > 0.0F); }
  // Precondition: !is_empty().
  [[nodiscard]] glm::u8vec4 value() const noexcept;

 private:
  glm::vec3 light_{0.0F}, bare_{0.0F};  // sums by weight and alpha; by weight alone, for what is all transparent
  float alpha_ = 0.0F, weight_ = 0.0F;
};

}  // namespace occlod::tiles
