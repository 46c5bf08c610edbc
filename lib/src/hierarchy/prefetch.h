// A hint to the processor.
#pragma once

namespace occlod {

// The cache line at `address` will soon be read or written.
inline void prefetch([[maybe_unused]] const void* address) noexcept {
#if defined(__GNUC__)
  __builtin_prefetch(address);
#endif
}

}  // namespace occlod
