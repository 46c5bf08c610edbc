// How --help looks: descriptions wrapped, defaults in brackets.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace occlod::tool {

class HelpFormatter : public CLI::Formatter {
 protected:
  // "N [10000]"
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
  // With a line that tells of the options of the program.
  std::string make_footer(const CLI::App* command) const override;
};

}  // namespace occlod::tool
