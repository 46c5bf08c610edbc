#include "mesh/olod_codec.h"

#include <zstd.h>

#include <algorithm>
#include <memory>
#include <new>

namespace occlod::olod {
namespace {

constexpr std::size_t packed_run = std::size_t{4} << 20U;  // raw bytes of a frame
constexpr int level = 3;  // higher levels gain some percent here and cost many times the time

// Whole elements, so that frames do not depend on each other.
std::size_t run_of(std::size_t element_bytes) { return packed_run / element_bytes * element_bytes; }

}  // namespace

void separate(std::span<const std::byte> elements, std::size_t element_bytes, std::span<std::byte> planes) {
  const std::size_t count = elements.size() / element_bytes;
  for (std::size_t k = 0; k < element_bytes; ++k)
    for (std::size_t i = 0; i < count; ++i) planes[k * count + i] = elements[i * element_bytes + k];
  std::copy(elements.begin() + static_cast<std::ptrdiff_t>(count * element_bytes), elements.end(),
            planes.begin() + static_cast<std::ptrdiff_t>(count * element_bytes));
}

void join(std::span<const std::byte> planes, std::size_t element_bytes, std::span<std::byte> elements) {
  const std::size_t count = planes.size() / element_bytes;
  for (std::size_t k = 0; k < element_bytes; ++k)
    for (std::size_t i = 0; i < count; ++i) elements[i * element_bytes + k] = planes[k * count + i];
  std::copy(planes.begin() + static_cast<std::ptrdiff_t>(count * element_bytes), planes.end(),
            elements.begin() + static_cast<std::ptrdiff_t>(count * element_bytes));
}

std::vector<std::byte> pack(std::span<const std::byte> raw, std::size_t element_bytes) {
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(), &ZSTD_freeCCtx);
  if (!context) throw std::bad_alloc();
  std::vector<std::byte> packed;
  std::vector<std::byte> planes(std::min(raw.size(), run_of(element_bytes)));
  while (!raw.empty()) {
    const auto run = raw.first(std::min(raw.size(), planes.size()));
    separate(run, element_bytes, planes);
    const std::size_t before = packed.size();
    packed.resize(before + ZSTD_compressBound(run.size()));
    const std::size_t size = ZSTD_compressCCtx(context.get(), packed.data() + before, packed.size() - before,
                                               planes.data(), run.size(), level);
    if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // the only way to fail with room for the worst case
    packed.resize(before + size);
    raw = raw.subspan(run.size());
  }
  return packed;
}

bool unpack(std::span<const std::byte> packed, std::size_t element_bytes, std::span<std::byte> raw) {
  std::vector<std::byte> planes(std::min(raw.size(), run_of(element_bytes)));
  while (!raw.empty()) {
    const std::size_t run = std::min(raw.size(), planes.size());
    const std::size_t frame = ZSTD_findFrameCompressedSize(packed.data(), packed.size());
    if (ZSTD_isError(frame) != 0 || ZSTD_decompress(planes.data(), run, packed.data(), frame) != run) return false;
    join(std::span(planes).first(run), element_bytes, raw.first(run));
    packed = packed.subspan(frame);
    raw = raw.subspan(run);
  }
  return packed.empty();
}

}  // namespace occlod::olod
