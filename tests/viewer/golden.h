// Pictures that were looked at once and are to stay as they are.
#pragma once

#include <filesystem>
#include <string>

#include "occlod/picture.h"

namespace occlod::viewer::test {

[[nodiscard]] Image read_png(const std::filesystem::path& file);

// What is wrong with a picture, compared with the one that it should be; empty = nothing. Drivers round differently:
// few pixels may differ much, and all of them a little.
[[nodiscard]] std::string difference(const Image& found, const Image& expected);

}  // namespace occlod::viewer::test
