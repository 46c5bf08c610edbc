// Shows the progress of a command on standard error: a bar that is redrawn on a terminal, lines elsewhere.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "stopwatch.h"

namespace occlod::tool {

enum class ShowProgress { always, automatic, never };  // automatic: if standard error is a terminal

class Progress {
 public:
  explicit Progress(ShowProgress when = ShowProgress::automatic);
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Shows the share `done` in [0, 1]; nothing means unknown. Another `what` begins a new stage. `triangles` is the
  // number that the whole stage works on, for the rate; 0 shows none.
  void show(const std::string& what, std::optional<double> done, std::size_t triangles = 0);
  void clear();  // removes the bar before other output

 private:
  [[nodiscard]] bool is_due(bool new_stage) const;

  bool is_terminal_;
  bool is_shown_;
  std::string what_;  // the stage; empty: none yet
  Stopwatch stage_;
  std::optional<Stopwatch> since_line_;  // since the last output
  bool has_bar_ = false;                 // currently on the screen
};

}  // namespace occlod::tool
