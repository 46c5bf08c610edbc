// The order of ids that was planned first, to compare with node_order.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "papers/id_lists.h"

namespace occlod::paper {

// Of each id its place: by the first node that adds it, then by id; what no node adds comes last. As places_by_nodes().
[[nodiscard]] std::vector<std::uint32_t> places_by_first_node(std::span<const Ids> added, std::uint32_t count);

}  // namespace occlod::paper
