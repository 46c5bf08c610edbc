#include "splits/write_corners.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "splits/corner_record.h"
#include "occlod/core/error.h"
#include "splits/parallel.h"

namespace occlod {
namespace {

// Writes the records of one split after the other.
class CornerWriter {
 public:
  CornerWriter(const CollapseSequence& sequence, const WedgeNumbers& numbers)
      : sequence_(sequence), numbers_(numbers) {}

  void write(std::size_t place, const SplitStar& star, std::vector<std::uint32_t>& words) {
    const std::span<const EndedCorners> corners = sequence_.attributes[place].corners;
    if (corners.empty()) return;
    const Collapse& collapse = *sequence_.collapses[place];
    wedges_.clear();
    for (std::uint32_t slot = 0; slot < collapse.ended_count(); ++slot) wedges_.push_back(star.inserted(slot));
    for (const EndedCorners& face : corners) wedges_[face.slot] = numbers_(collapse.ended(face.slot), face.wedges);
    append_corners(star, wedges_, words);
  }

 private:
  const CollapseSequence& sequence_;
  const WedgeNumbers& numbers_;
  std::vector<Triangle> wedges_;
};

}  // namespace

void write_corners(const CollapseSequence& sequence, const WedgeNumbers& numbers,
                   std::span<const std::uint32_t> star_starts, unsigned threads, HierarchyData& data) {
  const std::size_t splits = sequence.collapses.size();
  const std::size_t vertices = data.positions.size() - data.extra_wedges.size();
  data.corner_starts.resize(splits + 1);
  std::vector<std::vector<std::uint32_t>> ranges((splits + range_size - 1) / range_size);
  for_each_range(splits, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t>& words = ranges[begin / range_size];
    CornerWriter writer(sequence, numbers);
    for (std::size_t s = begin; s < end; ++s) {
      data.corner_starts[s] = static_cast<std::uint32_t>(words.size());
      const SplitStar star(data.stars.data() + star_starts[s], static_cast<VertexId>(vertices - splits + s));
      writer.write(splits - 1 - s, star, words);
    }
  });
  std::size_t start = 0;
  for (std::size_t r = 0; r < ranges.size(); ++r) {
    for (std::size_t s = r * range_size; s < std::min((r + 1) * range_size, splits); ++s)
      data.corner_starts[s] += static_cast<std::uint32_t>(start);
    start += ranges[r].size();
    if (start >= std::numeric_limits<std::uint32_t>::max())
      throw Error({"mesh", "", "has too many seams for 32-bit places of wedges", "split it into several meshes"});
  }
  data.corner_starts[splits] = static_cast<std::uint32_t>(start);
  data.corners.reserve(start);
  for (const std::vector<std::uint32_t>& words : ranges)
    data.corners.insert(data.corners.end(), words.begin(), words.end());
  for (std::size_t f = 0; f < sequence.base.size(); ++f)
    data.base_corners.push_back(numbers(sequence.base[f].corners, sequence.base_corners[f]));
}

}  // namespace occlod
