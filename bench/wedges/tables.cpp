#include "wedges/tables.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <vector>

#include "occlod/base.h"

namespace occlod::bench {
namespace {

constexpr double allowed_error = 1.25;

std::string number(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "";
}

std::string named(const WedgeRow& row) {
  return row.variant.empty() ? row.tool : fmt::format("{}, {}", row.tool, row.variant);
}

bool is_ours(const WedgeRow& row) { return row.tool == "occlod" && row.variant.empty(); }

// Whether a result has about as few triangles as ours.
bool is_as_small(const WedgeRow& row, const WedgeRow& ours) {
  return static_cast<double>(row.triangles) <= 1.02 * static_cast<double>(ours.triangles) + 2.0;
}

// In the order of their first rows.
template <typename Key>
auto distinct(std::span<const WedgeRow> rows, const Key& key) {
  std::vector<decltype(key(rows[0]))> keys;
  for (const WedgeRow& row : rows)
    if (std::find(keys.begin(), keys.end(), key(row)) == keys.end()) keys.push_back(key(row));
  return keys;
}

std::vector<WedgeRow> chosen(std::span<const WedgeRow> rows, const auto& is_wanted) {
  std::vector<WedgeRow> result;
  for (const WedgeRow& row : rows)
    if (is_wanted(row)) result.push_back(row);
  return result;
}

const WedgeRow& best_of(const std::vector<WedgeRow>& settings) {
  double least = settings[0].geometry_rms_pct;
  for (const WedgeRow& row : settings) least = std::min(least, row.geometry_rms_pct);
  const WedgeRow* best = nullptr;
  for (const WedgeRow& row : settings)
    if (row.geometry_rms_pct <= allowed_error * least &&
        (best == nullptr || row.slip_rms_pct.value_or(0.0) < best->slip_rms_pct.value_or(0.0)))
      best = &row;
  return *best;
}

// What a tool does with as many triangles and as good a shape as ours.
struct Equal {
  double slip = 0.0;
  double error = 0.0;   // geometric: ours, or the least that the tool reaches where that is worse
  std::string variant;  // of the rows next to it
};

// The smallest slip of `rows`, one for each setting, whose error is no larger than `error`, or between two settings, in
// logarithms, where it is equal.
Equal at_error(const std::vector<WedgeRow>& rows, double error) {
  const WedgeRow* least = &rows[0];
  std::optional<Equal> best;
  const auto take = [&](const Equal& equal) {
    if (!best || equal.slip < best->slip) best = equal;
  };
  for (const WedgeRow& a : rows) {
    if (a.geometry_rms_pct < least->geometry_rms_pct) least = &a;
    if (a.geometry_rms_pct > error) continue;
    take({*a.slip_rms_pct, a.geometry_rms_pct, a.variant});
    for (const WedgeRow& b : rows) {
      if (b.geometry_rms_pct <= error || !(a.geometry_rms_pct > 0.0 && *a.slip_rms_pct > 0.0 && *b.slip_rms_pct > 0.0))
        continue;
      const double part = std::log(error / a.geometry_rms_pct) / std::log(b.geometry_rms_pct / a.geometry_rms_pct);
      take({*a.slip_rms_pct * std::pow(*b.slip_rms_pct / *a.slip_rms_pct, part), error,
            fmt::format("{} to {}", a.variant, b.variant)});
    }
  }
  return best ? *best : Equal{*least->slip_rms_pct, least->geometry_rms_pct, least->variant};
}

}  // namespace

std::string csv_of(std::span<const WedgeRow> rows) {
  std::string text =
      "mesh,tool,variant,target,triangles,geometry_rms_pct,geometry_max_pct,slip_rms_pct,slip_max_pct,slip_lost_pct,"
      "psnr_checker_db,psnr_image_db,simplify_ms,bytes_per_vertex,hash\n";
  for (const WedgeRow& r : rows)
    text += fmt::format("{},{},{},{},{},{:.5f},{:.5f},{},{},{},{},{},{:.1f},{},{:016x}\n", r.mesh, r.tool, r.variant,
                        r.target, r.triangles, r.geometry_rms_pct, r.geometry_max_pct, number(r.slip_rms_pct, 5),
                        number(r.slip_max_pct, 5), number(r.slip_lost_pct, 3), number(r.psnr_checker_db, 2),
                        number(r.psnr_image_db, 2), r.milliseconds,
                        r.bytes_per_vertex > 0.0 ? fmt::format("{:.1f}", r.bytes_per_vertex) : "", r.hash);
  return text;
}

std::vector<WedgeRow> read_csv(const std::string& file) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line) || line + "\n" != csv_of({}))
    throw Error({file, "line 1", "is no table of bench_wedges", "give a file that --csv wrote"});
  std::vector<WedgeRow> rows;
  while (std::getline(stream, line)) {
    std::vector<std::string> cells(1);
    for (const char c : line) c == ',' ? cells.emplace_back() : cells.back() += c;
    if (cells.size() != 15)
      throw Error({file, fmt::format("line {}", rows.size() + 2), "has no 15 cells", "write the table again"});
    const auto number = [&](std::size_t i) { return cells[i].empty() ? 0.0 : std::stod(cells[i]); };
    const auto optional = [&](std::size_t i) { return cells[i].empty() ? std::nullopt : std::optional(number(i)); };
    rows.push_back({cells[0], cells[1], cells[2], std::stoul(cells[3]), std::stoul(cells[4]), number(5), number(6),
                    optional(7), optional(8), optional(9), optional(10), optional(11), number(12), number(13),
                    std::stoull(cells[14], nullptr, 16)});
  }
  return rows;
}

std::string best_table(std::span<const WedgeRow> rows) {
  std::string text =
      "| mesh | target | tool | triangles | geometry RMS % | slip RMS % | slip max % | lost % | PSNR checker | PSNR "
      "image | ms | B/vertex |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const std::string& mesh : distinct(rows, [](const WedgeRow& row) { return row.mesh; })) {
    const std::vector<WedgeRow> of_mesh = chosen(rows, [&](const WedgeRow& row) { return row.mesh == mesh; });
    for (const std::size_t target : distinct(of_mesh, [](const WedgeRow& row) { return row.target; })) {
      const std::vector<WedgeRow> asked = chosen(of_mesh, [&](const WedgeRow& row) { return row.target == target; });
      for (const std::string& tool : distinct(asked, [](const WedgeRow& row) {
             return row.variant == "geometry" ? row.tool + ", geometry" : row.tool;
           })) {
        const WedgeRow r = best_of(chosen(asked, [&](const WedgeRow& row) {
          return tool == (row.variant == "geometry" ? row.tool + ", geometry" : row.tool);
        }));
        text +=
            fmt::format("| {} | {} | {} | {} | {:.4f} | {} | {} | {} | {} | {} | {:.0f} | {} |\n", mesh, target,
                        named(r), r.triangles, r.geometry_rms_pct, number(r.slip_rms_pct, 4), number(r.slip_max_pct, 2),
                        number(r.slip_lost_pct, 2), number(r.psnr_checker_db, 1), number(r.psnr_image_db, 1),
                        r.milliseconds, r.bytes_per_vertex > 0.0 ? fmt::format("{:.0f}", r.bytes_per_vertex) : "");
      }
    }
  }
  return text;
}

std::string equal_error_table(std::span<const WedgeRow> rows) {
  std::string text =
      "| mesh | triangles | our geometry RMS % | our slip RMS % | tool | its geometry RMS % | its slip RMS % | ours / "
      "its |\n|---|---|---|---|---|---|---|---|\n";
  for (const WedgeRow& ours : rows) {
    if (!is_ours(ours) || !ours.slip_rms_pct) continue;
    const auto is_asked = [&](const WedgeRow& row) {
      return row.mesh == ours.mesh && row.target == ours.target && row.tool != ours.tool && row.slip_rms_pct;
    };
    const std::vector<WedgeRow> asked = chosen(rows, is_asked);
    for (const std::string& tool : distinct(asked, [](const WedgeRow& row) { return row.tool; })) {
      const std::vector<WedgeRow> settings = chosen(asked, [&](const WedgeRow& row) { return row.tool == tool; });
      const std::vector<WedgeRow> reached =
          chosen(settings, [&](const WedgeRow& row) { return is_as_small(row, ours); });
      text += fmt::format("| {} | {} | {:.4f} | {:.4f} | {}", ours.mesh, ours.triangles, ours.geometry_rms_pct,
                          *ours.slip_rms_pct, tool);
      if (reached.empty()) {
        text += fmt::format(" | stuck at {} triangles | | |\n", settings[0].triangles);
        continue;
      }
      const Equal equal = at_error(reached, ours.geometry_rms_pct);
      text += fmt::format("{}{} | {:.4f} | {:.4f} | {:.2f} |\n", equal.variant.empty() ? "" : ", ", equal.variant,
                          equal.error, equal.slip, *ours.slip_rms_pct / equal.slip);
    }
  }
  return text;
}

std::uint64_t hash_of(std::span<const WedgeRow> rows) {
  std::vector<std::uint64_t> hashes;
  for (const WedgeRow& row : rows) hashes.push_back(row.hash);
  return XXH3_64bits(hashes.data(), sizeof(std::uint64_t) * hashes.size());
}

}  // namespace occlod::bench
