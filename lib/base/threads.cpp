#include "base/threads.h"

#include <condition_variable>
#include <mutex>
#include <system_error>
#include <utility>
#include <vector>

namespace occlod {
namespace {

// Spinning takes about as long as falling asleep and being woken.
constexpr int max_looks = 4000;

// Spins until `changed` returns true, but not for long.
template <typename Changed>
void spin_until(const Changed& changed) noexcept {
  for (int i = 0; i < max_looks && !changed(); ++i) relax();
}

// Locks a mutex that others hold for some instructions only, so that nobody falls asleep for it.
std::unique_lock<std::mutex> locked(std::mutex& mutex) {
  for (int i = 0; i < max_looks; ++i) {
    if (std::unique_lock lock(mutex, std::try_to_lock); lock) return lock;
    relax();
  }
  return std::unique_lock(mutex);
}

}  // namespace

// The threads that help. There is one for the process. It is never destroyed, because its threads may outlive all other
// static objects, and a child of fork(), which has none of the threads, makes its own.
class ThreadPool {
 public:
  static ThreadPool& of_process();

  void open(SharedWork& work, unsigned helpers);
  // Lets no further thread join, and waits for those that have joined.
  void close(SharedWork& work) noexcept;

 private:
  void add_threads(unsigned wanted);
  void run();
  void help(SharedWork& work, std::unique_lock<std::mutex>& lock) noexcept;
  void rest(std::unique_lock<std::mutex>& lock);

  ForkMark began_;    // never changes
  std::mutex mutex_;  // guards everything below and what it guards in SharedWork
  std::condition_variable opened_, left_;
  std::vector<SharedWork*> open_;            // those that more threads may join, oldest first
  std::atomic<std::uint32_t> openings_ = 0;  // number of works opened so far; read by those who spin, too
  unsigned threads_ = 0, spinning_ = 0, sleeping_ = 0;
  bool has_a_core_each_ = true;
};

ThreadPool& ThreadPool::of_process() {
  static std::atomic<ThreadPool*> current = nullptr;
  ThreadPool* pool = current.load(std::memory_order_acquire);
  while (pool == nullptr || pool->began_.is_in_child()) {
    auto* const made = new ThreadPool;
    if (current.compare_exchange_strong(pool, made, std::memory_order_acq_rel)) return *made;
    delete made;  // another thread was faster
  }
  return *pool;
}

void ThreadPool::open(SharedWork& work, unsigned helpers) {
  unsigned sleepers = 0;
  {
    const std::unique_lock lock = locked(mutex_);
    add_threads(helpers);
    work.wanted_ = helpers;
    work.joined_ = 0;
    open_.push_back(&work);
    openings_.fetch_add(1, std::memory_order_release);
    sleepers = std::min(helpers - std::min(helpers, spinning_), sleeping_);
  }
  for (; sleepers > 0; --sleepers) opened_.notify_one();
}

// When the system has no more threads, there are fewer.
void ThreadPool::add_threads(unsigned wanted) {
  if (threads_ >= wanted) return;
  try {
    for (; threads_ < wanted; ++threads_) std::thread([this] { run(); }).detach();
  } catch (const std::system_error&) {
  }
  has_a_core_each_ = threads_ < std::thread::hardware_concurrency();  // beside the calling thread
}

void ThreadPool::close(SharedWork& work) noexcept {
  {
    const std::unique_lock lock = locked(mutex_);
    std::erase(open_, &work);
    if (work.working_.load(std::memory_order_relaxed) == 0) return;
  }
  spin_until([&] { return work.working_.load(std::memory_order_acquire) == 0; });
  std::unique_lock lock = locked(mutex_);
  left_.wait(lock, [&] { return work.working_.load(std::memory_order_relaxed) == 0; });
}

void ThreadPool::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    if (open_.empty())
      rest(lock);
    else
      help(*open_.front(), lock);
  }
}

void ThreadPool::help(SharedWork& work, std::unique_lock<std::mutex>& lock) noexcept {
  const unsigned number = ++work.joined_;
  if (number == work.wanted_) open_.erase(open_.begin());
  work.working_.fetch_add(1, std::memory_order_relaxed);
  lock.unlock();
  std::exception_ptr failure;
  try {
    work.call_(work.work_, number);
  } catch (...) {
    failure = std::current_exception();
  }
  lock = locked(mutex_);
  if (failure && !work.failure_) work.failure_ = std::move(failure);
  if (work.working_.fetch_sub(1, std::memory_order_release) == 1) left_.notify_all();
}

// Spins for a while, then sleeps, until something may have been opened.
void ThreadPool::rest(std::unique_lock<std::mutex>& lock) {
  if (has_a_core_each_) {
    const std::uint32_t openings = openings_.load(std::memory_order_relaxed);
    ++spinning_;
    lock.unlock();
    spin_until([&] { return openings_.load(std::memory_order_acquire) != openings; });
    lock = locked(mutex_);
    --spinning_;
    if (!open_.empty()) return;
  }
  ++sleeping_;
  opened_.wait(lock);
  --sleeping_;
}

void SharedWork::open(unsigned helpers) {
  began_ = {};
  ThreadPool::of_process().open(*this, helpers);
  is_open_ = true;
}

void SharedWork::wait() noexcept {
  if (!std::exchange(is_open_, false)) return;
  if (!began_.is_in_child()) {
    ThreadPool::of_process().close(*this);
    return;
  }
  working_ = 0;  // they are lost
  failure_ = nullptr;
}

void SharedWork::finish() {
  wait();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void SharedWork::abandon() noexcept {
  wait();
  failure_ = nullptr;
}

}  // namespace occlod
