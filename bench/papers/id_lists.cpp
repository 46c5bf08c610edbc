#include "papers/id_lists.h"

#include <algorithm>
#include <iterator>

namespace occlod::paper {

Delta delta(std::span<const std::uint32_t> from, std::span<const std::uint32_t> to) {
  Delta result;
  std::set_difference(to.begin(), to.end(), from.begin(), from.end(), std::back_inserter(result.added));
  std::set_difference(from.begin(), from.end(), to.begin(), to.end(), std::back_inserter(result.removed));
  return result;
}

Ids with_delta(const Delta& delta, std::span<const std::uint32_t> from) {
  Ids kept, result;
  std::set_difference(from.begin(), from.end(), delta.removed.begin(), delta.removed.end(), std::back_inserter(kept));
  std::merge(kept.begin(), kept.end(), delta.added.begin(), delta.added.end(), std::back_inserter(result));
  return result;
}

std::vector<std::uint32_t> runs_of(std::span<const std::uint32_t> ids) {
  std::vector<std::uint32_t> runs;
  std::uint32_t end = 0;  // of the last run, and 1 for what lies before 0
  for (std::size_t i = 0; i < ids.size();) {
    std::size_t last = i;
    while (last + 1 < ids.size() && ids[last + 1] == ids[last] + 1) ++last;
    runs.push_back(ids[i] + 1 - end);
    runs.push_back(static_cast<std::uint32_t>(last + 1 - i));
    end = ids[last] + 1;
    i = last + 1;
  }
  return runs;
}

Ids ids_of_runs(std::span<const std::uint32_t> runs) {
  Ids ids;
  std::uint32_t end = 0;
  for (std::size_t i = 0; i + 1 < runs.size(); i += 2) {
    const std::uint32_t first = end + runs[i] - 1;
    for (std::uint32_t id = first; id < first + runs[i + 1]; ++id) ids.push_back(id);
    end = first + runs[i + 1];
  }
  return ids;
}

std::vector<std::uint32_t> gaps_of(std::span<const std::uint32_t> ids) {
  std::vector<std::uint32_t> gaps;
  std::uint32_t next = 0;
  for (const std::uint32_t id : ids) {
    gaps.push_back(id + 1 - next);
    next = id + 1;
  }
  return gaps;
}

}  // namespace occlod::paper
