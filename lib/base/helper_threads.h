// Threads that help the calling one.
#pragma once

#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace occlod {

// Waits for its threads when it ends.
class HelperThreads {
 public:
  HelperThreads() = default;
  ~HelperThreads() { wait(); }
  HelperThreads(const HelperThreads&) = delete;
  HelperThreads& operator=(const HelperThreads&) = delete;

  // Runs `work` on a thread of its own. False, and nothing is run, when the system has no more threads.
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

  // Waits for all; throws what one of them has thrown, the first to do so.
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
  std::vector<std::thread> threads_;  // std::jthread is not in every standard library
};

}  // namespace occlod
