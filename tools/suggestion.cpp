#include "suggestion.h"

#include <algorithm>
#include <cstddef>

namespace occlod::tool {
namespace {

constexpr std::size_t letters_a_mistake = 3, max_letters = 40;

// Counts the changes of optimal string alignment: each letter is changed once at most.
std::size_t changes_between(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> changes(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) changes[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) changes[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i)
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = changes[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      changes[i][j] = std::min({changes[i - 1][j] + 1, changes[i][j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        changes[i][j] = std::min(changes[i][j], changes[i - 2][j - 2] + 1);
    }
  return changes[a.size()][b.size()];
}

}  // namespace

std::optional<std::string> meant_by(const std::string& typed, const std::vector<std::string>& words) {
  if (typed.size() > max_letters) return std::nullopt;
  std::optional<std::string> meant;
  std::size_t least = typed.size() / letters_a_mistake + 1;
  for (const std::string& word : words)
    if (const std::size_t changes = changes_between(typed, word); changes < least) {
      least = changes;
      meant = word;
    }
  return meant;
}

}  // namespace occlod::tool
