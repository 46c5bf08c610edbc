// One thread beside the calling one, for pieces of work of a few microseconds.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <system_error>
#include <thread>
#include <utility>

#include "base/platform.h"

namespace occlod {

// Waits for work without giving up its core for a moment, so that a piece is begun within a fraction of a microsecond;
// without work for longer it sleeps. Used by one thread at a time.
class CompanionThread {
 public:
  CompanionThread() = default;
  ~CompanionThread();
  CompanionThread(const CompanionThread&) = delete;
  CompanionThread& operator=(const CompanionThread&) = delete;

  // Runs `work` on the other thread; it must live until finish(). Where the system has no more threads, it is run here.
  // Precondition: none is under way.
  template <typename Work>
  void start(const Work& work) {
    work_ = &work;
    call_ = [](const void* it) { (*static_cast<const Work*>(it))(); };
    start();
  }
  // Waits for it, if one is under way; throws what it has thrown.
  void finish() {
    wait();
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }
  // Waits for it, if one is under way, and forgets what it has thrown.
  void abandon() noexcept {
    wait();
    failure_ = nullptr;
  }

 private:
  enum State : std::uint32_t { resting, working, ending };

  void start();
  void wait() noexcept;
  void run() noexcept;
  void work() noexcept;

  std::atomic<std::uint32_t> state_ = resting;
  const void* work_ = nullptr;
  void (*call_)(const void*) = nullptr;
  std::exception_ptr failure_;
  std::thread thread_;  // begun with the first work
};

}  // namespace occlod
