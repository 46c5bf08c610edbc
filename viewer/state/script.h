// Performs files of actions, one after the other.
#pragma once

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "session.h"

namespace occlod::viewer {

// Reads {"actions": [{"do": ...}, ...]}. Besides the commands of the viewer there are:
//   {"do": "wait", "for": "refinement" | "path" | "pictures", "count": n}    until it is there, ends, n are drawn
//   {"do": "expect", "figure": name, "at_least": x, "at_most": y}            fails otherwise, see Session::figures
//   {"do": "repeat", "times": n, "actions": [...]}                           or "seconds": until they are over
//   {"do": "report"}                                                         one line of JSON with all figures
// Before an action the script waits until everything before it has taken effect: files are loaded, the mesh is refined,
// pictures are written. Commands with Command::settled = false wait for pictures only.
class Script {
 public:
  // Throws Error for a file that cannot be read or is not such a list. Actions are checked when their turn comes.
  explicit Script(const std::filesystem::path& file);

  // Performs what can be performed now; call it after each picture. Returns false at the end. Throws Error that names
  // the action: what it threw, an error that it led to, or 10 minutes of waiting.
  bool step(Session& session, const std::function<void(const nlohmann::json&)>& report);

 private:
  using Clock = std::chrono::steady_clock;
  struct Level {
    std::vector<JsonPlace> actions;
    std::size_t next = 0;
    int times_left = 1;
    Clock::time_point until;  // of levels with seconds
  };

  [[nodiscard]] bool may_go_on(const Session& session, const JsonPlace& action) const;
  void begin(Session& session, const JsonPlace& action, const std::function<void(const nlohmann::json&)>& report);
  void perform(Session& session, const JsonPlace& action) const;
  void begin_wait(const Session& session, const JsonPlace& action);
  void begin_repeat(const JsonPlace& action);
  void check_errors(const Session& session);
  bool rewind(Level& level);

  std::string file_;
  nlohmann::json document_;
  std::vector<Level> levels_;
  std::optional<JsonPlace> last_;    // that was performed
  double pictures_to_wait_for_ = 0;  // figure "pictures" that ends a wait
  bool waits_for_path_ = false;
  int errors_ = 0;  // before the last action
  Clock::time_point since_ = Clock::now();
};

}  // namespace occlod::viewer
