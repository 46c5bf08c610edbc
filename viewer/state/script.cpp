#include "script.h"

#include <fmt/format.h>

#include "arguments.h"
#include "command.h"
#include "occlod/base.h"

namespace occlod::viewer {
namespace {

constexpr std::chrono::minutes longest_wait{10};

void expect(const Session& session, const JsonPlace& action) {
  action.expect_keys({"do", "figure", "at_least", "at_most"});
  const auto figures = session.figures();
  const auto found = figures.find(action.at("figure").string());
  if (found == figures.end())
    action.at("figure").fail(fmt::format("\"{}\" is no figure that there is now", action.at("figure").string()),
                             "print them by report");
  if (!action.has("at_least") && !action.has("at_most")) action.fail("has neither \"at_least\" nor \"at_most\"");
  if (const auto least = action.find("at_least"); least && !(found->second >= least->number()))
    least->fail(fmt::format("{} is {}", found->first, found->second));
  if (const auto most = action.find("at_most"); most && !(found->second <= most->number()))
    most->fail(fmt::format("{} is {}", found->first, found->second));
}

}  // namespace

Script::Script(const std::filesystem::path& file) : file_(file.string()), document_(parse_json_file(file)) {
  const JsonPlace root(document_, file_);
  root.expect_keys({"actions"});
  levels_.push_back({root.at("actions").elements(), 0, 1, Clock::time_point::max()});
}

bool Script::step(Session& session, const std::function<void(const nlohmann::json&)>& report) {
  check_errors(session);
  while (!levels_.empty()) {
    Level& level = levels_.back();
    if (level.next == level.actions.size()) {
      if (!rewind(level)) levels_.pop_back();
      continue;
    }
    const JsonPlace action = level.actions[level.next];
    if (!may_go_on(session, action)) {
      if (Clock::now() - since_ > longest_wait) action.fail("waited for 10 minutes");
      return true;
    }
    ++level.next;
    since_ = Clock::now();
    last_ = action;
    begin(session, action, report);
    check_errors(session);
  }
  // The effects of the last action may still fail.
  return !(session.settled() && session.state().captures.empty());
}

bool Script::may_go_on(const Session& session, const JsonPlace& action) const {
  if (session.figures().at("pictures") < pictures_to_wait_for_) return false;
  if (waits_for_path_ && !session.state().playback.path.empty()) return false;
  const Command* command = find_command(action.at("do").string());
  if (!session.state().captures.empty()) return false;
  return session.settled() || (command != nullptr && !command->settled);
}

void Script::begin(Session& session, const JsonPlace& action,
                   const std::function<void(const nlohmann::json&)>& report) {
  waits_for_path_ = false;
  const std::string name = action.at("do").string();
  if (name == "wait") {
    begin_wait(session, action);
  } else if (name == "expect") {
    expect(session, action);
  } else if (name == "repeat") {
    begin_repeat(action);
  } else if (name == "report") {
    action.expect_keys({"do"});
    report(session.figures());
  } else {
    perform(session, action);
  }
}

// An error about a file that cannot be written names only the file: this adds the action.
void Script::perform(Session& session, const JsonPlace& action) const {
  try {
    session.perform(action);
  } catch (const Error& error) {
    if (error.diagnosis().subject == file_) throw;
    action.fail(error.what());
  }
}

void Script::begin_wait(const Session& session, const JsonPlace& action) {
  action.expect_keys({"do", "for", "count"});
  const std::string what = action.at("for").string();
  if (what != "pictures" && action.has("count")) action.at("count").fail("goes with pictures only", "remove it");
  if (what == "pictures")
    pictures_to_wait_for_ = session.figures().at("pictures") + action.at("count").integer(1);
  else if (what == "path")
    waits_for_path_ = true;
  else if (what != "refinement")
    action.at("for").fail(fmt::format("\"{}\" is nothing to wait for", what), "use one of: refinement, path, pictures");
}

void Script::begin_repeat(const JsonPlace& action) {
  action.expect_keys({"do", "times", "seconds", "actions"});
  if (action.has("times") == action.has("seconds")) action.fail("needs either \"times\" or \"seconds\"");
  Level level{action.at("actions").elements(), 0, 1, Clock::time_point::max()};
  if (const auto seconds = action.find("seconds")) {
    constexpr double max_s = 1e6;
    if (!(seconds->number() >= 0.0 && seconds->number() <= max_s)) seconds->fail("is not between 0 and 1,000,000");
    level.times_left = 0;
    level.until =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds->number()));
  } else {
    level.times_left = action.at("times").integer(1);
  }
  levels_.push_back(std::move(level));
}

void Script::check_errors(const Session& session) {
  if (session.state().errors == errors_) return;
  errors_ = session.state().errors;
  std::string text = "failed";
  for (const Notice& notice : session.state().notices)
    if (notice.is_error) text = notice.text;
  if (last_) last_->fail(text);
  throw Error({file_, "/actions", text, ""});
}

// Returns to the level's start, if it is to be repeated.
bool Script::rewind(Level& level) {
  if (level.until == Clock::time_point::max()) {
    if (--level.times_left <= 0) return false;
  } else if (Clock::now() >= level.until) {
    return false;
  }
  level.next = 0;
  return true;
}

}  // namespace occlod::viewer
