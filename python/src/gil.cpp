#include "gil.h"

#include <atomic>
#include <chrono>
#include <thread>

namespace occlod::python {
namespace {

std::atomic<int> guests = 0;
std::thread::id exiting_thread;  // written before is_exiting
std::atomic<bool> is_exiting = false;

// Called with the GIL before the interpreter exits. From then on no other thread begins to take the GIL; those that
// have begun get it, and callbacks end.
void exit_without_guests() {
  constexpr auto longest = std::chrono::seconds(5);  // for a callback that waits for something itself
  exiting_thread = std::this_thread::get_id();
  is_exiting = true;
  PyThreadState* const state = PyEval_SaveThread();
  const auto begin = std::chrono::steady_clock::now();
  while (guests > 0 && std::chrono::steady_clock::now() - begin < longest)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  PyEval_RestoreThread(state);
}

}  // namespace

GilGuest::GilGuest() noexcept {
  ++guests;
  if (!is_exiting || std::this_thread::get_id() == exiting_thread) return;
  --guests;
  while (true) std::this_thread::sleep_for(std::chrono::hours(1));
}

GilGuest::~GilGuest() { --guests; }

void handle_exit() {
  nanobind::module_::import_("atexit").attr("register")(nanobind::cpp_function(&exit_without_guests));
}

}  // namespace occlod::python
