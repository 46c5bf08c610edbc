// Giving up the GIL and taking it back. Python ends a thread that takes it while the interpreter exits, by unwinding
// its stack, which aborts the process in C++ code: daemon threads wait here for the end of the process instead.
#pragma once

#include <nanobind/nanobind.h>

namespace occlod::python {

// Lives while a thread takes the GIL, and as long as it may have to take it again. Its constructor does not return in a
// daemon thread of an interpreter that exits.
class GilGuest {
 public:
  GilGuest() noexcept;
  ~GilGuest();
  GilGuest(const GilGuest&) = delete;
  GilGuest& operator=(const GilGuest&) = delete;
};

// Lets other threads of Python run while it lives.
class ReleasedGil {
 public:
  ReleasedGil() noexcept : state_(PyEval_SaveThread()) {}
  ~ReleasedGil() {
    const GilGuest guest;
    PyEval_RestoreThread(state_);
  }
  ReleasedGil(const ReleasedGil&) = delete;
  ReleasedGil& operator=(const ReleasedGil&) = delete;

 private:
  PyThreadState* state_;
};

// Lets this thread call Python while it lives.
class HeldGil {
  GilGuest guest_;
  nanobind::gil_scoped_acquire gil_;
};

// Registers what is to be done when the interpreter exits.
void handle_exit();

}  // namespace occlod::python
