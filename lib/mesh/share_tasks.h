// Work on all cores whose result does not depend on which core did what.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <optional>
#include <thread>

#include "base/threads.h"

namespace occlod {

// Hands out 0, 1, ... to any thread.
class TaskQueue {
 public:
  explicit TaskQueue(std::size_t count) : count_(count) {}

  [[nodiscard]] std::optional<std::size_t> next() {
    const std::size_t task = next_++;
    return task < count_ ? std::optional(task) : std::nullopt;
  }

 private:
  std::atomic<std::size_t> next_ = 0;
  std::size_t count_;
};

// Calls work(queue) with one queue of `count` tasks on this thread and on one for each other core, and waits for all.
// Throws what one of them has thrown.
template <class Work>
void share_tasks(std::size_t count, const Work& work) {
  TaskQueue queue(count);
  HelperThreads others;
  const std::size_t threads = std::min<std::size_t>(std::thread::hardware_concurrency(), count);
  for (std::size_t i = 1; i < threads; ++i)
    if (!others.start([&] { work(queue); })) break;
  work(queue);
  others.join();
}

}  // namespace occlod
