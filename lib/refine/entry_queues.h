// What refinement from scratch may do next: nodes to look at, and splits to apply.
#pragma once

#include <algorithm>

#include "refine/queue.h"

namespace occlod {

struct EntryQueues {
  Queue visits, applies;

  [[nodiscard]] bool empty() const noexcept { return visits.empty() && applies.empty(); }
  // Of what is most important, 0 where there is nothing.
  [[nodiscard]] float top_priority() const noexcept {
    return std::max(visits.empty() ? 0.0F : visits.top().priority, applies.empty() ? 0.0F : applies.top().priority);
  }
  void clear() noexcept {
    visits.clear();
    applies.clear();
  }
  void push(const Entry& entry) { (entry.kind == Entry::Kind::visit ? visits : applies).push(entry); }
  // Calls visit(const Entry&) for each.
  template <typename Visit>
  void for_each(const Visit& visit) const {
    visits.for_each(visit);
    applies.for_each(visit);
  }
};

}  // namespace occlod
