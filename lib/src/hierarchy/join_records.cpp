#include "join_records.h"

#include <bit>
#include <cstdint>
#include <utility>

#include "parallel.h"
#include "sort_by_key.h"

namespace occlod {
namespace {

// Where a collapse is recorded.
struct Source {
  std::uint32_t record;
  std::uint32_t index;
};

std::size_t ended_count(const BlockRecord& record, std::size_t index) {
  const std::size_t end =
      index + 1 < record.collapses.size() ? record.collapses[index + 1].first_ended : record.ended.size();
  return end - record.collapses[index].first_ended;
}

// All collapses by ascending rank, equal ranks as recorded. Ranks are not negative, so their bits ascend with them.
std::vector<Source> ranked(const std::vector<BlockRecord>& records, unsigned threads) {
  std::vector<Source> sources;
  std::vector<Keyed> keyed;
  for (std::uint32_t r = 0; r < records.size(); ++r)
    for (std::uint32_t i = 0; i < records[r].collapses.size(); ++i) {
      keyed.push_back({std::bit_cast<std::uint32_t>(records[r].ranks[i]), static_cast<std::uint32_t>(sources.size())});
      sources.push_back({r, i});
    }
  sort_by_key(keyed, 32, threads);
  std::vector<Source> result(sources.size());
  for_each_range(result.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[i] = sources[keyed[i].item];
  });
  return result;
}

}  // namespace

CollapseSequence join_records(std::vector<BlockRecord>& records, std::vector<LevelFace> base, unsigned threads) {
  const std::vector<Source> order = ranked(records, threads);
  CollapseSequence sequence;
  sequence.collapses.resize(order.size() + 1);
  std::vector<CollapseId> new_id;
  std::size_t ended = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const BlockRecord& record = records[order[i].record];
    Collapse& collapse = sequence.collapses[i] = record.collapses[order[i].index];
    if (collapse.id >= new_id.size()) new_id.resize(std::bit_ceil(std::size_t{collapse.id} + 1), no_id);
    new_id[collapse.id] = static_cast<CollapseId>(i);
    collapse.id = static_cast<CollapseId>(i);
    collapse.first_ended = ended;
    ended += ended_count(record, order[i].index);
  }
  sequence.collapses.back().first_ended = ended;
  sequence.ended.resize(ended);
  const auto renumber = [&](LevelFace& face) {
    if (face.made_by != no_id) face.made_by = new_id[face.made_by];
  };
  for_each_range(order.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const BlockRecord& record = records[order[i].record];
      const std::size_t first = record.collapses[order[i].index].first_ended;
      LevelFace* to = sequence.ended.data() + sequence.collapses[i].first_ended;
      for (std::size_t k = 0, count = ended_count(record, order[i].index); k < count; ++k) {
        to[k] = record.ended[first + k];
        renumber(to[k]);
      }
    }
  });
  for (LevelFace& face : base) renumber(face);
  sequence.base = std::move(base);
  records.clear();
  return sequence;
}

}  // namespace occlod
