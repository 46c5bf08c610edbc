#include "hlod_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"

namespace occlod::tool {
namespace {

std::string text_of(const ReportColumn& column, const Json& told) {
  const auto found = told.find(column.key);
  if (found == told.end() || found->is_null()) return "-";
  if (found->is_string()) return found->get<std::string>();
  const double value = found->get<double>();
  if (!std::isfinite(value)) return "-";
  return column.decimals < 0 ? found->dump() : fmt::format("{:.{}f}", column.scale * value, column.decimals);
}

std::vector<ReportColumn> with(std::vector<ReportColumn> columns, const std::vector<ReportColumn>& more) {
  columns.insert(columns.end(), more.begin(), more.end());
  return columns;
}

std::vector<std::string> keys_of(const std::vector<Json>& rows) {
  std::vector<std::string> keys;
  for (const Json& row : rows)
    for (const auto& [key, value] : row.items())
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
  return keys;
}

std::string csv_value(const Json& row, const std::string& key) {
  const auto found = row.find(key);
  if (found == row.end() || found->is_null()) return "";
  return found->is_string() ? found->get<std::string>() : found->dump();
}

}  // namespace

void print_titles(const std::vector<ReportColumn>& columns) {
  std::string line;
  for (const ReportColumn& column : columns) line += fmt::format("{:>{}}  ", column.title, column.width);
  line.erase(line.find_last_not_of(' ') + 1);
  fmt::print("{}\n", line);
}

void print_row(const std::vector<ReportColumn>& columns, const Json& told) {
  std::string line;
  for (const ReportColumn& column : columns) line += fmt::format("{:>{}}  ", text_of(column, told), column.width);
  line.erase(line.find_last_not_of(' ') + 1);
  fmt::print("{}\n", line);
}

std::vector<ReportColumn> frame_columns(bool compared, bool paged) {
  const std::vector<ReportColumn> columns = {{"frame", "frame", 6},
                                             {"drawn_nodes", "nodes", 6},
                                             {"rarn", "rarn", 5},
                                             {"delayed", "delayed", 7},
                                             {"blocked", "blocked", 7},
                                             {"drawn_triangles", "triangles", 10},
                                             {"queries", "queries", 7},
                                             {"wasted_queries", "wasted", 6},
                                             {"hidden_nodes", "hidden", 6},
                                             {"largest_sse_px", "SSE px", 7, 2},
                                             {"frame_ms", "ms", 8, 3},
                                             {"stall_ms", "stall ms", 8, 3},
                                             {"starve_ms", "starve ms", 9, 3}};
  const std::vector<ReportColumn> distances = {
      {"depth_rms_px", "RMS px", 7, 3},    {"silhouette_mismatch", "outline %", 9, 3}, {"psnr_y", "PSNR Y", 7, 2},
      {"unculled_psnr_y", "to vfc", 7, 2}, {"wrongly_hidden_px", "lost px", 7},        {"crack_px", "crack px", 8},
      {"popping_px", "pop px", 7, 2},      {"depth_complexity", "layers", 6, 2}};
  constexpr double megabyte = 1e-6;
  const std::vector<ReportColumn> meshes = {{"waiting_nodes", "waiting", 7},
                                            {"missing", "missing", 7},
                                            {"loads", "loads", 6},
                                            {"bytes_loaded", "read MB", 8, 3, megabyte},
                                            {"resident_bytes", "there MB", 8, 2, megabyte},
                                            {"wall_ms", "wall ms", 8, 3}};
  const std::vector<ReportColumn> told = paged ? with(columns, meshes) : columns;
  return with(compared ? with(told, distances) : told, {{"hash", "hash", 16}});
}

std::vector<ReportColumn> mean_columns(bool compared, bool paged) {
  std::vector<ReportColumn> columns = frame_columns(compared, paged);
  for (ReportColumn& column : columns)
    if (column.decimals < 0) column.decimals = column.width > 9 ? 0 : 1;
  return columns;
}

std::vector<ReportColumn> run_columns(bool compared) {
  const std::vector<ReportColumn> columns = {{"device", "device", 19},
                                             {"strategy", "strategy", 8},
                                             {"frame_ms", "ms", 9, 3},
                                             {"fps", "FPS", 8, 1},
                                             {"drawn_nodes", "nodes", 8, 1},
                                             {"rarn", "rarn", 6, 2},
                                             {"delayed", "delayed", 7, 2},
                                             {"blocked", "blocked", 7, 2},
                                             {"drawn_triangles", "triangles", 10, 0},
                                             {"queries", "queries", 8, 1},
                                             {"wasted_queries", "wasted", 7, 1},
                                             {"hidden_nodes", "hidden", 7, 1},
                                             {"largest_sse_px", "SSE px", 8, 2},
                                             {"stall_ms", "stall ms", 8, 3},
                                             {"starve_ms", "starve ms", 9, 3}};
  const std::vector<ReportColumn> distances = {
      {"depth_rms_px", "RMS px", 7, 3},       {"psnr_y", "PSNR Y", 7, 2},     {"unculled_psnr_y", "to vfc", 7, 2},
      {"wrongly_hidden_px", "lost px", 8, 2}, {"crack_px", "crack px", 8, 2}, {"largest_popping_px", "pop px", 7, 2}};
  return with(compared ? with(columns, distances) : columns, {{"hash", "hash", 16}});
}

void write_csv(const std::string& path, const std::vector<Json>& rows) {
  const std::vector<std::string> keys = keys_of(rows);
  AtomicFile file(path);
  const auto write_line = [&file](const std::vector<std::string>& values) {
    file.stream() << fmt::format("{}\n", fmt::join(values, ","));
  };
  write_line(keys);
  for (const Json& row : rows) {
    std::vector<std::string> values;
    for (const std::string& key : keys) values.push_back(csv_value(row, key));
    write_line(values);
  }
  file.commit();
}

}  // namespace occlod::tool
