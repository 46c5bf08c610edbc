#include "core/large_vector.h"

#include "core/platform.h"

namespace occlod {
namespace {

constexpr std::size_t huge_page = std::size_t{2} << 20U;
constexpr std::align_val_t page_alignment{huge_page}, cache_line{64};

// Below a few pages the rounding up to whole pages would cost more than they save.
bool is_large(std::size_t bytes) { return bytes >= 4 * huge_page; }

}  // namespace

void* allocate_large(std::size_t bytes) {
  if (!is_large(bytes)) return ::operator new(bytes, cache_line);
  void* const memory = ::operator new(bytes, page_alignment);
  advise_huge_pages(memory, bytes);
  return memory;
}

void free_large(void* memory, std::size_t bytes) noexcept {
  if (is_large(bytes))
    ::operator delete(memory, page_alignment);
  else
    ::operator delete(memory, cache_line);
}

}  // namespace occlod
