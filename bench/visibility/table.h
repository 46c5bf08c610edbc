// Tables that are printed as markdown and written as CSV and JSON.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "json_output.h"

namespace occlod::bench {

struct Column {
  std::string key;      // in rows, CSV and JSON
  std::string heading;  // in markdown; empty = not there
  int digits = 2;       // after the point, of numbers that are not integers; markdown only
};

// Rows are objects with any of the columns' keys; what a row leaves out or holds as null is empty.
struct Table {
  std::string name;   // of its CSV file and in the JSON
  std::string about;  // printed above it
  std::vector<Column> columns;
  std::vector<tool::Json> rows;

  // Throws Error for a row with a key that no column has.
  void add(tool::Json row);
};

// "1234567" with thousands separated, numbers with a point by digits, text as it is, "-" for nothing.
[[nodiscard]] std::string cell(const tool::Json& value, int digits);

// Title line and table; a table without rows says so.
[[nodiscard]] std::string markdown(const Table& table);

// RFC 4180: all columns, full precision, text and structures quoted where they must be.
[[nodiscard]] std::string csv(const Table& table);

// `text` as a file that appears whole or not at all. Throws Error.
void write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace occlod::bench
