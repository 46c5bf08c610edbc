// The version of the library, set by the build.
#pragma once

namespace occlod {

// "MAJOR.MINOR.PATCH", of the library that is linked. Static storage.
[[nodiscard]] const char* version() noexcept;

}  // namespace occlod
