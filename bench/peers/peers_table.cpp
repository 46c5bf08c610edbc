#include "peers/peers_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <nlohmann/json.hpp>
#include <optional>

namespace occlod::bench {
namespace {

// How many times as quick as the reference; nothing where that has no row.
std::optional<double> ratio_of(const PeerRow& row, const std::vector<PeerRow>& rows, const std::string& reference) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const PeerRow& other) {
    return other.tool == reference && other.mesh == row.mesh && other.target_triangles == row.target_triangles;
  });
  if (found == rows.end()) return {};
  return found->median_ms() / row.median_ms();
}

}  // namespace

double PeerRow::median_ms() const {
  assert(!milliseconds.empty());
  std::vector<double> sorted = milliseconds;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t middle = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2.0;
}

double PeerRow::mtri_per_s() const { return static_cast<double>(input_triangles) / median_ms() / 1e3; }

std::string format_table(const std::vector<PeerRow>& rows, const std::string& reference) {
  std::string table = fmt::format(
      "| mesh | triangles | to | tool | got | runs | ms | Mtri/s | x {} | RMS % | max % |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n",
      reference);
  for (const PeerRow& row : rows) {
    const auto ratio = ratio_of(row, rows, reference);
    table += fmt::format("| {} | {} | {} | {} | {} | {} | {:.0f} | {:.3f} | {} | {:.4f} | {:.3f} |\n", row.mesh,
                         row.input_triangles, row.target_triangles, row.tool, row.triangles, row.milliseconds.size(),
                         row.median_ms(), row.mtri_per_s(), ratio ? fmt::format("{:.3f}", *ratio) : "-",
                         row.rms_percent, row.max_percent);
  }
  return table;
}

std::string format_json(const std::vector<PeerRow>& rows, const std::string& reference) {
  nlohmann::ordered_json array = nlohmann::ordered_json::array();
  for (const PeerRow& row : rows) {
    const auto ratio = ratio_of(row, rows, reference);
    array.push_back({{"mesh", row.mesh},
                     {"input_triangles", row.input_triangles},
                     {"target_triangles", row.target_triangles},
                     {"tool", row.tool},
                     {"triangles", row.triangles},
                     {"milliseconds", row.milliseconds},
                     {"median_ms", row.median_ms()},
                     {"mtri_per_s", row.mtri_per_s()},
                     {"ratio", ratio ? nlohmann::ordered_json(*ratio) : nlohmann::ordered_json()},
                     {"rms_percent", row.rms_percent},
                     {"max_percent", row.max_percent}});
  }
  return nlohmann::ordered_json{{"reference", reference}, {"rows", array}}.dump(2) + "\n";
}

}  // namespace occlod::bench
