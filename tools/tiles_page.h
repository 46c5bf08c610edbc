// The page on which `occlod hlod serve` shows a tileset.
#pragma once

#include <string>

namespace occlod::tool {

// The CesiumJS that the page takes from the internet.
inline constexpr const char* cesium_version = "1.140";

// HTML. It loads "tileset/tileset.json", and CesiumJS from `cesium`: an address that ends with '/'.
[[nodiscard]] std::string tiles_page(const std::string& cesium);

}  // namespace occlod::tool
