// Decodes image files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "occlod/picture.h"

namespace occlod::tool {

// Decodes PNG, JPEG, TGA, BMP, GIF (its first picture), PSD, HDR, PIC and PNM to sRGB. Throws Error that names the
// file, or `name`, when it is missing, not an image or larger than 2^28 pixels.
[[nodiscard]] Image read_image(const std::filesystem::path& file);
[[nodiscard]] Image decode_image(std::span<const std::uint8_t> bytes, const std::string& name);

}  // namespace occlod::tool
