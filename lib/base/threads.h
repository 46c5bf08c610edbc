// Threads: the process's pool, work that its threads share with the calling one, and parallel loops.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <thread>

#include "base/memory.h"
#include "base/platform.h"

namespace occlod {

// Tells whether the process has been forked since, so that threads which began then are not in this one: waiting for
// them would last for ever.
class ForkMark {
 public:
  [[nodiscard]] bool is_in_child() const noexcept { return fork_count() != count_; }

 private:
  unsigned count_ = fork_count();
};

// Work that threads of the process's pool share with the calling thread. The pool's threads are made when they are
// first asked for and then live as long as the process: they spin briefly, so that work which follows soon begins
// within a microsecond, and sleep when there is none. A thread joins as soon as it is free, and perhaps never: other
// work may keep the pool busy, or the system may have no more threads. So the work must hand out its pieces itself, for
// instance by a counter, and the caller must be ready to do all of them. Used by one thread at a time.
class SharedWork {
 public:
  SharedWork() = default;
  ~SharedWork() { abandon(); }
  SharedWork(const SharedWork&) = delete;
  SharedWork& operator=(const SharedWork&) = delete;

  // Lets up to `helpers` threads call work(number), each once and with a number of its own in [1, helpers]. `work` must
  // live until finish() or abandon(). Precondition: no work has been started since.
  template <typename Work>
  void start(unsigned helpers, const Work& work) {
    if (helpers == 0) return;
    work_ = &work;
    call_ = [](const void* it, unsigned number) { (*static_cast<const Work*>(it))(number); };
    open(helpers);
  }
  // Lets no further thread join, waits for those that have joined, and rethrows the first exception of theirs.
  void finish();
  // Does the same, but drops their exceptions.
  void abandon() noexcept;

 private:
  friend class ThreadPool;

  void open(unsigned helpers);
  void wait() noexcept;

  const void* work_ = nullptr;
  void (*call_)(const void*, unsigned) = nullptr;
  bool is_open_ = false;
  ForkMark began_;
  // The pool guards these by its mutex; only working_ is read without it.
  unsigned wanted_ = 0, joined_ = 0;
  std::atomic<unsigned> working_ = 0;
  std::exception_ptr failure_;
};

// Calls work(number) on the calling thread, as number 0, and as far as the pool has free threads on up to `threads` - 1
// others at the same time, as SharedWork does. Rethrows an exception when all have returned.
template <typename Work>
void share(unsigned threads, const Work& work) {
  SharedWork others;
  others.start(threads - 1, work);
  work(0U);
  others.finish();
}

// Returns `asked`, or the number of cores when it is not positive.
[[nodiscard]] inline unsigned thread_count(int asked) {
  return asked > 0 ? static_cast<unsigned>(asked) : std::max(1U, std::thread::hardware_concurrency());
}

// Returns how many of `threads` have something to do when there are so many pieces of work; at least 1.
[[nodiscard]] inline unsigned thread_count_for(std::size_t pieces, unsigned threads) {
  return static_cast<unsigned>(std::clamp<std::size_t>(pieces, 1, std::max(threads, 1U)));
}

inline constexpr std::size_t range_size = 8192;
inline constexpr std::size_t steps_for_room = 16;  // between two calls of make_room(): each step may bring in 2 MB

// Calls visit(begin, end) for consecutive ranges that together are [begin, end), and make_room() between them.
template <typename Visit>
void for_each_short_range(std::size_t begin, std::size_t end, const Visit& visit) {
  while (begin < end) {
    make_room();
    const std::size_t next = std::min(begin + steps_for_room, end);
    visit(begin, next);
    begin = next;
  }
}

// Calls visit(begin, end, thread) for consecutive blocks of `size` that together are [0, count), each on any thread; a
// visit must not touch what others write. The calling thread is number 0, others have numbers below `threads`. Between
// its blocks the calling thread calls between(next): all blocks before `next` are done or running. If between() or a
// visit throws, every thread stops after its current block and the exception is rethrown here.
template <typename Visit, typename Between>
void for_each_block(std::size_t count, std::size_t size, unsigned threads, const Visit& visit, const Between& between) {
  std::atomic<std::size_t> next = 0;
  share(thread_count_for((count + size - 1) / size, threads), [&](unsigned thread) {
    try {
      for (std::size_t begin = next.fetch_add(size); begin < count; begin = next.fetch_add(size)) {
        visit(begin, std::min(begin + size, count), thread);
        if (thread == 0) between(std::min(next.load(), count));
      }
    } catch (...) {
      next = count;
      throw;
    }
  });
}

template <typename Visit>
void for_each_block(std::size_t count, std::size_t size, unsigned threads, const Visit& visit) {
  for_each_block(count, size, threads, visit, [](std::size_t) {});
}

// Does the same in blocks of range_size: visit(begin, end).
template <typename Visit, typename Between>
void for_each_range(std::size_t count, unsigned threads, const Visit& visit, const Between& between) {
  for_each_block(
      count, range_size, threads, [&](std::size_t begin, std::size_t end, unsigned) { visit(begin, end); }, between);
}

template <typename Visit>
void for_each_range(std::size_t count, unsigned threads, const Visit& visit) {
  for_each_range(count, threads, visit, [](std::size_t) {});
}

// Calls visit(i) for every i in [0, count), in ranges as for_each_range() does; with one thread in ascending order.
// Every i is an id, so count <= 2^32.
template <typename Visit>
void for_each_id(std::size_t count, unsigned threads, const Visit& visit) {
  for_each_range(count, threads, [&](std::size_t begin, std::size_t end) {
    for_each_short_range(begin, end, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) visit(static_cast<std::uint32_t>(i));
    });
  });
}

// Calls visit(worker, i) for every i in [0, count), each on any thread, in ascending order on each thread; a visit must
// not touch what others write. Every thread has its own worker, made by make_worker(). The calling thread calls
// between() after each of its visits. If between() or a visit throws, every thread stops after its current visit and
// the exception is rethrown here.
template <typename MakeWorker, typename Visit, typename Between>
void for_each_task(std::size_t count, unsigned threads, const MakeWorker& make_worker, const Visit& visit,
                   const Between& between) {
  std::atomic<std::size_t> next = 0;
  const auto work = [&](const auto& after) {
    try {
      auto worker = make_worker();
      for (std::size_t i = next++; i < count; i = next++) {
        make_room();
        visit(worker, i);
        after();
      }
    } catch (...) {
      next = count;
      throw;
    }
  };
  share(thread_count_for(count, threads), [&](unsigned number) {
    if (number == 0)
      work(between);
    else
      work([] {});
  });
}

// Calls visit(i) for every i in [0, count), each on any thread, in ascending order on each thread; a visit must not
// touch what others write.
template <typename Visit>
void for_each_task(std::size_t count, unsigned threads, const Visit& visit) {
  struct Nothing {};
  for_each_task(
      count, threads, [] { return Nothing{}; }, [&](Nothing, std::size_t i) { visit(i); }, [] {});
}

// Calls visit(begin, end, part) for `threads` consecutive parts of [0, count), each on any thread.
template <typename Visit>
void for_each_part(std::size_t count, unsigned threads, const Visit& visit) {
  for_each_task(threads, threads, [&](std::size_t i) { visit(count * i / threads, count * (i + 1) / threads, i); });
}

}  // namespace occlod
