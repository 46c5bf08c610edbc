#include "splits/join_records.h"

#include <bit>
#include <cstdint>
#include <utility>

#include "base/large_vector.h"
#include "splits/parallel.h"
#include "splits/sort_by_key.h"

namespace occlod {
namespace {

// The ids of all collapses by ascending rank, equal ranks as recorded.
UninitializedVector<Keyed> by_rank(const CollapseRecords& records, unsigned threads) {
  // Ranks are not negative, so their bits ascend with them. Three bits of the mantissa are kept: equals stay
  // as recorded, that is, neighbours in space stay neighbours in memory.
  constexpr unsigned dropped_bits = 20;
  std::size_t count = 0;
  for (std::size_t block = 0; block < records.size(); ++block) count += records[block].ranks.size();
  UninitializedVector<Keyed> keyed;
  keyed.reserve(count);
  for (std::size_t block = 0; block < records.size(); ++block) {
    CollapseId id = CollapseRecords::first_id(block);
    for (const float rank : records[block].ranks)
      keyed.push_back({std::bit_cast<std::uint32_t>(rank) >> dropped_bits, id++});
  }
  sort_by_key(keyed, 32 - dropped_bits, threads);
  return keyed;
}

// Only where attributes count.
void join_attributes(CollapseRecords& records, const UninitializedVector<Keyed>& order, CollapseSequence& sequence) {
  if (!sequence.has_attributes) return;
  sequence.attributes.resize(order.size());
  for (std::size_t block = 0; block < records.size(); ++block) {
    BlockRecord& record = records[block];
    const CollapseId first = CollapseRecords::first_id(block);
    sequence.corner_memory.push_back(std::move(record.corners));
    const std::vector<EndedCorners>& corners = sequence.corner_memory.back();
    for (std::size_t i = 0; i < record.collapses.size(); ++i) {
      const std::size_t begin = record.first_corners[i];
      const std::size_t end = i + 1 < record.first_corners.size() ? record.first_corners[i + 1] : corners.size();
      sequence.attributes[sequence.places[first + i]] = {record.attribute_errors[i],
                                                         std::span(corners).subspan(begin, end - begin)};
    }
  }
}

}  // namespace

void join_records(CollapseRecords& records, CollapseSequence& sequence, unsigned threads,
                  const ProgressPart& progress) {
  const UninitializedVector<Keyed> order = by_rank(records, threads);
  sequence.places.resize(records.end_id());
  sequence.collapses.resize(order.size());
  const ProgressPart part{progress.progress, progress.first, progress.last, static_cast<double>(order.size())};
  for_each_range(
      order.size(), threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          sequence.places[order[i].item] = static_cast<CollapseId>(i);
          sequence.collapses[i] = records.collapse(order[i].item);
        }
      },
      [&](std::size_t done) { part.reach(done); });
  for (std::size_t block = 0; block < records.size(); ++block) {
    const std::vector<MisplacedFace>& misplaced = records[block].misplaced;
    sequence.misplaced.insert(sequence.misplaced.end(), misplaced.begin(), misplaced.end());
  }
  join_attributes(records, order, sequence);
  records.resize(0);
}

}  // namespace occlod
