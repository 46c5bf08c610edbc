#include "splits/corner_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace occlod {
namespace {

// The masks of a fan's places and the wedges that they list.
struct FanCorners {
  std::uint32_t first_mask = 0, second_mask = 0;
  std::array<WedgeId, SplitStar::most_ring> firsts{}, seconds{};
  std::size_t first_count = 0, second_count = 0;
};

FanCorners corners_of_fan(const SplitStar& star, std::span<const Triangle> wedges) {
  FanCorners result;
  const std::span<const VertexId> ring = star.ring();
  const auto slots = static_cast<std::uint32_t>(wedges.size());
  for (std::uint32_t place = 0; place < ring.size(); ++place) {
    const bool begins = place<slots, ends = place> 0 || slots == ring.size();
    const WedgeId end = ends ? wedges[place > 0 ? place - 1 : slots - 1].z : no_id;
    const WedgeId begin = begins ? wedges[place].y : end;
    if (begin != ring[place]) {
      result.first_mask |= 1U << place;
      result.firsts[result.first_count++] = begin;
    }
    if (ends && end != begin) {
      result.second_mask |= 1U << place;
      result.seconds[result.second_count++] = end;
    }
  }
  return result;
}

// The second wedge of v, and which one each slot has; false where 4 bits are too few.
bool append_apexes(const SplitStar& star, std::span<const Triangle> wedges, WedgeId second,
                   std::vector<std::uint32_t>& words) {
  const std::size_t begin = words.size();
  words.push_back(second);
  for (std::size_t slot = 0; slot < wedges.size(); ++slot) {
    const WedgeId wedge = wedges[slot].x;
    const std::uint32_t which = wedge == star.vertex() ? 0 : wedge - second + 1;
    if (which >= SplitCorners::most_apex_wedges) {
      words.resize(begin);
      return false;
    }
    if (slot % 8 == 0) words.push_back(0);
    words.back() |= which << (4 * (slot % 8));
  }
  return true;
}

bool append_fan_corners(const SplitStar& star, std::span<const Triangle> wedges, std::vector<std::uint32_t>& words) {
  if (!star.is_fan()) return false;
  const FanCorners fan = corners_of_fan(star, wedges);
  const std::size_t begin = words.size();
  words.insert(words.end(), {fan.first_mask, fan.second_mask});
  words.insert(words.end(), fan.firsts.begin(), fan.firsts.begin() + static_cast<std::ptrdiff_t>(fan.first_count));
  words.insert(words.end(), fan.seconds.begin(), fan.seconds.begin() + static_cast<std::ptrdiff_t>(fan.second_count));
  WedgeId second = no_id;
  for (const Triangle& t : wedges)
    if (t.x != star.vertex()) second = std::min(second, t.x);
  if (second == no_id) return true;
  words[begin + 1] |= SplitCorners::apex_bit;
  if (append_apexes(star, wedges, second, words)) return true;
  words.resize(begin);
  return false;
}

}  // namespace

void append_corners(const SplitStar& star, std::span<const Triangle> wedges, std::vector<std::uint32_t>& words) {
  bool all_first = true;
  for (std::uint32_t slot = 0; slot < wedges.size(); ++slot)
    all_first = all_first && wedges[slot] == star.inserted(slot);
  if (all_first || append_fan_corners(star, wedges, words)) return;
  words.push_back(SplitCorners::explicit_bit);
  for (const Triangle& t : wedges) words.insert(words.end(), {t.x, t.y, t.z});
}

std::optional<std::string> check_corners(const SplitStar& star, std::span<const std::uint32_t> record, SplitId s,
                                         std::span<const VertexId> extra_wedges, std::size_t vertices) {
  if (record.empty()) return std::nullopt;
  const auto wrong = [&] { return fmt::format("the wedges at the corners of split {} do not fit its star", s); };
  if ((record[0] & SplitCorners::explicit_bit) != 0) {
    if (record.size() != 1 + 3 * std::size_t{star.inserted_count()}) return wrong();
  } else {
    if (!star.is_fan() || record.size() < 2) return wrong();
    const std::uint32_t places = (1U << star.ring().size()) - 1;
    if (((record[0] | (record[1] & ~SplitCorners::apex_bit)) & ~places) != 0 ||
        record.size() != SplitCorners::word_count(record[0], record[1], star.inserted_count()))
      return wrong();
  }
  const SplitCorners corners(star, record);
  for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot) {
    const Triangle face = star.inserted(slot), wedges = corners.inserted(slot);
    for (int k = 0; k < 3; ++k)
      if (!is_wedge_of(wedges[k], face[k], extra_wedges, vertices))
        return fmt::format("split {} has a corner with a wedge of another vertex", s);
  }
  return std::nullopt;
}

}  // namespace occlod
