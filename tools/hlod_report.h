// What `occlod hlod render` prints for people.
#pragma once

#include <string>
#include <vector>

#include "json_output.h"

namespace occlod::tool {

// A column of a table: a key of what is told of a frame or a run.
struct ReportColumn {
  std::string key;
  std::string title;
  int width = 0;
  int decimals = -1;   // -1: text, or a whole number
  double scale = 1.0;  // that numbers with decimals are multiplied by
};

void print_titles(const std::vector<ReportColumn>& columns);
// What an object lacks or is not finite is shown as "-".
void print_row(const std::vector<ReportColumn>& columns, const Json& told);

// Of one frame, and of a run over many; with what is told of frames that were compared, and of HLODs with stores.
[[nodiscard]] std::vector<ReportColumn> frame_columns(bool compared, bool paged = false);
[[nodiscard]] std::vector<ReportColumn> run_columns(bool compared);
// Those of frames, for their averages.
[[nodiscard]] std::vector<ReportColumn> mean_columns(bool compared, bool paged = false);

// Rows as comma-separated values under the keys of all, in the order in which they come first. Writes beside `path` and
// renames. Throws Error that names the file.
void write_csv(const std::string& path, const std::vector<Json>& rows);

}  // namespace occlod::tool
