#include "option_values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

namespace occlod::tool {
namespace {

std::string text_of(WholeRange range) {
  if (range.high == WholeRange().high) return fmt::format("a whole number of at least {}", range.low);
  return fmt::format("a whole number from {} to {}", range.low, range.high);
}

std::string text_of(RealRange range) {
  if (range.high == RealRange().high) return fmt::format("a finite number of at least {}", range.low);
  return fmt::format("a number from {} to {}", range.low, range.high);
}

bool parse(const std::string& text, std::uint64_t& value) {
  const char* const end = text.data() + text.size();
  const auto [after, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && after == end;
}

bool parse(const std::string& text, double& value) {
  return CLI::detail::lexical_cast(text, value) && std::isfinite(value);
}

template <class Number, class Range>
CLI::Validator validator(const Range& range) {
  const auto check = [range](std::string& text) -> std::string {
    Number value{};
    if (parse(text, value) && value >= range.low && value <= range.high) {
      text = fmt::format("{}", value);  // so that "010" is ten everywhere
      return "";
    }
    return shown(text) + " is not " + text_of(range);
  };
  return {check, ""};
}

}  // namespace

CLI::Validator in_range(WholeRange range) { return validator<std::uint64_t>(range); }
CLI::Validator in_range(RealRange range) { return validator<double>(range); }

CLI::Validator one_of(const std::vector<std::string>& words) {
  const auto check = [words](std::string& text) {
    const bool is_known = std::find(words.begin(), words.end(), text) != words.end();
    return is_known ? "" : fmt::format("{} is not one of {}", shown(text), fmt::join(words, ", "));
  };
  return {check, ""};
}

CLI::Validator in_bytes(const std::string& least) {
  const auto check = [least](std::string& text) -> std::string {
    const auto bytes = byte_count(text);
    if (!bytes || *bytes < byte_count(least))
      return fmt::format("{} is not a number of bytes, or one with K, M or G, of at least {}", shown(text), least);
    text = fmt::format("{}", *bytes);
    return "";
  };
  return {check, ""};
}

CLI::Validator not_empty() {
  return {[](std::string& text) -> std::string { return text.empty() ? "\"\" is not a name" : ""; }, ""};
}

CLI::Validator file_name() {
  const auto check = [](std::string& text) -> std::string {
    if (text.empty()) return "\"\" is not a name";
    if (text.front() == '-') return fmt::format("{} looks like an option; write ./{} for a file", shown(text), text);
    return "";
  };
  return {check, ""};
}

std::optional<std::uint64_t> whole_number(const std::string& text) {
  std::uint64_t value = 0;
  return parse(text, value) ? std::optional(value) : std::nullopt;
}

std::optional<std::uint64_t> byte_count(const std::string& text) {
  constexpr std::string_view units = "KMG";
  const std::size_t unit = text.empty() ? units.npos : units.find(text.back());
  const auto count = whole_number(unit == units.npos ? text : text.substr(0, text.size() - 1));
  const std::uint64_t factor = unit == units.npos ? 1 : std::uint64_t{1} << (10 * (unit + 1));
  if (!count || *count > std::numeric_limits<std::uint64_t>::max() / factor) return std::nullopt;
  return *count * factor;
}

std::string shown(const std::string& value) {
  constexpr std::size_t max_characters = 40;
  std::string text = value.substr(0, max_characters) + (value.size() > max_characters ? "..." : "");
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, '?');
  return '"' + text + '"';
}

}  // namespace occlod::tool
