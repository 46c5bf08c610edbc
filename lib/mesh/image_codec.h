// Decodes and encodes images.
#pragma once

#include <cstdint>
#include <glm/vec4.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/memory.h"

namespace occlod {

// An image in memory: sRGB and alpha, rows from the top.
struct Texels {
  int width = 0, height = 0;
  UninitializedVector<glm::u8vec4> pixels;  // width * height
};

struct ImageSize {
  int width = 0, height = 0;  // > 0
};

// Reads the size of an encoded PNG, JPEG, TGA, BMP, GIF, PSD, HDR, PIC or PNM image. Throws Error that names it `name`
// when it is none of these or has more than 2^28 pixels.
[[nodiscard]] ImageSize size_of_image(std::span<const std::uint8_t> bytes, const std::string& name);

// Decodes such an image; of a GIF the first picture. All memory that this takes is large memory (base/memory.h), so it
// keeps to a MemoryLimit. Throws Error as above, and for damaged images.
[[nodiscard]] Texels decode_texels(std::span<const std::uint8_t> bytes, const std::string& name);

// Encodes `width` * height pixels. A PNG has alpha where a pixel is not opaque. The same pixels give the same bytes.
// O(pixels).
[[nodiscard]] std::vector<std::uint8_t> encode_png(std::span<const glm::u8vec4> pixels, int width);
// The same without alpha, at quality 90 of 100.
[[nodiscard]] std::vector<std::uint8_t> encode_jpeg(std::span<const glm::u8vec4> pixels, int width);

}  // namespace occlod
