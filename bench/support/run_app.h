// What the main() of every benchmark with options of its own does.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

namespace occlod::bench {

// Rounds that are timed; times are their medians.
inline void add_repeat_option(CLI::App& app, int& repeat, const std::string& what) {
  app.add_option("--repeat", repeat, what + "; times are medians")->capture_default_str()->check(CLI::PositiveNumber);
}

// Reads the options, then works. Returns the exit status: 0, 1 with a line on standard error, or what CLI11 says.
template <typename Work>
int run_app(CLI::App& app, int argc, char** argv, const Work& work) {
  CLI11_PARSE(app, argc, argv);
  try {
    work();
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: error: {}\n", app.get_name(), error.what());
    return 1;
  }
  return 0;
}

}  // namespace occlod::bench
