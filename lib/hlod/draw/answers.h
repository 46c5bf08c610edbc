// Counts of the queries of one frame.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "occlod/device/device.h"

namespace occlod::hlod {

class Answers {
 public:
  void clear() {
    counts_.clear();
    first_.clear();
  }
  // A new query; its counts are added next.
  QueryId begin_query() {
    first_.push_back(counts_.size());
    return static_cast<QueryId>(first_.size() - 1);
  }
  void add(std::uint32_t count) { counts_.push_back(count); }

  [[nodiscard]] std::span<const std::uint32_t> of(QueryId query) const {
    assert(query < first_.size());
    const std::size_t first = first_[query];
    const std::size_t end = query + 1 < first_.size() ? first_[query + 1] : counts_.size();
    return std::span(counts_).subspan(first, end - first);
  }

 private:
  std::vector<std::uint32_t> counts_;
  std::vector<std::size_t> first_;  // of each query
};

}  // namespace occlod::hlod
