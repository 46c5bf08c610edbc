// Threads: a companion for pieces of work of a few microseconds, helpers, and parallel loops.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

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

// One thread beside the calling one. It spins briefly while it waits for work, so that a piece starts within a fraction
// of a microsecond, and sleeps when there is no work for longer. Used by one thread at a time.
class CompanionThread {
 public:
  CompanionThread() = default;
  ~CompanionThread();
  CompanionThread(const CompanionThread&) = delete;
  CompanionThread& operator=(const CompanionThread&) = delete;

  // Runs `work`, which must live until finish(), on the other thread, or on this one when the system has no more
  // threads. Precondition: no work is running.
  template <typename Work>
  void start(const Work& work) {
    work_ = &work;
    call_ = [](const void* it) { (*static_cast<const Work*>(it))(); };
    start();
  }
  // Waits for the running work, if any, and rethrows its exception.
  void finish() {
    wait();
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }
  // Waits for the running work, if any, and drops its exception.
  void abandon() noexcept {
    wait();
    failure_ = nullptr;
  }

 private:
  enum State : std::uint32_t { resting, working, ending };

  void start();
  void wait() noexcept;
  void forget_lost_thread() noexcept;
  void run() noexcept;
  void work() noexcept;

  std::atomic<std::uint32_t> state_ = resting;
  const void* work_ = nullptr;
  void (*call_)(const void*) = nullptr;
  std::exception_ptr failure_;
  std::thread thread_;  // started with the first work, and again in a child of fork()
  ForkMark began_;      // of thread_
};

// Threads that help the calling one; the destructor waits for them.
class HelperThreads {
 public:
  HelperThreads() = default;
  ~HelperThreads() { wait(); }
  HelperThreads(const HelperThreads&) = delete;
  HelperThreads& operator=(const HelperThreads&) = delete;

  // Runs `work` on a new thread. Returns false, and runs nothing, when the system has no more threads.
  template <typename Work>
  [[nodiscard]] bool start(Work work) {
    try {
      threads_.emplace_back([this, work = std::move(work)] {
        try {
          work();
        } catch (...) {
          note(std::current_exception());
        }
      });
      return true;
    } catch (const std::system_error&) {
      return false;
    }
  }

  // Waits for all threads; rethrows the first exception that one of them threw.
  void join() {
    wait();
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

 private:
  void wait() {
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

  void note(std::exception_ptr failure) {
    const std::scoped_lock lock(mutex_);
    if (!failure_) failure_ = std::move(failure);
  }

  std::mutex mutex_;
  std::exception_ptr failure_;
  std::vector<std::thread> threads_;  // not std::jthread, which some standard libraries lack
};

// Returns `asked`, or the number of cores when it is not positive.
[[nodiscard]] inline unsigned thread_count(int asked) {
  return asked > 0 ? static_cast<unsigned>(asked) : std::max(1U, std::thread::hardware_concurrency());
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

// Calls visit(begin, end) for consecutive ranges of range_size that together are [0, count), each on any thread; a
// visit must not touch what others write. Between its ranges the calling thread calls between(next): all ranges before
// `next` are done or running. If between() or a visit throws, every thread stops after its current range and the
// exception is rethrown here.
template <typename Visit, typename Between>
void for_each_range(std::size_t count, unsigned threads, const Visit& visit, const Between& between) {
  std::atomic<std::size_t> next = 0;
  const auto work = [&](const auto& after) {
    try {
      for (std::size_t begin = next.fetch_add(range_size); begin < count; begin = next.fetch_add(range_size)) {
        visit(begin, std::min(begin + range_size, count));
        after();
      }
    } catch (...) {
      next = count;
      throw;
    }
  };
  HelperThreads others;
  for (unsigned i = 1; i < threads && i * range_size < count; ++i)
    if (!others.start([&] { work([] {}); })) break;
  work([&] { between(std::min(next.load(), count)); });
  others.join();
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
  HelperThreads others;
  for (unsigned i = 1; i < threads && i < count; ++i)
    if (!others.start([&] { work([] {}); })) break;
  work(between);
  others.join();
}

// Calls visit(i) for every i in [0, count), each on any thread, in ascending order on each thread; a visit must not
// touch what others write.
template <typename Visit>
void for_each_task(std::size_t count, unsigned threads, const Visit& visit) {
  struct Nothing {};
  for_each_task(
      count, threads, [] { return Nothing{}; }, [&](Nothing, std::size_t i) { visit(i); }, [] {});
}

// Calls visit(begin, end, part) for `threads` consecutive parts of [0, count), each on its own thread as far as the
// system has threads.
template <typename Visit>
void for_each_part(std::size_t count, unsigned threads, const Visit& visit) {
  HelperThreads others;
  for (std::size_t i = 1; i < threads; ++i) {
    const auto part = [&, i] { visit(count * i / threads, count * (i + 1) / threads, i); };
    if (!others.start(part)) part();
  }
  visit(std::size_t{0}, count / threads, std::size_t{0});
  others.join();
}

}  // namespace occlod
