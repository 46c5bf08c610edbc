#include "base/threads.h"

#include <memory>

namespace occlod {
namespace {

// Spinning takes about as long as falling asleep and being woken.
constexpr int max_looks = 4000;

// Waits until `current` is no longer `state`: spins first, then sleeps.
void wait_while(const std::atomic<std::uint32_t>& current, std::uint32_t state) noexcept {
  for (int i = 0; i < max_looks; ++i) {
    if (current.load(std::memory_order_acquire) != state) return;
    relax();
  }
  current.wait(state, std::memory_order_acquire);
}

}  // namespace

void CompanionThread::forget_lost_thread() noexcept {
  if (!thread_.joinable() || !began_.is_in_child()) return;
  std::construct_at(&thread_);  // neither joined nor detached
  state_.store(resting, std::memory_order_relaxed);
  failure_ = nullptr;
}

CompanionThread::~CompanionThread() {
  forget_lost_thread();
  if (!thread_.joinable()) return;
  wait();
  state_.store(ending, std::memory_order_release);
  state_.notify_all();
  thread_.join();
}

void CompanionThread::start() {
  forget_lost_thread();
  if (!thread_.joinable()) {
    try {
      began_ = {};
      thread_ = std::thread([this] { run(); });
    } catch (const std::system_error&) {
      work();
      return;
    }
  }
  state_.store(working, std::memory_order_release);
  state_.notify_all();
}

void CompanionThread::wait() noexcept {
  forget_lost_thread();
  while (state_.load(std::memory_order_acquire) == working) wait_while(state_, working);
}

void CompanionThread::run() noexcept {
  while (true) {
    wait_while(state_, resting);
    const std::uint32_t state = state_.load(std::memory_order_acquire);
    if (state == ending) return;
    if (state != working) continue;
    work();
    state_.store(resting, std::memory_order_release);
    state_.notify_all();
  }
}

void CompanionThread::work() noexcept {
  try {
    call_(work_);
  } catch (...) {
    failure_ = std::current_exception();
  }
}

}  // namespace occlod
