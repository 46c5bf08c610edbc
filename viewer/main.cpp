// Implements `occlod-view [FILE...]`, which opens the viewer.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <exception>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "application.h"
#include "base/atomic_file.h"
#include "command.h"
#include "file_faults.h"
#include "hlod_cache.h"
#include "occlod/base.h"
#include "setting_table.h"
#include "settings_file.h"
#include "standard_streams.h"

namespace occlod::viewer {
namespace {

constexpr int exit_failed = 1;
constexpr int exit_wrong_use = 2;

void print_error(const std::string& line) {
  tool::write_to_standard_error(fmt::format("occlod-view: error: {}\n", line));
}

std::string values_of(const Setting& setting) {
  switch (setting.kind) {
    case Setting::Kind::toggle:
      return "true or false";
    case Setting::Kind::choice: {
      std::string text;
      for (const char* choice : setting.choices) text += (text.empty() ? "" : ", ") + std::string(choice);
      return text;
    }
    case Setting::Kind::integer:
    case Setting::Kind::number:
      return fmt::format("{} to {} {}", setting.least, setting.most, setting.unit);
    case Setting::Kind::integers:
      return "array of ascending integers";
  }
  return "";
}

void print_actions() {
  fmt::print("A script is {{\"actions\": [{{\"do\": COMMAND, PARAMETER: value, ...}}, ...]}}.\n\nCommands:\n");
  for (const Command* command : all_commands()) {
    fmt::print("  {:<18}{}\n", command->name, command->help);
    for (const Parameter& parameter : command->parameters)
      fmt::print("      {:<14}{}{}\n", parameter.name, parameter.what, parameter.required ? "" : " (optional)");
  }
  fmt::print(
      "\nIn scripts only:\n"
      "  wait              until \"for\" is done: refinement, path, or pictures with a \"count\"\n"
      "  expect            fail unless the \"figure\" is \"at_least\" and \"at_most\" these numbers\n"
      "  repeat            the \"actions\" so many \"times\", or for so many \"seconds\"\n"
      "  report            print all figures as one line of JSON\n\nSettings, for set and flip:\n");
  for (const Setting* setting : all_settings())
    fmt::print("  {:<18}{}; {}\n", setting->name, setting->help, values_of(*setting));
}

struct Arguments {
  ApplicationOptions application;
  std::string script;
  std::string settings_file;
  std::string size;
  bool no_cache = false;
  bool actions = false;
};

void add_options(CLI::App& app, Arguments& arguments) {
  const CLI::Validator named([](const std::string& name) { return std::string(name.empty() ? "is empty" : ""); }, "",
                             "");
  app.set_version_flag("--version", version());
  app.add_option("files", arguments.application.files,
                 "Meshes, hierarchies (.olod), HLODs (.ohlod), scenes (.json) and view cells of them (.vlod)")
      ->check(named);
  app.add_option("--script", arguments.script,
                 "Perform the actions of this file, then exit with 0, or with 1 if one failed")
      ->check(named);
  app.add_flag("--actions", arguments.actions, "List every command and setting that a script can use");
  app.add_option("--size", arguments.size, "Size of the window in pixels, as WxH")->check(named);
  app.add_option("--settings", arguments.settings_file,
                 "File that keeps the settings; default: view.json in the user's config folder, none for scripts")
      ->check(named);
  app.add_option("--calibration", arguments.application.calibration,
                 "For occlusion auto: this machine's costs, from `occlod render --save-calibration`; default: measured")
      ->check(named);
  tool::add_cache_options(app, arguments.application.paged);
  app.add_flag("--no-cache", arguments.no_cache, "Build hierarchies again instead of taking them from the cache");
  app.add_flag("--debug-gl", arguments.application.debug_gl, "Treat messages of the OpenGL driver as errors");
}

// Parses text like "1440x900" without sign, space or anything after it.
ImageSize parse_size(const std::string& text) {
  ImageSize size;
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  const bool has_height = width.ec == std::errc() && width.ptr != end && *width.ptr == 'x';
  const auto height = has_height ? std::from_chars(width.ptr + 1, end, size.height) : width;
  if (!has_height || height.ec != std::errc() || height.ptr != end || !is_window_size(size))
    throw CLI::ValidationError(
        "--size", fmt::format("\"{}\" is not WxH between {}x{} and {}x{}", text, min_window.width, min_window.height,
                              max_window.width, max_window.height));
  return size;
}

// Makes sure that the settings file, which is written at the end, is not an input.
void check_settings_file(const ApplicationOptions& options) {
  if (options.settings_file.empty()) return;
  std::vector<std::filesystem::path> inputs = options.files;
  if (options.script) inputs.push_back(*options.script);
  if (!options.calibration.empty()) inputs.push_back(options.calibration);
  for (const std::filesystem::path& input : inputs)
    if (identity_of(input) == identity_of(options.settings_file))
      throw CLI::ValidationError(
          "--settings", options.settings_file.string() + " would be overwritten, but is opened too; name another file");
}

void finish(Arguments& arguments) {
  ApplicationOptions& options = arguments.application;
  if (!arguments.script.empty()) options.script = arguments.script;
  options.settings_file = !arguments.settings_file.empty() ? std::filesystem::path(arguments.settings_file)
                          : options.script                 ? std::filesystem::path()
                                                           : default_settings_file();
  options.use_cache = !arguments.no_cache;
  if (!arguments.size.empty()) options.size = parse_size(arguments.size);
  check_settings_file(options);
}

// What has asked the viewer to end. The handler may only note it.
std::atomic<int> ending_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);
extern "C" void note_signal(int number) { ending_signal = number; }

// Lets signals end the viewer as closing its window does. A second one ends it at once; one that the parent ignores
// stays ignored.
void note_signals() {
  for (const int number : {SIGHUP, SIGINT, SIGTERM}) {
    struct sigaction before {};
    sigaction(number, nullptr, &before);
    if (before.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = note_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(number, &action, nullptr);
  }
}

void view(const ApplicationOptions& options) {
  note_signals();
  Application application(options);
  while (ending_signal == 0 && application.step()) {
  }
}

void parse_and_run(CLI::App& app, Arguments& arguments, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& call) {  // also --help and --version
    if (call.get_exit_code() != 0) throw;
    std::ostringstream text;
    app.exit(call, text);
    fmt::print("{}", text.str());
    return;
  }
  finish(arguments);
  if (arguments.actions)
    print_actions();
  else
    view(arguments.application);
}

int run(int argc, char** argv) {
  CLI::App app(
      "Shows meshes with view-dependent level of detail: a triangle budget, spent where occlusion culling lets it be "
      "seen.",
      "occlod-view");
  app.footer("F1 lists keys and mouse actions. `occlod render` works without a display.");
  Arguments arguments;
  add_options(app, arguments);
  try {
    parse_and_run(app, arguments, argc, argv);
    tool::flush_standard_output();
    return ending_signal == 0 ? 0 : 128 + ending_signal;  // as in shells
  } catch (const CLI::ParseError& error) {
    print_error(fmt::format("{}; see occlod-view --help", error.what()));
    return exit_wrong_use;
  } catch (const std::system_error& error) {
    print_error(std::ferror(stdout) != 0 ? tool::output_error(error.code()).what() : error.what());
  } catch (const std::exception& error) {
    print_error(error.what());
  }
  return exit_failed;
}

}  // namespace
}  // namespace occlod::viewer

int main(int argc, char** argv) {
  occlod::tool::reserve_standard_streams();
  occlod::tool::handle_file_faults("occlod-view");
  return occlod::viewer::run(argc, argv);
}
