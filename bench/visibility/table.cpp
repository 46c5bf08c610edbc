#include "visibility/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/atomic_file.h"
#include "occlod/base.h"

namespace occlod::bench {
namespace {

using tool::Json;

std::string with_separators(std::string digits) {
  const std::size_t first = !digits.empty() && digits[0] == '-' ? 1 : 0;
  for (std::size_t i = digits.size(); i > first + 3;) digits.insert(i -= 3, ",");
  return digits;
}

const Json& value_of(const Json& row, const std::string& key) {
  static const Json nothing;
  const auto found = row.find(key);
  return found == row.end() ? nothing : *found;
}

std::string csv_field(const Json& value) {
  if (value.is_null()) return {};
  std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

void Table::add(Json row) {
  for (const auto& [key, value] : row.items())
    if (std::none_of(columns.begin(), columns.end(), [&k = key](const Column& column) { return column.key == k; }))
      throw Error({name, key, "is no column of this table", "add it"});
  rows.push_back(std::move(row));
}

std::string cell(const Json& value, int digits) {
  if (value.is_null()) return "-";
  if (value.is_number_integer()) return with_separators(value.dump());
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_number_float()) return value.dump();
  const double number = value.get<double>();
  return std::isfinite(number) ? fmt::format("{:.{}f}", number, digits) : "unlimited";
}

std::string markdown(const Table& table) {
  std::string text = table.about + "\n\n";
  if (table.rows.empty()) return text + "(nothing)\n\n";
  std::string rule = "|";
  text += "|";
  for (const Column& column : table.columns) {
    if (column.heading.empty()) continue;
    text += " " + column.heading + " |";
    rule += "---|";
  }
  text += "\n" + rule + "\n";
  for (const Json& row : table.rows) {
    text += "|";
    for (const Column& column : table.columns)
      if (!column.heading.empty()) text += " " + cell(value_of(row, column.key), column.digits) + " |";
    text += "\n";
  }
  return text + "\n";
}

std::string csv(const Table& table) {
  std::string text;
  for (const Column& column : table.columns) text += (text.empty() ? "" : ",") + csv_field(column.key);
  text += "\r\n";
  for (const Json& row : table.rows) {
    for (std::size_t i = 0; i < table.columns.size(); ++i)
      text += (i == 0 ? "" : ",") + csv_field(value_of(row, table.columns[i].key));
    text += "\r\n";
  }
  return text;
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  AtomicFile file(path);
  file.write(std::as_bytes(std::span(text)));
  file.commit();
}

}  // namespace occlod::bench
