#include "mesh/image_codec.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <utility>

#include "occlod/base.h"

namespace occlod {
namespace {

// The memory of decoder and encoder. Each block is preceded by its size, in a cache line of its own.
constexpr std::size_t block_head = 64;

void* allocate_block(std::size_t bytes) noexcept {
  try {
    auto* const block = static_cast<std::byte*>(allocate_large(block_head + bytes));
    std::memcpy(block, &bytes, sizeof bytes);
    return block + block_head;
  } catch (...) {
    return nullptr;  // they are C, and then fail
  }
}

std::size_t block_size(const void* block) noexcept {
  std::size_t bytes = 0;
  std::memcpy(&bytes, static_cast<const std::byte*>(block) - block_head, sizeof bytes);
  return bytes;
}

void free_block(void* block) noexcept {
  if (block != nullptr) free_large(static_cast<std::byte*>(block) - block_head, block_head + block_size(block));
}

void* reallocate_block(void* block, std::size_t bytes) noexcept {
  void* const grown = allocate_block(bytes);
  if (block == nullptr || grown == nullptr) return grown;
  std::memcpy(grown, block, std::min(bytes, block_size(block)));
  free_block(block);
  return grown;
}

}  // namespace
}  // namespace occlod

// The macros bring the casts of decoder and encoder into this file.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#define STBI_MALLOC(bytes) occlod::allocate_block(bytes)
#define STBI_REALLOC(block, bytes) occlod::reallocate_block(block, bytes)
#define STBI_FREE(block) occlod::free_block(block)
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_STDIO
#include <stb_image.h>
#pragma GCC diagnostic pop

#ifdef OCCLOD_HAS_ZLIB
#include <zlib.h>

namespace occlod {
namespace {

// Compresses what the encoder has filtered into memory that it frees: its own compressor needs a third more bytes.
unsigned char* compress_filtered(const unsigned char* data, int bytes, int* packed_bytes, int /*quality*/) noexcept {
  uLongf size = compressBound(static_cast<uLong>(bytes));
  auto* const packed = static_cast<unsigned char*>(allocate_block(size));
  if (packed == nullptr) return nullptr;
  if (compress2(packed, &size, data, static_cast<uLong>(bytes), Z_BEST_COMPRESSION) != Z_OK) {
    free_block(packed);
    return nullptr;
  }
  *packed_bytes = static_cast<int>(size);
  return packed;
}

}  // namespace
}  // namespace occlod

#define STBIW_ZLIB_COMPRESS occlod::compress_filtered
#endif

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#define STBIW_MALLOC(bytes) occlod::allocate_block(bytes)
#define STBIW_REALLOC(block, bytes) occlod::reallocate_block(block, bytes)
#define STBIW_FREE(block) occlod::free_block(block)
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>
#pragma GCC diagnostic pop

namespace occlod {
namespace {

constexpr std::int64_t max_pixels = std::int64_t{1} << 28U;
constexpr int jpeg_quality = 90;
constexpr char remedy[] = "convert it to PNG or JPEG, or go without textures";

// The encoder is not exception-safe, so a failure waits for its end.
struct Output {
  std::vector<std::uint8_t> bytes;
  bool has_failed = false;
};

void append(void* to, void* data, int size) {
  auto& output = *static_cast<Output*>(to);
  const auto* const first = static_cast<const std::uint8_t*>(data);
  try {
    output.bytes.insert(output.bytes.end(), first, first + size);
  } catch (...) {
    output.has_failed = true;
  }
}

// Returns the channels of the pixels one after the other, without alpha for 3.
LargeVector<std::uint8_t> channels_of(std::span<const glm::u8vec4> pixels, int channels) {
  LargeVector<std::uint8_t> values;
  values.reserve(pixels.size() * static_cast<std::size_t>(channels));
  for (const glm::u8vec4& p : pixels)
    for (int k = 0; k < channels; ++k) values.push_back(p[k]);
  return values;
}

template <typename Encode>
std::vector<std::uint8_t> encoded(std::span<const glm::u8vec4> pixels, int width, const Encode& encode) {
  assert(width > 0 && !pixels.empty() && pixels.size() % static_cast<std::size_t>(width) == 0);
  Output output;
  const int height = static_cast<int>(pixels.size() / static_cast<std::size_t>(width));
  if (encode(output, height) == 0 || output.has_failed) throw std::bad_alloc();
  return std::move(output.bytes);
}

}  // namespace

ImageSize size_of_image(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw Error({name, "", "is too large for an image", remedy});
  ImageSize size;
  int channels = 0;
  if (stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &size.width, &size.height, &channels) == 0 ||
      size.width <= 0 || size.height <= 0)
    throw Error({name, "", "is no image that can be read", remedy});
  if (std::int64_t{size.width} * size.height > max_pixels) throw Error({name, "", "is too large for an image", remedy});
  return size;
}

Texels decode_texels(std::span<const std::uint8_t> bytes, const std::string& name) {
  static_cast<void>(size_of_image(bytes, name));
  Texels texels;
  int channels = 0;
  stbi_uc* const pixels =
      stbi_load_from_memory(bytes.data(), static_cast<int>(bytes.size()), &texels.width, &texels.height, &channels, 4);
  if (pixels == nullptr) throw Error({name, "", std::string("cannot be decoded: ") + stbi_failure_reason(), remedy});
  const std::unique_ptr<stbi_uc, void (*)(void*)> owner(pixels, stbi_image_free);
  texels.pixels.resize(static_cast<std::size_t>(texels.width) * static_cast<std::size_t>(texels.height));
  std::memcpy(texels.pixels.data(), pixels, 4 * texels.pixels.size());
  return texels;
}

std::vector<std::uint8_t> encode_png(std::span<const glm::u8vec4> pixels, int width) {
  const bool is_opaque = std::ranges::all_of(pixels, [](const glm::u8vec4& p) { return p.a == 255; });
  const int channels = is_opaque ? 3 : 4;
  const LargeVector<std::uint8_t> values = channels_of(pixels, channels);
  return encoded(pixels, width, [&](Output& output, int height) {
    return stbi_write_png_to_func(append, &output, width, height, channels, values.data(), width * channels);
  });
}

std::vector<std::uint8_t> encode_jpeg(std::span<const glm::u8vec4> pixels, int width) {
  const LargeVector<std::uint8_t> values = channels_of(pixels, 3);
  return encoded(pixels, width, [&](Output& output, int height) {
    return stbi_write_jpg_to_func(append, &output, width, height, 3, values.data(), jpeg_quality);
  });
}

}  // namespace occlod
