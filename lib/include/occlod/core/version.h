// The version of the library, set by the build.
#pragma once

namespace occlod {

// "MAJOR.MINOR.PATCH".
[[nodiscard]] const char* version() noexcept;

}  // namespace occlod
