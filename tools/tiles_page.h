// Makes the page on which `occlod serve` shows a tileset.
#pragma once

#include <string>

namespace occlod::tool {

// This is the CesiumJS that the page loads from the internet.
inline constexpr const char* cesium_version = "1.140";

// Returns HTML that loads "tileset/tileset.json", and CesiumJS from the address `cesium`, which ends with '/'.
[[nodiscard]] std::string tiles_page(const std::string& cesium);

}  // namespace occlod::tool
