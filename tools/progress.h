// A progress bar on standard error, where that is a terminal.
#pragma once

#include <string>

namespace occlod::tool {

class Progress {
 public:
  Progress();
  ~Progress();  // wipes the bar
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(const std::string& what, double done);  // done in [0, 1]

 private:
  bool is_terminal_;
  std::string line_;  // on the screen now; empty = none
};

}  // namespace occlod::tool
