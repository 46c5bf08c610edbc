#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "occlod/mesh.h"

namespace occlod {
namespace {

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

// Cuts a name without cutting a character of UTF-8.
std::string_view shortened(std::string_view name) {
  if (name.size() <= LeftOut::max_name_bytes) return name;
  std::size_t end = LeftOut::max_name_bytes;
  for (int i = 0; i < 3 && (static_cast<unsigned char>(name[end]) & 0xc0U) == 0x80U; ++i) --end;
  return name.substr(0, end);
}

}  // namespace

void LeftOut::add(std::string_view name, std::uint64_t count) {
  if (count == 0) return;
  std::string shown(shortened(name));
  std::ranges::replace_if(shown, is_control, '?');
  auto at = std::ranges::lower_bound(entries_, shown, {}, &Entry::name);
  if (at == entries_.end() || at->name != shown) {
    if (entries_.size() >= max_names && shown != "others") return add("others", count);
    at = entries_.insert(at, {std::move(shown), 0});
  }
  at->count += count;
}

void LeftOut::add(const LeftOut& more) {
  for (const Entry& entry : more.entries_) add(entry.name, entry.count);
}

std::uint64_t LeftOut::count(std::string_view name) const noexcept {
  const auto at = std::ranges::lower_bound(entries_, name, {}, &Entry::name);
  return at == entries_.end() || at->name != name ? 0 : at->count;
}

}  // namespace occlod
