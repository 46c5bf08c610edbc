// Reads JSON strictly: every mistake is an Error that names the file and the place in it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace occlod {

// JSON of more nested arrays and objects than this is refused before it is parsed: parsers call themselves.
inline constexpr int max_json_depth = 200;

// Returns whether arrays and objects of a JSON text nest more than max_json_depth deep. O(size).
[[nodiscard]] bool is_nested_too_deeply(std::string_view text) noexcept;

// Parses a file. Throws Error for a file that cannot be read, for syntax errors (with the line), for repeated keys
// and for more than max_json_depth nested arrays and objects.
[[nodiscard]] nlohmann::json parse_json_file(const std::filesystem::path& path);

// A value and its place in a document. Refers to the document and the file name, which must outlive it.
class JsonPlace {
 public:
  JsonPlace(const nlohmann::json& value, const std::string& file) : value_(&value), file_(&file) {}

  // Throws Error that names the file and this place.
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy = {}) const;

  // Throws Error unless the value is an object whose keys are all among `keys`.
  void expect_keys(std::span<const std::string_view> keys) const;
  void expect_keys(std::initializer_list<std::string_view> keys) const { expect_keys(std::span(keys)); }
  [[nodiscard]] bool has(std::string_view key) const;
  [[nodiscard]] JsonPlace at(std::string_view key) const;  // throws Error when the key is missing
  [[nodiscard]] std::optional<JsonPlace> find(std::string_view key) const;
  [[nodiscard]] std::vector<std::pair<std::string, JsonPlace>> members() const;
  // Returns the elements of an array. Throws Error unless the value is an array with at least `least` elements.
  [[nodiscard]] std::vector<JsonPlace> elements(std::size_t least = 1) const;

  [[nodiscard]] double number() const;
  [[nodiscard]] int integer(int least) const;  // throws Error when it is less than `least`
  [[nodiscard]] std::uint64_t unsigned_integer() const;
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] std::string string() const;  // throws Error when it is empty
  [[nodiscard]] std::vector<double> numbers(std::size_t count) const;
  [[nodiscard]] bool is_string() const noexcept { return value_->is_string(); }
  // Returns the value as JSON in ASCII for messages, its first 60 characters.
  [[nodiscard]] std::string text() const;

 private:
  [[nodiscard]] JsonPlace below(const nlohmann::json& value, const std::string& step) const;
  void expect_object() const;

  const nlohmann::json* value_;
  const std::string* file_;
  std::string path_;  // JSON pointer; empty at the root
};

}  // namespace occlod
