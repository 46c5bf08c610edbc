#include "global_options.h"

#include <CLI/CLI.hpp>
#include <string>

#include "option_values.h"

namespace occlod::tool {
namespace {

const CLI::App& program_of(const CLI::App& command) {
  const CLI::App* app = &command;
  while (app->get_parent() != nullptr) app = app->get_parent();
  return *app;
}

// Returns the command in words, like "occlod cells info".
std::string words_of(const CLI::App& command) {
  const CLI::App* const parent = command.get_parent();
  return (parent == nullptr ? "" : words_of(*parent) + " ") + command.get_name();
}

// Returns the option if it was given, else null.
const CLI::Option* given(const CLI::App& command, const std::string& name, bool is_used) {
  const CLI::Option* const option = program_of(command).get_option(name);
  if (option->count() == 0) return nullptr;
  if (!is_used) throw CLI::ValidationError(name + " is not used by " + words_of(command));
  return option;
}

ShowProgress progress_of(const std::string& word) {
  if (word == "always") return ShowProgress::always;
  return word == "never" ? ShowProgress::never : ShowProgress::automatic;
}

}  // namespace

void add_global_options(CLI::App& app) {
  app.fallthrough();  // commands that are added later inherit it
  app.option_defaults()->group("Options of all commands, before or after their names");
  app.add_flag("--json")->description("Print the result as one JSON object");
  app.add_option("--progress")
      ->description(
          "Show progress on standard error: always (as lines if that is not a terminal), auto (only on a "
          "terminal) or never")
      ->transform(one_of({"always", "auto", "never"}))
      ->option_text("always|auto|never [auto]");
  app.add_option("--threads")
      ->description("Threads; 0: one per core. No result depends on it, but times do")
      ->transform(in_range(WholeRange{0, max_threads}))
      ->option_text("N [0]");
  app.add_flag("--no-cache")
      ->description("Build the hierarchies and HLODs of scenes and meshes again, and do not keep them");
  app.option_defaults()->group("Options");
}

void read_global_options(const CLI::App& command, const GlobalOptions& options) {
  if (given(command, "--json", options.json != nullptr) != nullptr) *options.json = true;
  if (const CLI::Option* const option = given(command, "--progress", options.progress != nullptr); option != nullptr)
    *options.progress = progress_of(option->as<std::string>());
  if (const CLI::Option* const option = given(command, "--threads", options.threads != nullptr); option != nullptr)
    *options.threads = option->as<int>();
  if (given(command, "--no-cache", options.use_cache != nullptr) != nullptr) *options.use_cache = false;
}

}  // namespace occlod::tool
