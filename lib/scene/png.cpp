#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>

#include <cassert>
#include <cstddef>
#include <exception>

#include "base/atomic_file.h"
#include "occlod/core/error.h"
#include "occlod/picture/picture.h"

namespace occlod {
namespace {

// An exception is kept until the encoder, which is not exception-safe, has freed its memory.
struct Output {
  AtomicFile file;
  std::exception_ptr failure;
};

void append(void* to, void* data, int size) {
  Output& output = *static_cast<Output*>(to);
  try {
    output.file.write({static_cast<const std::byte*>(data), static_cast<std::size_t>(size)});
  } catch (...) {
    output.failure = std::current_exception();
  }
}

}  // namespace

void write_png(const std::filesystem::path& path, const Image& image) {
  assert(image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  Output output{AtomicFile(path), nullptr};
  if (stbi_write_png_to_func(append, &output, image.width, image.height, 4, image.pixels.data(), image.width * 4) == 0)
    throw Error({path.string(), "", "the picture cannot be encoded", "make it smaller"});
  if (output.failure) std::rethrow_exception(output.failure);
  output.file.commit();
}

}  // namespace occlod
