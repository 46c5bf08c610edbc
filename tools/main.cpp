#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <system_error>

#include "commands.h"
#include "file_faults.h"
#include "interrupt.h"
#include "occlod/core/error.h"
#include "occlod/core/version.h"

namespace occlod::tool {
namespace {

constexpr int exit_failed = 1;
constexpr int exit_wrong_use = 2;

constexpr const char* out_of_memory =
    "memory: there is not enough of it for this; end other programs, raise its limit, or take a smaller mesh";

void print_error(const std::string& line) { fmt::print(stderr, "occlod: error: {}\n", line); }

int wrong_use(const CLI::App& app, const CLI::ParseError& error) {
  std::string command = "occlod";
  for (const CLI::App* chosen : app.get_subcommands()) command += " " + chosen->get_name();
  print_error(fmt::format("{}; see {} --help", error.what(), command));
  return exit_wrong_use;
}

// A full disk shows when the last of the output is written.
void flush_output() {
  if (std::fflush(stdout) != 0)
    throw Error({"standard output", "", std::generic_category().message(errno), "free some space"});
}

#ifndef OCCLOD_HAS_CGAL
// A command that says why it is not there.
void add_without_cgal(CLI::App& app, const std::string& name) {
  CLI::App& command = *app.add_subcommand(name, "Left out: this program was built without CGAL");
  command.allow_extras();
  command.callback([name] {
    throw Error({name, "", "this program was built without CGAL", "configure the build with -DOCCLOD_WITH_CGAL=ON"});
  });
}
#endif

int run(int argc, char** argv) {
  CLI::App app("Continuous level of detail under a hard triangle budget, controlled by occlusion.", "occlod");
  app.set_version_flag("--version", version());
  app.require_subcommand(1);
  add_generate(app);
  add_build(app);
  add_info(app);
  add_validate(app);
  add_render(app);
  add_cut(app);
#ifdef OCCLOD_HAS_CGAL
  add_compare(app);
  add_repair(app);
#else
  add_without_cgal(app, "compare");
  add_without_cgal(app, "repair");
#endif
  try {
    app.parse(argc, argv);
    flush_output();
  } catch (const CLI::ParseError& error) {
    return error.get_exit_code() == 0 ? app.exit(error) : wrong_use(app, error);
  } catch (const Interrupted& interrupted) {
    print_error(interrupted.what());
    return interrupted.exit_code();
  } catch (const std::bad_alloc&) {
    print_error(out_of_memory);
    return exit_failed;
  } catch (const std::exception& error) {
    print_error(error.what());
    return exit_failed;
  }
  return 0;
}

}  // namespace
}  // namespace occlod::tool

int main(int argc, char** argv) {
  occlod::tool::handle_file_faults("occlod");
  return occlod::tool::run(argc, argv);
}
