#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

#include <cassert>
#include <cstddef>

#include "occlod/core/error.h"
#include "occlod/io/atomic_file.h"
#include "occlod/picture/picture.h"

namespace occlod {
namespace {

void append(void* file, void* data, int size) {
  static_cast<AtomicFile*>(file)->write({static_cast<const std::byte*>(data), static_cast<std::size_t>(size)});
}

}  // namespace

void write_png(const std::filesystem::path& path, const Image& image) {
  assert(image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  AtomicFile file(path);
  if (stbi_write_png_to_func(append, &file, image.width, image.height, 4, image.pixels.data(), image.width * 4) == 0)
    throw Error({path.string(), "", "the picture cannot be encoded", "make it smaller"});
  file.commit();
}

}  // namespace occlod
