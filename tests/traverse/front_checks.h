// Whether what a frame drew is part of a legal front.
#pragma once

#include <cstddef>
#include <vector>

#include "hlod/store/structure.h"
#include "papers/trial_traverser.h"

namespace occlod::hlod::test {

// By place in HlodView::patches, how often it was drawn.
[[nodiscard]] std::vector<int> drawn_patches(const Hlod& hlod, const Frame& frame);

// How many nodes break the rules: drawn and refined, or drawn and in the way of a child that is refined.
[[nodiscard]] std::size_t illegal_nodes(const Hlod& hlod, const Frame& frame);

// By place, whether a front draws the patch.
[[nodiscard]] std::vector<int> patches_of(const Hlod& hlod, const Refined& refined);

// The least legal front of which all that is drawn is part.
[[nodiscard]] Refined min_front(const Hlod& hlod, const std::vector<int>& drawn);

// Takes away what was drawn of nodes that are refined. Returns how many nodes that are.
std::size_t clear_refined(const Hlod& hlod, const Refined& refined, std::vector<int>& drawn);

}  // namespace occlod::hlod::test
