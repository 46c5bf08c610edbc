// How much memory this process has held at most, from Linux' /proc/self.
#pragma once

#include <cstdint>
#include <optional>

namespace occlod::bench {

// Gives freed memory back to the system and starts anew; returns what is held now, in bytes. Nothing where the system
// does not allow it.
[[nodiscard]] std::optional<std::uint64_t> restart_peak();

// The most that was held since then, in bytes.
[[nodiscard]] std::optional<std::uint64_t> peak_bytes();

}  // namespace occlod::bench
