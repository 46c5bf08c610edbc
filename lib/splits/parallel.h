// Loops over index ranges on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>

#include "base/helper_threads.h"
#include "base/scratch_memory.h"

namespace occlod {

// `asked` threads, or one for each core when it is not positive.
[[nodiscard]] inline unsigned thread_count(int asked) {
  return asked > 0 ? static_cast<unsigned>(asked) : std::max(1U, std::thread::hardware_concurrency());
}

inline constexpr std::size_t range_size = 8192;
inline constexpr std::size_t steps_for_room = 16;  // between two calls of make_room(): each may bring in 2 MB

// Calls visit(begin, end) for consecutive ranges that together are [begin, end), small enough for make_room().
template <typename Visit>
void for_each_short_range(std::size_t begin, std::size_t end, const Visit& visit) {
  while (begin < end) {
    make_room();
    const std::size_t next = std::min(begin + steps_for_room, end);
    visit(begin, next);
    begin = next;
  }
}

// Calls visit(begin, end) for consecutive ranges of range_size that together are [0, count), each on some thread;
// visits must not touch what others write. Between its ranges the calling thread calls between(next), where all ranges
// before `next` are done or under way. Should it or a visit throw, all end after their range, and it is thrown here.
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

// Calls visit(i) for every i of [0, count), likewise, one thread in this order; all are ids, so below 2^32.
template <typename Visit>
void for_each_id(std::size_t count, unsigned threads, const Visit& visit) {
  for_each_range(count, threads, [&](std::size_t begin, std::size_t end) {
    for_each_short_range(begin, end, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) visit(static_cast<std::uint32_t>(i));
    });
  });
}

// Calls visit(worker, i) for every i of [0, count), in this order on each thread but each on any; visits must not touch
// what others write. Every thread has a worker of its own, made by make_worker(). After each of its visits the calling
// thread calls between(). Should it or a visit throw, all end after their visit, and it is thrown here.
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

// Calls visit(begin, end, part) for `threads` consecutive parts of [0, count), each on a thread of its own where the
// system grants as many.
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
