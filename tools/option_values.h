// Checks the values of options before CLI11 converts them, which takes "-1" for a large number and "" for 0. Invalid
// values are refused in one line with the option, the value and the range.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace occlod::tool {

struct WholeRange {
  std::uint64_t low = 0;
  std::uint64_t high = std::numeric_limits<std::uint64_t>::max();
};

struct RealRange {
  double low = 0.0;
  double high = std::numeric_limits<double>::infinity();  // not a value itself
};

// Triangles, splits, vertices and edges of one mesh are numbered with 32 bits.
inline constexpr std::uint64_t max_elements = std::numeric_limits<std::uint32_t>::max();

inline constexpr std::uint64_t max_threads = 1024;

// These are for CLI::Option::transform(). Numbers are decimal and finite.
[[nodiscard]] CLI::Validator in_range(WholeRange range);
[[nodiscard]] CLI::Validator in_range(RealRange range);
// Takes bytes as byte_count() does, at least as many as `least` says in the same form.
[[nodiscard]] CLI::Validator in_bytes(const std::string& least);
[[nodiscard]] CLI::Validator not_empty();
// This is needed because CLI11 takes whatever follows an option for its value.
[[nodiscard]] CLI::Validator file_name();
[[nodiscard]] CLI::Validator one_of(const std::vector<std::string>& words);

// Parses a part of a value, which must consist of decimal digits only; returns nothing for other text.
[[nodiscard]] std::optional<std::uint64_t> whole_number(const std::string& text);
// Parses bytes: digits, optionally with K, M or G for 1,024, 1,024^2 or 1,024^3; returns nothing for other text.
[[nodiscard]] std::optional<std::uint64_t> byte_count(const std::string& text);
// Returns the value for messages: in quotes, cut short, with control characters as '?'.
[[nodiscard]] std::string shown(const std::string& value);

// `value` is unchanged when the option is not given.
template <class Value, class Range>
CLI::Option* add_number(CLI::App& command, const std::string& name, Value& value, Range range,
                        const std::string& about) {
  return command.add_option(name, value, about)->transform(in_range(range))->type_name("N");
}

template <class Value>
CLI::Option* add_memory(CLI::App& command, Value& bytes, const std::string& least, const std::string& about) {
  return command.add_option("--memory", bytes, about)->transform(in_bytes(least))->type_name("BYTES");
}

template <class Name>
CLI::Option* add_name(CLI::App& command, const std::string& option, Name& name, const std::string& about) {
  return command.add_option(option, name, about)->transform(not_empty())->type_name("NAME");
}

template <class Name>
CLI::Option* add_file(CLI::App& command, const std::string& option, Name& name, const std::string& about) {
  return command.add_option(option, name, about)
      ->transform(file_name())
      ->type_name(option.front() == '-' ? "FILE" : "");
}

// Adds an option that takes one of some words. Help shows them all, and the one that `value` has now.
template <class Value>
CLI::Option* add_choice(CLI::App& command, const std::string& name, Value& value,
                        const std::vector<std::pair<std::string, Value>>& choices, const std::string& about) {
  std::vector<std::string> words;
  std::string text, chosen;
  for (const auto& [word, meaning] : choices) {
    words.push_back(word);
    text += (text.empty() ? "" : "|") + word;
    if (meaning == value) chosen = " [" + word + "]";
  }
  const auto set = [&value, choices](const std::string& given) {
    for (const auto& [word, meaning] : choices)
      if (word == given) value = meaning;
  };
  return command.add_option_function<std::string>(name, set, about)
      ->transform(one_of(words))
      ->option_text(text + chosen);
}

}  // namespace occlod::tool
