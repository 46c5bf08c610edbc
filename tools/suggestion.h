// Finds the word that was probably meant by one with a typing error.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace occlod::tool {

// Returns the word that takes the fewest letters inserted, left out, replaced or swapped with their neighbours, if
// those are at most a third of the typed ones; the first of equals. Takes time of words times the square of letters.
[[nodiscard]] std::optional<std::string> meant_by(const std::string& typed, const std::vector<std::string>& words);

}  // namespace occlod::tool
