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

// Parses a file. Throws Error for a file that cannot be read, syntax errors (with the line) and keys given twice.
[[nodiscard]] nlohmann::json parse_json_file(const std::filesystem::path& path);

// A value and its place. Refers to the document and the file name; both outlive it.
class JsonPlace {
 public:
  JsonPlace(const nlohmann::json& value, const std::string& file) : value_(&value), file_(&file) {}

  // Throws Error with this place.
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy = {}) const;

  // Of an object: it is one, with no other keys than these.
  void expect_keys(std::span<const std::string_view> keys) const;
  void expect_keys(std::initializer_list<std::string_view> keys) const { expect_keys(std::span(keys)); }
  [[nodiscard]] bool has(std::string_view key) const;
  [[nodiscard]] JsonPlace at(std::string_view key) const;  // the key must be there
  [[nodiscard]] std::optional<JsonPlace> find(std::string_view key) const;
  [[nodiscard]] std::vector<std::pair<std::string, JsonPlace>> members() const;
  // Of an array with at least so many elements.
  [[nodiscard]] std::vector<JsonPlace> elements(std::size_t least = 1) const;

  [[nodiscard]] double number() const;
  [[nodiscard]] int integer(int least) const;  // >= least
  [[nodiscard]] std::uint64_t unsigned_integer() const;
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] std::string string() const;  // not empty
  [[nodiscard]] std::vector<double> numbers(std::size_t count) const;
  [[nodiscard]] bool is_string() const noexcept { return value_->is_string(); }

 private:
  [[nodiscard]] JsonPlace below(const nlohmann::json& value, const std::string& step) const;
  void expect_object() const;

  const nlohmann::json* value_;
  const std::string* file_;
  std::string path_;  // JSON pointer; empty at the root
};

}  // namespace occlod
