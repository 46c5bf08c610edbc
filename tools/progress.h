// How far a command is, on standard error: a bar that is drawn over and over on a terminal, lines elsewhere.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "stopwatch.h"

namespace occlod::tool {

enum class ShowProgress { always, automatic, never };  // automatic: where standard error is a terminal

class Progress {
 public:
  explicit Progress(ShowProgress when = ShowProgress::automatic);
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `done` in [0, 1], nothing where it cannot be known; another `what` begins a new stage. `triangles`: how many the
  // whole stage works on, for the rate; 0 = tell none.
  void show(const std::string& what, std::optional<double> done, std::size_t triangles = 0);
  void clear();  // wipes the bar, for what is printed next

 private:
  [[nodiscard]] bool is_due(bool new_stage) const;

  bool is_terminal_;
  bool is_shown_;
  std::string what_;  // the stage; empty = none yet
  Stopwatch stage_;
  std::optional<Stopwatch> since_line_;  // since something was printed
  bool has_bar_ = false;                 // on the screen now
};

}  // namespace occlod::tool
