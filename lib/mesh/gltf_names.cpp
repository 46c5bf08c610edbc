#include "mesh/gltf_names.h"

#include <cstddef>

namespace occlod {
namespace {

constexpr std::size_t end_of_text = std::string_view::npos;

// Returns the position of the next character that is no blank.
std::size_t skip_blanks(std::string_view text, std::size_t at) { return text.find_first_not_of(" \t\r\n", at); }

// Returns the position behind the string that begins with the quotation mark at `at`.
std::size_t skip_string(std::string_view text, std::size_t at) {
  for (at = text.find_first_of("\"\\", at + 1); at != end_of_text; at = text.find_first_of("\"\\", at + 2))
    if (text[at] == '"') return at + 1;
  return text.size();
}

// Returns the position of the value behind a key that ends at `at`, or end_of_text when it is no key.
std::size_t value_behind(std::string_view text, std::size_t at) {
  const std::size_t colon = skip_blanks(text, at);
  return colon == end_of_text || text[colon] != ':' ? end_of_text : skip_blanks(text, colon + 1);
}

// Calls visit(position of the value) for each object that has the key.
template <class Visit>
void for_each_key(std::string_view text, std::string_view key, const Visit& visit) {
  const std::string quoted = '"' + std::string(key) + '"';
  for (std::size_t at = text.find(quoted); at != end_of_text; at = text.find(quoted, at + 1))
    if (const std::size_t value = value_behind(text, at + quoted.size()); value != end_of_text) visit(value);
}

// Calls visit(key) for each key of the object that begins at `at`, but not for those of objects in it.
template <class Visit>
void for_each_member(std::string_view text, std::size_t at, const Visit& visit) {
  int depth = 0;
  while (at < text.size()) {
    const char c = text[at];
    if (c == '"') {
      const std::size_t end = skip_string(text, at);
      if (depth == 1 && value_behind(text, end) != end_of_text) visit(text.substr(at + 1, end - at - 2));
      at = end;
      continue;
    }
    if (c == '{' || c == '[') ++depth;
    if ((c == '}' || c == ']') && --depth == 0) return;
    ++at;
  }
}

}  // namespace

std::map<std::string, std::uint64_t> count_extensions(std::string_view text) {
  std::map<std::string, std::uint64_t> counts;
  for_each_key(text, "extensions", [&](std::size_t value) {
    if (text[value] == '{') for_each_member(text, value, [&](std::string_view name) { ++counts[std::string(name)]; });
  });
  return counts;
}

std::uint64_t count_key(std::string_view text, std::string_view key) {
  std::uint64_t count = 0;
  for_each_key(text, key, [&](std::size_t) { ++count; });
  return count;
}

}  // namespace occlod
