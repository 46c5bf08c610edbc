#include "base/large_vector.h"

#include <algorithm>
#include <array>
#include <mutex>

#include "base/platform.h"
#include "base/scratch_memory.h"

namespace occlod {
namespace {

constexpr std::size_t huge_page = std::size_t{2} << 20U;
constexpr std::align_val_t page_alignment{huge_page}, cache_line{64};

// Below a few pages the rounding up to whole pages would cost more than they save.
bool is_large(std::size_t bytes) { return bytes >= 4 * huge_page; }

// Memory that was given back.
class KeptMemory {
 public:
  void begin() noexcept {
    const std::scoped_lock lock(mutex_);
    ++users_;
  }
  void end() noexcept {
    const std::scoped_lock lock(mutex_);
    if (--users_ > 0) return;
    for (std::size_t i = 0; i < count_; ++i) ::operator delete(blocks_[i].memory, page_alignment);
    count_ = 0;
  }

  // False: it is not kept.
  bool put(void* memory, std::size_t bytes) noexcept {
    const std::scoped_lock lock(mutex_);
    if (users_ == 0 || count_ == blocks_.size()) return false;
    blocks_[count_++] = {memory, bytes};
    return true;
  }

  // The smallest that holds so many bytes, without the pages that they do not need; null when there is none.
  void* take(std::size_t bytes) noexcept {
    const std::scoped_lock lock(mutex_);
    Block* best = nullptr;
    for (std::size_t i = 0; i < count_; ++i)
      if (blocks_[i].bytes >= bytes && (best == nullptr || blocks_[i].bytes < best->bytes)) best = &blocks_[i];
    if (best == nullptr) return nullptr;
    const Block block = *best;
    *best = blocks_[--count_];
    const std::size_t needed = std::min((bytes + huge_page - 1) / huge_page * huge_page, block.bytes);
    give_pages_back(static_cast<std::byte*>(block.memory) + needed, block.bytes - needed);
    return block.memory;
  }

 private:
  struct Block {
    void* memory = nullptr;
    std::size_t bytes = 0;
  };

  std::mutex mutex_;
  int users_ = 0;
  std::array<Block, 32> blocks_;
  std::size_t count_ = 0;
};

KeptMemory& kept_memory() noexcept {
  static KeptMemory kept;
  return kept;
}

}  // namespace

LargeMemoryReuse::LargeMemoryReuse() noexcept { kept_memory().begin(); }
LargeMemoryReuse::~LargeMemoryReuse() { kept_memory().end(); }

void* allocate_large(std::size_t bytes) {
  if (!is_large(bytes)) return ::operator new(bytes, cache_line);
  if (void* const scratch = allocate_scratch(bytes)) return scratch;
  if (void* const kept = kept_memory().take(bytes)) return kept;
  void* const memory = ::operator new(bytes, page_alignment);
  advise_huge_pages(memory, bytes);
  return memory;
}

void free_large(void* memory, std::size_t bytes) noexcept {
  if (!is_large(bytes))
    ::operator delete(memory, cache_line);
  else if (memory != nullptr && !free_scratch(memory) && !kept_memory().put(memory, bytes))
    ::operator delete(memory, page_alignment);
}

}  // namespace occlod
