#include "help_formatter.h"

#include <sstream>

namespace occlod::tool {
namespace {

// Wraps text. CLI11 indents what follows a line break.
std::string wrap(const std::string& text, std::size_t width) {
  std::istringstream words(text);
  std::string wrapped, word;
  std::size_t column = 0;
  while (words >> word) {
    const bool fits = column + 1 + word.size() <= width;
    if (column > 0) wrapped += fits ? ' ' : '\n';
    column = fits && column > 0 ? column + 1 + word.size() : word.size();
    wrapped += word;
  }
  return wrapped;
}

}  // namespace

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  if (!option->get_option_text().empty()) return " " + option->get_option_text();
  std::string text;
  if (option->get_type_size() != 0) {  // it is not a flag
    if (!option->get_type_name().empty()) text += " " + option->get_type_name();
    if (!option->get_default_str().empty()) text += " [" + option->get_default_str() + "]";
  }
  return option->get_required() ? text + " (required)" : text;
}

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const {
  constexpr std::size_t page_width = 100;
  return wrap(option->get_description(), page_width - get_column_width());
}

std::string HelpFormatter::make_footer(const CLI::App* command) const {
  const std::string footer = CLI::Formatter::make_footer(command);
  if (command->get_parent() == nullptr) return footer;
  return "Of the program, see occlod --help: --json, --progress, --threads, --no-cache\n" +
         (footer.empty() ? "" : "\n" + footer);
}

}  // namespace occlod::tool
