// Numbers the distinct vertices of a small mesh in the order in which they are met.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "occlod/core/ids.h"

namespace occlod::hlod {

// An open hash table. Reused, it allocates only when it has to grow.
class LocalIds {
 public:
  // Forgets all; room for so many vertices.
  void reset(std::size_t most_vertices) {
    vertices_.clear();
    const std::size_t slots = std::bit_ceil(2 * most_vertices + 2);
    mask_ = slots - 1;
    slots_.assign(slots, no_id);
  }

  // The number of v, a new one when it has none.
  std::uint32_t add(VertexId v) {
    std::uint32_t& slot = slots_[find_slot(v)];
    if (slot == no_id) {
      slot = static_cast<std::uint32_t>(vertices_.size());
      vertices_.push_back(v);
    }
    return slot;
  }
  // The number of v, or no_id.
  [[nodiscard]] std::uint32_t find(VertexId v) const { return slots_[find_slot(v)]; }
  // By number.
  [[nodiscard]] std::span<const VertexId> vertices() const { return vertices_; }

 private:
  [[nodiscard]] std::size_t find_slot(VertexId v) const {
    std::size_t slot = (v * 0x9e3779b97f4a7c15ULL >> 32U) & mask_;
    while (slots_[slot] != no_id && vertices_[slots_[slot]] != v) slot = (slot + 1) & mask_;
    return slot;
  }

  std::vector<VertexId> vertices_;
  std::vector<std::uint32_t> slots_;
  std::size_t mask_ = 0;
};

}  // namespace occlod::hlod
