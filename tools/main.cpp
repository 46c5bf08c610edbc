#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "commands.h"
#include "file_faults.h"
#include "global_options.h"
#include "help_formatter.h"
#include "interrupt.h"
#include "occlod/base.h"
#include "option_values.h"
#include "pages.h"
#include "standard_streams.h"
#include "suggestion.h"

namespace occlod::tool {
namespace {

constexpr int exit_failed = 1;
constexpr int exit_wrong_use = 2;

constexpr const char* out_of_memory =
    "memory: not enough for this; end other programs, raise the limit or use a smaller mesh";

// Returns the names of the subcommands, or of the options that may follow the command, with dashes.
std::vector<std::string> known_words(const CLI::App& command, bool options) {
  std::vector<std::string> words;
  if (!options)
    for (const CLI::App* const subcommand : command.get_subcommands([](const CLI::App*) { return true; }))
      words.push_back(subcommand->get_name());
  for (const CLI::App* app = &command; options && app != nullptr; app = app->get_parent())
    for (const CLI::Option* const option : app->get_options())
      for (const std::string& name : option->get_lnames()) words.push_back("--" + name);
  return words;
}

// Describes a word that is no option, command or argument here, and which one may be meant.
std::string what_is_unknown(const CLI::App& command, const std::string& word, bool lacks_command) {
  const bool is_option = word.starts_with('-');
  const char* const kind = is_option ? "option" : lacks_command ? "command" : "further argument";
  std::string text = fmt::format("there is no {} {}", kind, shown(word));
  if (!is_option && !lacks_command) return text;
  const auto meant = meant_by(word.substr(0, word.find('=')), known_words(command, is_option));
  return meant ? fmt::format("{} (did you mean {}?)", text, *meant) : text;
}

// Describes an `error` of `command`, the innermost that was given. CLI11 does not report what was typed instead of a
// command, and names values by their type.
std::string what_is_wrong(const CLI::App& app, const CLI::App& command, const CLI::ParseError& error) {
  const std::string text = error.what();
  const std::vector<std::string> unknown = app.remaining(true);
  const bool lacks_command = command.get_require_subcommand_min() > 0 && command.get_subcommands().empty();
  const auto is = [&](CLI::ExitCodes code) { return error.get_exit_code() == static_cast<int>(code); };
  const bool lacks_option = is(CLI::ExitCodes::RequiredError) && !unknown.empty() && unknown.front().starts_with('-');
  if (!unknown.empty() && (lacks_command || lacks_option || is(CLI::ExitCodes::ExtrasError)))
    return what_is_unknown(command, unknown.front(), lacks_command);
  if (lacks_command) return "a command is missing";
  if (is(CLI::ExitCodes::ArgumentMismatch)) {
    const std::string option = text.substr(0, text.find(':'));
    if (text.find("missing") != std::string::npos) return option + " needs a value";
    if (text.find("At Most") != std::string::npos) return option + " is given more than once";
  }
  return text;
}

int wrong_use(const CLI::App& app, const CLI::ParseError& error) {
  std::string words = "occlod";
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    words += " " + command->get_name();
  }
  print_error(fmt::format("{}; see {} --help", what_is_wrong(app, *command, error), words));
  return exit_wrong_use;
}

#if !defined(OCCLOD_HAS_CGAL) && !defined(OCCLOD_MESHES_ONLY)
// Adds a command that only explains why it is missing.
void add_without_cgal(CLI::App& app, const std::string& name) {
  CLI::App& command = *app.add_subcommand(name, "Left out: this program was built without CGAL");
  command.allow_extras()->fallthrough(false);
  command.callback([name] {
    throw Error({name, "", "this program was built without CGAL", "configure the build with -DOCCLOD_WITH_CGAL=ON"});
  });
}
#endif

// Prints the answer to --help and --version.
void print_answer(const CLI::App& app, const CLI::ParseError& call) {
  std::ostringstream text;
  app.exit(call, text);
  fmt::print("{}", text.str());
}

int parse_and_run(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return wrong_use(app, error);
    print_answer(app, error);
  }
  return 0;
}

int run(int argc, char** argv) {
  CLI::App app("Continuous level of detail under a hard triangle budget, controlled by occlusion.", "occlod");
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_version_flag("--version", version());
  app.require_subcommand(1);
  add_global_options(app);
  add_generate(app);
  add_build(app);
  add_info(app);
  add_validate(app);
#ifndef OCCLOD_MESHES_ONLY
  add_render(app);
#endif
  add_simplify(app);
  add_cut(app);
#ifndef OCCLOD_MESHES_ONLY
  add_hlod(app);
  add_tiles(app);
#ifdef OCCLOD_HAS_SERVER
  add_serve(app);
#endif
  add_cells(app);
#ifdef OCCLOD_HAS_CGAL
  add_compare(app);
  add_repair(app);
#else
  add_without_cgal(app, "compare");
  add_without_cgal(app, "repair");
#endif
  add_pages(app);
#endif
  app.footer(  // must follow the commands, which would inherit it
      "For example:\n"
      "  occlod build statue.ply -o statue.olod\n"
      "  occlod simplify statue.ply -o small.glb --ratio 10%");
  try {
    const int exit_code = parse_and_run(app, argc, argv);
    flush_standard_output();
    return exit_code;
  } catch (const Interrupted& interrupted) {
    print_error(interrupted.what());
    return interrupted.exit_code();
  } catch (const std::bad_alloc&) {
    print_error(out_of_memory);
  } catch (const std::system_error& error) {
    print_error(std::ferror(stdout) != 0 ? output_error(error.code()).what() : error.what());
  } catch (const std::exception& error) {
    print_error(error.what());
  }
  return exit_failed;
}

}  // namespace
}  // namespace occlod::tool

int main(int argc, char** argv) {
  occlod::tool::reserve_standard_streams();
  occlod::tool::handle_file_faults("occlod");
  return occlod::tool::run(argc, argv);
}
