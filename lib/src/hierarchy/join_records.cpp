#include "join_records.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

#include "core/large_vector.h"
#include "parallel.h"
#include "sort_by_key.h"

namespace occlod {
namespace {

// Where a collapse is recorded.
struct Source {
  std::uint32_t record;
  std::uint32_t index;
};

std::size_t ended_count(const BlockRecord& record, std::size_t i) {
  const std::size_t end = i + 1 < record.collapses.size() ? record.collapses[i + 1].first_ended : record.ended.size();
  return end - record.collapses[i].first_ended;
}

// All collapses by ascending rank, equal ranks as recorded.
LargeVector<Source> by_rank(const std::vector<BlockRecord>& records, unsigned threads) {
  // Ranks are not negative, so their bits ascend with them. Three bits of the mantissa are kept: equals stay
  // as recorded, that is, neighbours in space stay neighbours in memory.
  constexpr unsigned dropped_bits = 20;
  std::size_t count = 0;
  for (const BlockRecord& record : records) count += record.collapses.size();
  LargeVector<Source> sources;
  LargeVector<Keyed> keyed;
  sources.reserve(count);
  keyed.reserve(count);
  for (std::uint32_t r = 0; r < records.size(); ++r)
    for (std::uint32_t i = 0; i < records[r].ranks.size(); ++i) {
      keyed.push_back({std::bit_cast<std::uint32_t>(records[r].ranks[i]) >> dropped_bits,
                       static_cast<std::uint32_t>(sources.size())});
      sources.push_back({r, i});
    }
  sort_by_key(keyed, 32 - dropped_bits, threads);
  LargeVector<Source> result(count);
  for_each_id(count, threads, [&](CollapseId i) { result[i] = sources[keyed[i].item]; });
  return result;
}

}  // namespace

CollapseSequence join_records(std::vector<BlockRecord>& records, std::vector<LevelFace> base, unsigned threads,
                              const ProgressPart& progress) {
  const LargeVector<Source> order = by_rank(records, threads);
  CollapseId ids = 0;
  for (const BlockRecord& record : records)
    if (!record.collapses.empty()) ids = std::max(ids, record.collapses.back().id + 1);
  LargeVector<CollapseId> new_id(ids);
  CollapseSequence sequence;
  sequence.collapses.resize(order.size() + 1);
  for_each_id(order.size(), threads, [&](CollapseId i) {
    const BlockRecord& record = records[order[i].record];
    Collapse& collapse = sequence.collapses[i] = record.collapses[order[i].index];
    new_id[collapse.id] = i;
    collapse.id = i;
    collapse.first_ended = ended_count(record, order[i].index);
  });
  std::size_t ended = 0;
  for (Collapse& collapse : sequence.collapses) ended += std::exchange(collapse.first_ended, ended);
  sequence.ended.resize(ended);
  const auto renumber = [&](LevelFace& face) {
    if (face.made_by != no_id) face.made_by = new_id[face.made_by];
  };
  const ProgressPart part{progress.progress, progress.first, progress.last, static_cast<double>(order.size())};
  for_each_range(
      order.size(), threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const BlockRecord& record = records[order[i].record];
          const LevelFace* from = record.ended.data() + record.collapses[order[i].index].first_ended;
          for (std::size_t k = sequence.collapses[i].first_ended; k < sequence.collapses[i + 1].first_ended; ++k)
            renumber(sequence.ended[k] = *from++);
        }
      },
      [&](std::size_t done) { part.reach(done); });
  for (LevelFace& face : base) renumber(face);
  sequence.base = std::move(base);
  records.clear();
  return sequence;
}

}  // namespace occlod
