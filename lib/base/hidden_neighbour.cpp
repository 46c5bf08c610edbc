#include "base/hidden_neighbour.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>

#include "base/platform.h"

namespace occlod {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view hidden_suffix = ".tmp";

// Of the target's name the hidden one has no more bytes: a name may be as long as the file system allows.
constexpr std::size_t longest_stem = 100;

std::string hidden_prefix(const fs::path& target) {
  const std::string name = target.filename().string();
  std::size_t size = std::min(name.size(), longest_stem);
  const auto continues_a_character = [&](std::size_t i) {
    return (static_cast<unsigned char>(name[i]) & 0xC0U) == 0x80;
  };
  while (size > 0 && size < name.size() && continues_a_character(size)) --size;  // UTF-8
  return fmt::format(".{}.", name.substr(0, size));
}

// What a process that was killed while it wrote `target` has left beside it. A process on another machine may be at
// work in the same folder: then its file is new.
bool is_leftover(const fs::directory_entry& entry, const std::string& prefix) {
  const std::string name = entry.path().filename().string();
  if (!name.starts_with(prefix) || !name.ends_with(hidden_suffix)) return false;
  const char* const end = name.data() + name.size();
  int process = 0;
  const auto [after, error] = std::from_chars(name.data() + prefix.size(), end, process);
  if (error != std::errc() || after == end || *after != '-' || process <= 0) return false;
  if (may_be_running(process)) return false;
  std::error_code unknown;
  const auto age = fs::file_time_type::clock::now() - entry.last_write_time(unknown);
  return !unknown && age > std::chrono::minutes(1);
}

}  // namespace

fs::path hidden_neighbour(const fs::path& target) {
  static std::atomic<unsigned> counter = 0;
  return target.parent_path() / fmt::format("{}{}-{}{}", hidden_prefix(target), process_id(), counter++, hidden_suffix);
}

void remove_leftovers(const fs::path& target) {
  const std::string prefix = hidden_prefix(target);
  std::error_code ignored;
  for (fs::directory_iterator entry(folder_of(target), ignored); !ignored && entry != fs::directory_iterator();
       entry.increment(ignored))
    if (std::error_code kept; is_leftover(*entry, prefix)) fs::remove_all(entry->path(), kept);
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

}  // namespace occlod
