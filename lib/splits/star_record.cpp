#include "splits/star_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "splits/star.h"

namespace occlod {
namespace {

// Returns the number of outer vertices of a fan.
std::size_t ring_size(const StarContents& star) {
  return star.inserted.size() + (star.shape == StarShape::open_fan ? 1 : 0);
}
VertexId ring_at(const StarContents& star, std::size_t place) {
  return place < star.inserted.size() ? star.inserted[place].y : star.inserted.back().z;
}

// Sorts the removed faces into the order of slots; returns false when they are not the faces that the fan implies.
bool match_removed(const StarContents& star, std::size_t parent_place) {
  const std::size_t size = ring_size(star);
  std::size_t found = 0;
  for (std::size_t slot = 0; slot < star.inserted.size(); ++slot) {
    const std::size_t next = slot + 1 == size ? 0 : slot + 1;
    if (slot == parent_place || next == parent_place) continue;
    const VertexId a = star.inserted[slot].y, b = star.inserted[slot].z;
    std::size_t i = found;
    const auto is_it = [&](const Triangle& t) {
      return (t.x == star.u && t.y == a && t.z == b) || (t.y == star.u && t.z == a && t.x == b) ||
             (t.z == star.u && t.x == a && t.y == b);
    };
    while (i < star.removed.size() && !is_it(star.removed[i].corners)) ++i;
    if (i == star.removed.size()) return false;
    std::swap(star.removed[found++], star.removed[i]);
  }
  return found == star.removed.size();
}

bool append_fan(const StarContents& star, std::vector<std::uint32_t>& words) {
  if (star.shape == StarShape::other || star.dependencies.size() > SplitStar::max_dependencies) return false;
  const std::size_t size = ring_size(star);
  if (size > SplitStar::max_ring) return false;
  std::size_t parent_place = 0;
  while (parent_place < size && ring_at(star, parent_place) != star.u) ++parent_place;
  if (parent_place == size || !match_removed(star, parent_place)) return false;
  for (const RemovedFace& face : star.removed)
    if (face.ref.split == no_id || face.ref.slot >= SplitStar::max_slots) return false;

  words.push_back(static_cast<std::uint32_t>(size | parent_place << 8U | star.dependencies.size() << 16U) |
                  (star.shape == StarShape::closed_fan ? SplitStar::closed_bit : 0U));
  for (std::size_t place = 0; place < size; ++place) words.push_back(ring_at(star, place));
  words.insert(words.end(), star.dependencies.begin(), star.dependencies.end());
  for (std::size_t i = 0; i < star.removed.size(); ++i) {
    if (i % 4 == 0) words.push_back(0);
    const FaceRef& ref = star.removed[i].ref;
    const auto at = std::lower_bound(star.dependencies.begin(), star.dependencies.end(), ref.split);
    const auto dependency = static_cast<std::uint32_t>(at - star.dependencies.begin());
    words.back() |= (ref.slot << 4U | dependency) << (8 * (i % 4));
  }
  return true;
}

void append_corners(const Triangle& t, std::vector<std::uint32_t>& words) {
  for (int k = 0; k < 3; ++k) words.push_back(t[k]);
}

bool is_fan_header(std::uint32_t header) {
  const std::uint32_t size = header & 0xFFU, parent_place = (header >> 8U) & 0xFFU;
  constexpr std::uint32_t known_bits = 0xFFFFFFU | SplitStar::closed_bit;
  return (header & ~known_bits) == 0 && size >= 2 && size <= SplitStar::max_ring && parent_place < size &&
         ((header >> 16U) & 0xFFU) <= SplitStar::max_dependencies;
}

// Checks that the bytes after the dependencies refer to existing dependencies.
bool names_dependencies(const SplitStar& star, std::span<const std::uint32_t> record) {
  const std::size_t first = record.size() - (star.removed_count() + 3) / 4;
  for (std::uint32_t i = 0; i < star.removed_count(); ++i)
    if (((record[first + i / 4] >> (8 * (i % 4))) & 0xFU) >= star.dependencies().size()) return false;
  return true;
}

}  // namespace

void append_star(const StarContents& star, std::vector<std::uint32_t>& words) {
  if (append_fan(star, words)) return;
  words.insert(words.end(),
               {SplitStar::other_bit, star.u, static_cast<std::uint32_t>(star.inserted.size()),
                static_cast<std::uint32_t>(star.dependencies.size()), static_cast<std::uint32_t>(star.removed.size())});
  for (const Triangle& t : star.inserted) append_corners(t, words);
  words.insert(words.end(), star.dependencies.begin(), star.dependencies.end());
  for (const RemovedFace& face : star.removed) {
    words.insert(words.end(), {face.ref.split, face.ref.slot});
    append_corners(face.corners, words);
  }
}

bool append_fan(const FanContents& fan, std::vector<std::uint32_t>& words) {
  const std::size_t size = fan.ring.size(), removed_words = (fan.removed.size() + 3) / 4;
  if (size > SplitStar::max_ring) return false;
  std::array<SplitId, SplitStar::max_ring> dependencies;
  std::size_t count = 0;
  for (const FaceRef& ref : fan.removed) {
    if (ref.split == no_id || ref.slot >= SplitStar::max_slots) return false;
    std::size_t at = count;
    while (at > 0 && dependencies[at - 1] > ref.split) --at;
    if (at > 0 && dependencies[at - 1] == ref.split) continue;
    std::copy_backward(dependencies.begin() + at, dependencies.begin() + count, dependencies.begin() + count + 1);
    dependencies[at] = ref.split;
    ++count;
  }
  if (count > SplitStar::max_dependencies) return false;
  const std::size_t begin = words.size();
  words.resize(begin + 1 + size + count + removed_words, 0);
  std::uint32_t* next = words.data() + begin;
  *next++ = static_cast<std::uint32_t>(size | fan.parent_place << 8U | count << 16U) | SplitStar::closed_bit;
  next = std::copy(fan.ring.begin(), fan.ring.end(), next);
  next = std::copy_n(dependencies.begin(), count, next);
  for (std::size_t i = 0; i < fan.removed.size(); ++i) {
    std::uint32_t dependency = 0;
    while (dependencies[dependency] != fan.removed[i].split) ++dependency;
    next[i / 4] |= (fan.removed[i].slot << 4U | dependency) << (8 * (i % 4));
  }
  return true;
}

std::optional<std::string> check_star(std::span<const std::uint32_t> record, SplitId s, VertexId vertex,
                                      std::size_t base_faces) {
  const auto wrong_size = [&] { return fmt::format("the star of split {} does not end where the next begins", s); };
  if (record.empty()) return wrong_size();
  const bool is_fan = (record[0] & SplitStar::other_bit) == 0;
  if (is_fan && !is_fan_header(record[0])) return fmt::format("the star of split {} has a header that no fan has", s);
  // Three counts below 2^32, times at most 5, fit into 64 bits.
  if (!is_fan &&
      (record.size() < 5 ||
       std::uint64_t{5} + std::uint64_t{3} * record[2] + record[3] + std::uint64_t{5} * record[4] != record.size()))
    return wrong_size();
  const SplitStar star(record.data(), vertex);
  if (star.word_count() != record.size()) return wrong_size();
  if (star.parent_vertex() >= vertex) return fmt::format("split {} splits a vertex that comes later", s);
  SplitId last = no_id;
  for (const SplitId needed : star.dependencies()) {
    if (needed >= s) return fmt::format("split {} depends on split {}, which comes later", s, needed);
    if (last != no_id && needed <= last) return fmt::format("the dependencies of split {} do not ascend", s);
    last = needed;
  }
  std::optional<std::string> problem;
  const auto check_corners = [&](const Triangle& t, VertexId end) {
    for (int k = 0; k < 3; ++k)
      if (t[k] >= end) problem = fmt::format("split {} has a face with a corner that comes later", s);
  };
  star.for_each_inserted([&](const Triangle& t) { check_corners(t, vertex + 1); });
  if (is_fan && !names_dependencies(star, record))
    return fmt::format("split {} removes a face of a split that it does not depend on", s);
  star.for_each_removed([&](const FaceRef& ref, const Triangle& t) {
    check_corners(t, vertex);
    const auto needed = star.dependencies();
    if (ref.split == no_id ? ref.slot >= base_faces : !std::binary_search(needed.begin(), needed.end(), ref.split))
      problem = fmt::format("split {} removes a face of a split that it does not depend on", s);
  });
  return problem;
}

namespace {

// Holds the masks of a fan's places and the wedges that they list.
struct FanCorners {
  std::uint32_t first_mask = 0, second_mask = 0;
  std::array<WedgeId, SplitStar::max_ring> firsts{}, seconds{};
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

// Appends the second wedge of v and which wedge each slot has; returns false where 4 bits are not enough.
bool append_apexes(const SplitStar& star, std::span<const Triangle> wedges, WedgeId second,
                   std::vector<std::uint32_t>& words) {
  const std::size_t begin = words.size();
  words.push_back(second);
  for (std::size_t slot = 0; slot < wedges.size(); ++slot) {
    const WedgeId wedge = wedges[slot].x;
    const std::uint32_t which = wedge == star.vertex() ? 0 : wedge - second + 1;
    if (which >= SplitCorners::max_apex_wedges) {
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
