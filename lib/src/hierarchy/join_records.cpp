#include "join_records.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdint>
#include <utility>

#include "huge_pages.h"
#include "parallel.h"
#include "sort_by_key.h"

namespace occlod {
namespace {

// All collapses one after the other, as recorded.
class Recorded {
 public:
  explicit Recorded(const std::vector<BlockRecord>& records) : records_(records), first_{0} {
    for (const BlockRecord& record : records) first_.push_back(first_.back() + record.collapses.size());
  }
  [[nodiscard]] std::size_t count() const { return first_.back(); }

  // Calls visit(place among all, record, index in it) for every collapse, each record on some thread.
  template <typename Visit>
  void for_each(unsigned threads, const Visit& visit) const {
    std::atomic<std::size_t> next = 0;
    for_each_part(threads, threads, [&](std::size_t, std::size_t, std::size_t) {
      for (std::size_t r = next++; r < records_.size(); r = next++)
        for (std::size_t i = 0; i < records_[r].collapses.size(); ++i) visit(first_[r] + i, records_[r], i);
    });
  }

 private:
  const std::vector<BlockRecord>& records_;
  std::vector<std::size_t> first_;
};

// Each collapse's place in the order of ranks, equal ranks as recorded.
std::vector<CollapseId> places_by_rank(const Recorded& recorded, unsigned threads) {
  // Ranks are not negative, so their bits ascend with them. Half of the mantissa does: what is cut off leaves equals.
  constexpr unsigned dropped_bits = 10;
  std::vector<Keyed> keyed(recorded.count());
  recorded.for_each(threads, [&](std::size_t k, const BlockRecord& record, std::size_t i) {
    keyed[k] = {std::bit_cast<std::uint32_t>(record.ranks[i]) >> dropped_bits, static_cast<std::uint32_t>(k)};
  });
  sort_by_key(keyed, 32 - dropped_bits, threads);
  std::vector<CollapseId> places(keyed.size());
  for_each_range(keyed.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) places[keyed[i].item] = static_cast<CollapseId>(i);
  });
  return places;
}

std::size_t ended_count(const BlockRecord& record, std::size_t i) {
  const std::size_t end = i + 1 < record.collapses.size() ? record.collapses[i + 1].first_ended : record.ended.size();
  return end - record.collapses[i].first_ended;
}

}  // namespace

CollapseSequence join_records(std::vector<BlockRecord>& records, std::vector<LevelFace> base, unsigned threads) {
  const Recorded recorded(records);
  const std::vector<CollapseId> places = places_by_rank(recorded, threads);
  CollapseSequence sequence;
  sequence.collapses = large_array<Collapse>(recorded.count() + 1);
  CollapseId ids = 0;
  for (const BlockRecord& record : records)
    if (!record.collapses.empty()) ids = std::max(ids, record.collapses.back().id + 1);
  std::vector<CollapseId> new_id(ids);
  recorded.for_each(threads, [&](std::size_t k, const BlockRecord& record, std::size_t i) {
    Collapse& collapse = sequence.collapses[places[k]];
    collapse = record.collapses[i];
    new_id[collapse.id] = places[k];
    collapse.id = places[k];
    collapse.first_ended = ended_count(record, i);
  });
  std::size_t ended = 0;
  for (Collapse& collapse : sequence.collapses) ended += std::exchange(collapse.first_ended, ended);
  sequence.ended = large_array<LevelFace>(ended);
  const auto renumber = [&](LevelFace& face) {
    if (face.made_by != no_id) face.made_by = new_id[face.made_by];
  };
  recorded.for_each(threads, [&](std::size_t k, const BlockRecord& record, std::size_t i) {
    LevelFace* const to = sequence.ended.data() + sequence.collapses[places[k]].first_ended;
    const LevelFace* const from = record.ended.data() + record.collapses[i].first_ended;
    for (std::size_t f = 0, count = ended_count(record, i); f < count; ++f) renumber(to[f] = from[f]);
  });
  for (LevelFace& face : base) renumber(face);
  sequence.base = std::move(base);
  records.clear();
  return sequence;
}

}  // namespace occlod
