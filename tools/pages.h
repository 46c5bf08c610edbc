// Writes what the shell and `man` want to know of the command line, from the same text as --help.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace occlod::tool {

// Returns the manual page, in the language of troff.
[[nodiscard]] std::string manual_page(const CLI::App& program, const std::string& version);
// Return what completes commands, options and the words that options take; elsewhere names of files.
[[nodiscard]] std::string bash_completion(const CLI::App& program);
[[nodiscard]] std::string zsh_completion(const CLI::App& program);
[[nodiscard]] std::string fish_completion(const CLI::App& program);

// Adds the command `pages FOLDER`, which help does not show: writes the four below share/ in the folder, where an
// installation has them.
void add_pages(CLI::App& app);

}  // namespace occlod::tool
