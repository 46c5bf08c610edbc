// Formats --help: descriptions are wrapped, defaults are in brackets.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace occlod::tool {

class HelpFormatter : public CLI::Formatter {
 protected:
  // Returns text like "N [10000]".
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
  // Adds a line about the options of the program.
  std::string make_footer(const CLI::App* command) const override;
};

}  // namespace occlod::tool
