// occlod-view [FILE...]: opens the viewer.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <string>
#include <vector>

#include "application.h"
#include "command.h"
#include "file_faults.h"
#include "occlod/core/version.h"
#include "setting_table.h"
#include "settings_file.h"

namespace occlod::viewer {
namespace {

constexpr int exit_failed = 1;
constexpr int exit_wrong_use = 2;

void print_error(const std::string& line) { fmt::print(stderr, "occlod-view: error: {}\n", line); }

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
      fmt::print("      {:<14}{}{}\n", parameter.name, parameter.what, parameter.required ? "" : "; may be left out");
  }
  fmt::print(
      "\nOf scripts alone:\n"
      "  wait              \"for\": refinement, path, or pictures with \"count\"\n"
      "  expect            \"figure\" is \"at_least\", \"at_most\"\n"
      "  repeat            \"actions\", so many \"times\" or \"seconds\"\n"
      "  report            one line of JSON with all figures\n\nSettings, for set and flip:\n");
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
  app.set_version_flag("--version", version());
  app.add_option("files", arguments.application.files, "Meshes, hierarchies (.olod) and scenes (.json)");
  app.add_option("--script", arguments.script, "Perform the actions of this file, then end: 0, or 1 when one failed");
  app.add_flag("--actions", arguments.actions, "List everything that a script can do");
  app.add_option("--size", arguments.size, "WxH of the window, in pixels");
  app.add_option("--settings", arguments.settings_file,
                 "File that remembers settings; default: view.json in the user's config folder, none for scripts");
  app.add_option(
      "--calibration", arguments.application.calibration,
      "For auto: what this machine's parts of a frame cost, from a file of occlod render; default: measured");
  app.add_flag("--no-cache", arguments.no_cache, "Build hierarchies anew and keep none");
  app.add_flag("--debug-gl", arguments.application.debug_gl, "Treat what the OpenGL driver complains about as errors");
}

void finish(Arguments& arguments) {
  ApplicationOptions& options = arguments.application;
  if (!arguments.script.empty()) options.script = arguments.script;
  options.settings_file = !arguments.settings_file.empty() ? std::filesystem::path(arguments.settings_file)
                          : options.script                 ? std::filesystem::path()
                                                           : default_settings_file();
  options.use_cache = !arguments.no_cache;
  if (arguments.size.empty()) return;
  ImageSize size;
  int used = 0;
  if (std::sscanf(arguments.size.c_str(), "%dx%d%n", &size.width, &size.height, &used) != 2 ||
      used != static_cast<int>(arguments.size.size()) || size.width < 320 || size.height < 240)
    throw CLI::ValidationError("--size", "is WxH, at least 320x240");
  options.size = size;
}

int run(int argc, char** argv) {
  CLI::App app("Looks at meshes, refined continuously inside a triangle budget and controlled by occlusion.",
               "occlod-view");
  app.footer("F1 shows keys and mouse. Without a display: occlod render.");
  Arguments arguments;
  add_options(app, arguments);
  try {
    app.parse(argc, argv);
    finish(arguments);
    if (arguments.actions)
      print_actions();
    else
      Application(arguments.application).run();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    print_error(fmt::format("{}; see occlod-view --help", error.what()));
    return exit_wrong_use;
  } catch (const std::exception& error) {
    print_error(error.what());
    return exit_failed;
  }
  return 0;
}

}  // namespace
}  // namespace occlod::viewer

int main(int argc, char** argv) {
  occlod::tool::handle_file_faults("occlod-view");
  return occlod::viewer::run(argc, argv);
}
