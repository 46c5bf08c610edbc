#include "base/strict_json.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>
#include <utility>

#include "base/file_input.h"
#include "occlod/base.h"

namespace occlod {
namespace {

using nlohmann::json;

std::string read_text(const std::filesystem::path& path) {
  require_no_special_file(path);
  std::ifstream stream(path, std::ios::binary);
  std::error_code ignored;
  if (!stream || std::filesystem::is_directory(path, ignored))
    throw Error({path.string(), "", "cannot be read", "check its name and permissions"});
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::size_t line_of(const std::string& text, std::size_t byte) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text.size()));
  return 1 + static_cast<std::size_t>(std::count(text.begin(), end, '\n'));
}

// Keeps the last part of messages like "[json.exception.parse_error.101] parse error at line 1, column 2: what".
std::string without_prefix(const char* what) {
  const std::string_view text = what;
  const std::size_t colon = text.find(": ");
  return std::string(colon == std::string_view::npos ? text : text.substr(colon + 2));
}

// Finds repeated keys, of which nlohmann::json silently keeps the last.
class RepeatedKeys {
 public:
  bool operator()(int depth, json::parse_event_t event, json& value) {
    const auto level = static_cast<std::size_t>(depth);
    if (event == json::parse_event_t::object_start) {
      keys_.resize(std::max(keys_.size(), level + 2));
      keys_[level + 1].clear();
    } else if (event == json::parse_event_t::key && !keys_[level].insert(value.get<std::string>()).second &&
               repeated_.empty()) {
      repeated_ = value.get<std::string>();
    }
    return true;
  }
  [[nodiscard]] const std::string& repeated() const noexcept { return repeated_; }

 private:
  std::vector<std::set<std::string>> keys_;  // keys of the open objects, by depth
  std::string repeated_;
};

}  // namespace

bool is_nested_too_deeply(std::string_view text) noexcept {
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {  // to the end of the string, at a quotation mark behind an even number of backslashes
      for (i = text.find('"', i + 1); i != std::string_view::npos; i = text.find('"', i + 1)) {
        std::size_t begin = i;
        while (text[begin - 1] == '\\') --begin;
        if ((i - begin) % 2 == 0) break;
      }
      if (i == std::string_view::npos) return false;
    } else if (c == '[' || c == '{') {
      if (++depth > max_json_depth) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

json parse_json_file(const std::filesystem::path& path) {
  const std::string text = read_text(path);
  if (is_nested_too_deeply(text))
    throw Error({path.string(), "", fmt::format("has more than {} nested arrays and objects", max_json_depth),
                 "write it with fewer"});
  RepeatedKeys repeated_keys;
  json document;
  try {
    document = json::parse(text, std::ref(repeated_keys));
  } catch (const json::parse_error& error) {
    throw Error({path.string(), fmt::format("line {}", line_of(text, error.byte)), without_prefix(error.what()),
                 "write valid JSON"});
  } catch (const json::exception& error) {
    throw Error({path.string(), "", without_prefix(error.what()), "write valid JSON"});
  }
  if (!repeated_keys.repeated().empty())
    throw Error({path.string(), "", fmt::format("the key \"{}\" appears twice in one object", repeated_keys.repeated()),
                 "keep one of them"});
  return document;
}

void JsonPlace::fail(const std::string& problem, const std::string& remedy) const {
  throw Error({*file_, path_.empty() ? "/" : path_, problem, remedy});
}

std::string JsonPlace::text() const {
  constexpr std::size_t longest = 60;
  std::string text = value_->dump(-1, ' ', true, json::error_handler_t::replace);
  if (text.size() > longest) text = text.substr(0, longest) + "...";
  return text;
}

JsonPlace JsonPlace::below(const json& value, const std::string& step) const {
  JsonPlace place(value, *file_);
  place.path_ = path_ + "/" + step;
  return place;
}

void JsonPlace::expect_object() const {
  if (!value_->is_object()) fail(fmt::format("is {}, not an object", value_->type_name()));
}

void JsonPlace::expect_keys(std::span<const std::string_view> keys) const {
  for (const auto& [key, place] : members())
    if (std::find(keys.begin(), keys.end(), key) == keys.end())
      place.fail("is not a known key", fmt::format("use one of: {}", fmt::join(keys, ", ")));
}

bool JsonPlace::has(std::string_view key) const { return find(key).has_value(); }

JsonPlace JsonPlace::at(std::string_view key) const {
  const std::optional<JsonPlace> found = find(key);
  if (!found) fail(fmt::format("has no \"{}\"", key), "add it");
  return *found;
}

std::optional<JsonPlace> JsonPlace::find(std::string_view key) const {
  expect_object();
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
  return below(*found, std::string(key));
}

std::vector<std::pair<std::string, JsonPlace>> JsonPlace::members() const {
  expect_object();
  std::vector<std::pair<std::string, JsonPlace>> result;
  for (const auto& [key, value] : value_->items()) result.emplace_back(key, below(value, key));
  return result;
}

std::vector<JsonPlace> JsonPlace::elements(std::size_t least) const {
  if (!value_->is_array()) fail(fmt::format("is {}, not an array", value_->type_name()));
  if (value_->size() < least) fail("is an empty array", "give at least one element");
  std::vector<JsonPlace> result;
  for (std::size_t i = 0; i < value_->size(); ++i) result.push_back(below((*value_)[i], std::to_string(i)));
  return result;
}

double JsonPlace::number() const {
  if (!value_->is_number()) fail(fmt::format("is {}, not a number", value_->type_name()));
  return value_->get<double>();
}

int JsonPlace::integer(int least) const {
  constexpr int most = std::numeric_limits<int>::max();
  // The parser stores every integer >= 0 as unsigned, so a signed one is negative.
  const bool fits =
      value_->is_number_unsigned() ? value_->get<std::uint64_t>() <= std::uint64_t{most} : value_->is_number_integer();
  if (!fits || value_->get<int>() < least) fail(fmt::format("is not an integer between {} and {}", least, most));
  return value_->get<int>();
}

std::uint64_t JsonPlace::unsigned_integer() const {
  if (!value_->is_number_unsigned()) fail("is not an integer >= 0");
  return value_->get<std::uint64_t>();
}

bool JsonPlace::boolean() const {
  if (!value_->is_boolean()) fail(fmt::format("is {}, not true or false", value_->type_name()));
  return value_->get<bool>();
}

std::string JsonPlace::string() const {
  if (!value_->is_string()) fail(fmt::format("is {}, not a string", value_->type_name()));
  auto text = value_->get<std::string>();
  if (text.empty()) fail("is an empty string");
  return text;
}

std::vector<double> JsonPlace::numbers(std::size_t count) const {
  if (!value_->is_array() || value_->size() != count) fail(fmt::format("is not an array of {} numbers", count));
  std::vector<double> result;
  for (const JsonPlace& element : elements()) result.push_back(element.number());
  return result;
}

}  // namespace occlod
