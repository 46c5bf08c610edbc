// Prints what `occlod hlod render` tells people.
#pragma once

#include <string>
#include <vector>

#include "json_output.h"

namespace occlod::tool {

// Describes a column of a table by a key of the data of a frame or run.
struct ReportColumn {
  std::string key;
  std::string title;
  int width = 0;
  int decimals = -1;   // -1: text, or a whole number
  double scale = 1.0;  // factor for numbers with decimals
};

void print_titles(const std::vector<ReportColumn>& columns);
// Prints "-" for what is missing or not finite.
void print_row(const std::vector<ReportColumn>& columns, const Json& told);

// These return the columns of one frame, and of a run over many, with those for compared frames and for HLODs with
// stores if asked for.
[[nodiscard]] std::vector<ReportColumn> frame_columns(bool compared, bool paged = false);
[[nodiscard]] std::vector<ReportColumn> run_columns(bool compared);
// Returns the columns of frames, for their averages.
[[nodiscard]] std::vector<ReportColumn> mean_columns(bool compared, bool paged = false);

// Writes rows as comma-separated values under the keys of all rows, in the order in which they first occur. Writes
// beside `path` and renames. Throws Error that names the file.
void write_csv(const std::string& path, const std::vector<Json>& rows);

}  // namespace occlod::tool
