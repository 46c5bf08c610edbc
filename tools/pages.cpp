#include "pages.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "occlod/base.h"
#include "option_values.h"

namespace occlod::tool {
namespace {

namespace fs = std::filesystem;

struct Command {
  std::string words;  // as typed, like "occlod hlod build"
  const CLI::App* app = nullptr;
};

std::vector<const CLI::App*> subcommands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

void add_commands(const CLI::App& app, const std::string& words, std::vector<Command>& commands) {
  commands.push_back({words, &app});
  for (const CLI::App* const command : subcommands_of(app))
    add_commands(*command, words + " " + command->get_name(), commands);
}

std::vector<Command> commands_of(const CLI::App& program) {
  std::vector<Command> commands;
  add_commands(program, program.get_name(), commands);
  return commands;
}

// Returns the options of the command and of those above it, without positional ones.
std::vector<const CLI::Option*> options_of(const CLI::App& command) {
  std::vector<const CLI::Option*> options;
  for (const CLI::App* app = &command; app != nullptr; app = app->get_parent())
    for (const CLI::Option* const option : app->get_options())
      if (!option->get_lnames().empty() && (app == &command || option->get_lnames()[0] != "help"))
        options.push_back(option);
  return options;
}

bool takes_value(const CLI::Option& option) { return option.get_type_size() != 0; }

// Returns the words that an option takes, as help shows them: "none|zstd [none]".
std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string text = option.get_option_text().substr(0, option.get_option_text().find(' '));
  if (text.find('|') == text.npos) return {};
  std::vector<std::string> words = CLI::detail::split(text, '|');
  std::erase_if(words,
                [](const std::string& word) { return word.find_first_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ") != word.npos; });
  return words;
}

// Returns what may stand after the command.
std::vector<std::string> words_after(const CLI::App& command) {
  std::vector<std::string> words;
  for (const CLI::App* const subcommand : subcommands_of(command)) words.push_back(subcommand->get_name());
  for (const CLI::Option* const option : options_of(command)) words.push_back("--" + option->get_lnames()[0]);
  return words;
}

std::string names_of(const CLI::Option& option) {
  std::string names = "--" + option.get_lnames()[0];
  for (const std::string& name : option.get_snames()) names += " -" + name;
  return names;
}

// Lines of troff begin with neither a dot nor a quote, and '\' and '-' are special.
std::string troff(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if ((c == '.' || c == '\'') && (escaped.empty() || escaped.back() == '\n')) escaped += "\\&";
    if (c == '\\' || c == '-') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string bash_function(const CLI::App& program, const std::string& name) {
  std::string commands, words, values;
  for (const Command& command : commands_of(program)) {
    commands += fmt::format("{}\"{}\"", commands.empty() ? "" : "|", command.words);
    words += fmt::format("    \"{}\") words=\"{}\" ;;\n", command.words, fmt::join(words_after(*command.app), " "));
    for (const CLI::Option* const option : options_of(*command.app))
      if (takes_value(*option))
        for (const std::string& option_name : CLI::detail::split(names_of(*option), ' '))
          values += fmt::format("    \"{} {}\") words=\"{}\" ;;\n", command.words, option_name,
                                fmt::join(choices_of(*option), " "));
  }
  return fmt::format(
      "{0}() {{\n"
      "  local command={1} words= i\n"
      "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
      "    case \"$command ${{COMP_WORDS[i]}}\" in\n"
      "      {2}) command=\"$command ${{COMP_WORDS[i]}}\" ;;\n"
      "    esac\n"
      "  done\n"
      "  case $command in\n"
      "{3}  esac\n"
      "  case \"$command ${{COMP_WORDS[COMP_CWORD-1]}}\" in\n"
      "{4}  esac\n"
      "  COMPREPLY=($(compgen -W \"$words\" -- \"${{COMP_WORDS[COMP_CWORD]}}\"))\n"
      "}}\n",
      name, program.get_name(), commands, words, values);
}

// Returns the text in quotes of fish.
std::string quoted(std::string text) {
  for (std::size_t at = 0; (at = text.find_first_of("\\'", at)) != text.npos; at += 2) text.insert(at, 1, '\\');
  return "'" + text + "'";
}

std::string fish_line(const std::string& command, const CLI::Option& option) {
  std::string line =
      fmt::format("complete -c occlod -n {} -l {}", quoted("__occlod_is " + quoted(command)), option.get_lnames()[0]);
  for (const std::string& name : option.get_snames()) line += " -s " + name;
  if (takes_value(option)) line += " -r";
  if (const auto choices = choices_of(option); !choices.empty())
    line += fmt::format(" -f -a {}", quoted(fmt::format("{}", fmt::join(choices, " "))));
  return line + " -d " + quoted(option.get_description()) + "\n";
}

void write_page(const fs::path& file, const std::string& text) {
  std::error_code ignored;
  fs::create_directories(file.parent_path(), ignored);
  std::ofstream out(file, std::ios::binary);
  out << text << std::flush;
  if (!out) throw Error({file.string(), "", "cannot be written", "check the folder and the space there"});
}

}  // namespace

std::string manual_page(const CLI::App& program, const std::string& version) {
  std::string page = fmt::format(".TH OCCLOD 1 \"\" \"occlod {}\" \"User Commands\"\n.SH NAME\nocclod \\- {}\n",
                                 version, troff(program.get_description()));
  for (const Command& command : commands_of(program)) {
    const std::string title = command.app == &program ? "SYNOPSIS" : "\"" + troff(command.words) + "\"";
    // CLI::App::help() would tell of the command that runs.
    const std::string help =
        command.app->get_formatter()->make_help(command.app, command.words, CLI::AppFormatMode::Normal);
    page += fmt::format(".SH {}\n.nf\n{}.fi\n", title, troff(help));
  }
  return page;
}

std::string bash_completion(const CLI::App& program) {
  return bash_function(program, "_occlod") + "complete -o default -F _occlod occlod\n";
}

std::string zsh_completion(const CLI::App& program) {
  return "#compdef occlod\nautoload -Uz bashcompinit && bashcompinit\n" + bash_function(program, "_occlod_words") +
         "complete -o default -F _occlod_words occlod\n_bash_complete -o default -F _occlod_words\n";
}

std::string fish_completion(const CLI::App& program) {
  std::string names, lines;
  for (const Command& command : commands_of(program)) {
    names += " " + quoted(command.words);
    for (const CLI::App* const subcommand : subcommands_of(*command.app))
      lines += fmt::format("complete -c occlod -f -n {} -a {} -d {}\n", quoted("__occlod_is " + quoted(command.words)),
                           subcommand->get_name(), quoted(subcommand->get_description()));
    for (const CLI::Option* const option : options_of(*command.app)) lines += fish_line(command.words, *option);
  }
  return fmt::format(
      "function __occlod_is\n"
      "  set -l command occlod\n"
      "  for word in (commandline -opc)[2..-1]\n"
      "    contains -- \"$command $word\"{}; and set command \"$command $word\"\n"
      "  end\n"
      "  test \"$command\" = \"$argv[1]\"\n"
      "end\n{}",
      names, lines);
}

void add_pages(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("pages", "Write the manual page and what shells complete");
  command.group("");  // hides it
  const auto folder = std::make_shared<std::string>();
  add_file(command, "FOLDER", *folder, "Folder of the installation")->required();
  command.callback([folder, &app] {
    const fs::path share = fs::path(*folder) / "share";
    write_page(share / "man/man1/occlod.1", manual_page(app, version()));
    write_page(share / "bash-completion/completions/occlod", bash_completion(app));
    write_page(share / "zsh/site-functions/_occlod", zsh_completion(app));
    write_page(share / "fish/vendor_completions.d/occlod.fish", fish_completion(app));
  });
}

}  // namespace occlod::tool
