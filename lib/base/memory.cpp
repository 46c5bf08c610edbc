#include "base/memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "base/platform.h"
#include "occlod/base.h"

namespace occlod {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto pause = std::chrono::milliseconds(1);
constexpr auto look_interval = std::chrono::microseconds(100);  // between two looks of make_room()
// The bounds of the threshold above which pages leave, as fractions of the limit. The margin above the threshold is for
// memory that fills up meanwhile.
constexpr double most_used = 0.75, least_used = 0.4;
constexpr std::size_t min_limit = std::size_t{1} << 26U;

// All mapped scratch files, including those that outlive their MemoryLimit.
struct Scratch {
  std::mutex mutex;
  std::optional<std::filesystem::path> folder;  // set while a MemoryLimit lives
  std::map<void*, ScratchFile> files;           // by start address
  std::map<std::byte*, std::size_t> mapped;     // other mapped files, which are read only: their sizes by start address
  std::size_t bytes = 0, max_bytes = 0;         // of all `files` together
};

Scratch& scratch() noexcept {
  static Scratch all;
  return all;
}

// Decides when pages leave. Threads that call look() meanwhile wait.
class Pager {
 public:
  // A limit of 0 switches paging off.
  void set_limit(std::size_t limit) {
    const std::scoped_lock lock(mutex_);
    limit_ = limit;
    last_ = resident_memory().all;
    fastest_ = 0;
  }

  // Makes all scratch pages leave when the process is near its limit. `coming` is the number of bytes that are about to
  // be filled.
  void look(std::size_t coming = 0) noexcept {
    const std::scoped_lock lock(mutex_);
    if (limit_ == 0) return;
    const ResidentMemory now = resident_memory();
    // Expect as much growth until the next look as there ever was between two looks; loops that do not call make_room()
    // may fill much.
    fastest_ = std::max(fastest_, now.all - std::min(now.all, last_));
    last_ = now.all;
    if (now.all + coming < threshold() || now.of_files < limit_ / 16) return;  // other memory cannot leave
    const std::scoped_lock files(scratch().mutex);
    for (const auto& [begin, file] : scratch().files) file.page_out();
    for (const auto& [begin, bytes] : scratch().mapped) give_pages_back(begin, bytes);
    last_ = now.all - std::min(now.all, now.of_files);
  }

 private:
  [[nodiscard]] std::size_t threshold() const {
    const auto limit = static_cast<double>(limit_);
    return static_cast<std::size_t>(
        std::clamp(limit - 2.0 * static_cast<double>(fastest_), least_used * limit, most_used * limit));
  }

  std::mutex mutex_;
  std::size_t limit_ = 0, last_ = 0, fastest_ = 0;
};

Pager& pager() noexcept {
  static Pager one;
  return one;
}

}  // namespace

// The thread that looks on behalf of loops that do not call make_room().
class MemoryLimit::Watch {
 public:
  explicit Watch(std::size_t limit) {
    pager().set_limit(limit);
    thread_ = std::thread([this] { run(); });
    memory_limit::lives = true;
  }
  ~Watch() {
    memory_limit::lives = false;
    pager().set_limit(0);
    {
      const std::scoped_lock lock(mutex_);
      ends_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, pause, [this] { return ends_; })) pager().look();
  }

  std::mutex mutex_;
  std::condition_variable wake_;
  bool ends_ = false;
  std::thread thread_;
};

MemoryLimit::MemoryLimit(std::size_t bytes, const std::filesystem::path& folder) {
  if (bytes < min_limit)
    throw Error({"memory limit", "", fmt::format("is {} bytes, less than 64 MiB", bytes), "allow more"});
  if (resident_memory().all == 0)
    throw Error({"memory limit", "", "this system does not tell how much memory a process has", "build without one"});
  if (const int problem = why_no_files_can_be_made(folder.c_str()); problem != 0)
    throw Error({folder.string(), "",
                 "no scratch files can be made in this folder: " + std::generic_category().message(problem),
                 "name another folder"});
  {
    const std::scoped_lock lock(scratch().mutex);
    if (scratch().folder) throw Error({"memory limit", "", "there is one already", "wait until it ends"});
    scratch().folder = folder;
    scratch().max_bytes = scratch().bytes;
  }
  watch_ = std::make_unique<Watch>(bytes);
}

MemoryLimit::~MemoryLimit() {
  watch_.reset();
  const std::scoped_lock lock(scratch().mutex);
  scratch().folder.reset();
}

std::size_t MemoryLimit::max_scratch_bytes() const noexcept {
  const std::scoped_lock lock(scratch().mutex);
  return scratch().max_bytes;
}

void memory_limit::make_room() noexcept {
  thread_local Clock::time_point next_look;
  if (Clock::now() < next_look) return;
  pager().look();
  next_look = Clock::now() + look_interval;
}

// Files are made and removed outside the lock, because that takes long and the watching thread must not wait for it.
void* allocate_scratch(std::size_t bytes) {
  Scratch& all = scratch();
  std::filesystem::path folder;
  std::size_t beside = 0;
  {
    const std::scoped_lock lock(all.mutex);
    if (!all.folder) return nullptr;
    folder = *all.folder;
    beside = all.bytes;
  }
  std::optional<ScratchFile> file;
  try {
    file.emplace(folder.c_str(), bytes);
  } catch (const std::system_error& error) {
    throw Error({folder.string(), "",
                 fmt::format("has no room for {} MiB more of scratch, beside {} MiB: {}", (bytes >> 20U) + 1,
                             beside >> 20U, error.code().message()),
                 "free some of its disk, or name a folder on another one"});
  }
  pager().look(bytes);
  void* const begin = file->bytes().data();
  const std::scoped_lock lock(all.mutex);
  all.files.emplace(begin, *std::move(file));
  all.bytes += bytes;
  all.max_bytes = std::max(all.max_bytes, all.bytes);
  return begin;
}

bool free_scratch(void* memory) noexcept {
  Scratch& all = scratch();
  std::map<void*, ScratchFile>::node_type gone;  // declared before the lock, so that the file is removed after
                                                 // unlocking
  const std::scoped_lock lock(all.mutex);
  const auto found = all.files.find(memory);
  if (found == all.files.end()) return false;
  all.bytes -= found->second.bytes().size();
  gone = all.files.extract(found);
  return true;
}

void let_leave(std::span<const std::byte> mapped_file) {
  const std::scoped_lock lock(scratch().mutex);
  scratch().mapped.emplace(const_cast<std::byte*>(mapped_file.data()), mapped_file.size());
}

void keep(std::span<const std::byte> mapped_file) noexcept {
  const std::scoped_lock lock(scratch().mutex);
  scratch().mapped.erase(const_cast<std::byte*>(mapped_file.data()));
}

namespace {

constexpr std::size_t huge_page = std::size_t{2} << 20U;
constexpr std::align_val_t page_alignment{huge_page}, cache_line{64};

// For less than a few pages, rounding up to whole pages would cost more than huge pages save.
bool is_large(std::size_t bytes) { return bytes >= 4 * huge_page; }

// Freed large blocks, kept for reuse while a LargeMemoryReuse lives.
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

  // Returns false when the block is not kept.
  bool put(void* memory, std::size_t bytes) noexcept {
    const std::scoped_lock lock(mutex_);
    if (users_ == 0 || count_ == blocks_.size()) return false;
    blocks_[count_++] = {memory, bytes};
    return true;
  }

  // Returns the smallest kept block of at least `bytes` bytes and gives its surplus pages back to the system; null when
  // there is none.
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
