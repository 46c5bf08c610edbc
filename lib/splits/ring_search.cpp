#include "splits/ring_search.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace occlod {
namespace {

// chain() of so many faces that looking for each next one would take too long.
bool chain_by_sorting(std::span<StarFace> faces) {
  // In a ring each vertex is once the next and once the last.
  std::uint32_t difference = 0;
  for (const StarFace& f : faces) difference += f.next - f.last;
  if (difference != 0) return false;
  std::vector<StarFace> sorted(faces.begin(), faces.end());
  std::sort(sorted.begin(), sorted.end(), [](const StarFace& a, const StarFace& b) { return a.next < b.next; });
  const auto same_next = [](const StarFace& a, const StarFace& b) { return a.next == b.next; };
  if (std::adjacent_find(sorted.begin(), sorted.end(), same_next) != sorted.end()) return false;
  std::vector<StarFace> ring = {faces[0]};
  while (ring.size() < faces.size()) {
    const VertexId from = ring.back().last;
    const auto found = std::lower_bound(sorted.begin(), sorted.end(), from,
                                        [](const StarFace& f, VertexId next) { return f.next < next; });
    if (from == ring[0].next || found == sorted.end() || found->next != from) return false;
    ring.push_back(*found);
  }
  if (ring.back().last != ring[0].next) return false;
  std::copy(ring.begin(), ring.end(), faces.begin());
  return true;
}

}  // namespace

bool chain(std::span<StarFace> faces) {
  constexpr std::size_t most_by_search = 64;
  const std::size_t n = faces.size();
  if (n < 3) return false;
  if (n > most_by_search) return chain_by_sorting(faces);
  for (std::size_t i = 1; i < n; ++i) {
    const VertexId from = faces[i - 1].last;
    // Closed too early: there is another fan, or the ring passes a neighbour twice.
    for (std::size_t k = 0; k < i; ++k)
      if (faces[k].next == from) return false;
    std::size_t k = i;
    while (k < n && faces[k].next != from) ++k;
    if (k == n) return false;
    std::swap(faces[i], faces[k]);
  }
  return faces[n - 1].last == faces[0].next;
}

std::uint32_t position_of(std::span<const VertexId> ring, VertexId v) {
  constexpr std::size_t step = 32;
  std::size_t at = 0;
  for (; at + step <= ring.size(); at += step) {
    std::uint32_t found = 0;
    for (std::size_t k = 0; k < step; ++k) found |= ring[at + k] == v ? 1U : 0U;
    if (found != 0) break;
  }
  while (at < ring.size() && ring[at] != v) ++at;
  return static_cast<std::uint32_t>(at);
}

std::uint32_t position_near(std::span<const VertexId> ring, VertexId v, std::size_t hint) {
  for (std::size_t reach = 64;; reach *= 8) {
    const std::size_t begin = hint > reach ? std::min(hint - reach, ring.size()) : 0;
    const std::size_t end = std::min(hint + reach, ring.size());
    const std::uint32_t at = position_of(ring.subspan(begin, end - begin), v);
    if (begin + at < end || (begin == 0 && end == ring.size())) return static_cast<std::uint32_t>(begin + at);
  }
}

}  // namespace occlod
