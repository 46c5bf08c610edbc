// Material libraries of OBJ files.
#pragma once

#include <glm/vec2.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/file_input.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// What a map_ line does with texture coordinates: it shows its image at scale * coordinate + offset.
struct MapPlacement {
  glm::dvec2 scale{1.0};   // -s, finite
  glm::dvec2 offset{0.0};  // -o, finite
  [[nodiscard]] bool operator==(const MapPlacement&) const = default;
};

// A newmtl block, as far as a Material says it.
struct MtlMaterial {
  Material material;            // its texture is not set
  Texture texture;              // its file is empty where there is none
  MapPlacement placement = {};  // of the texture
};

// newmtl, Kd, d, Tr and map_Kd, of which the options but -clamp, -o and -s are skipped; the rest is ignored. `text` is
// UTF-8.
// Throws Error for numbers that cannot be read and for what comes before the first newmtl. O(n).
[[nodiscard]] std::vector<MtlMaterial> parse_mtl(std::string_view text, const FileErrors& errors);

// The name of a file as it stands in a text, with slashes for the backslashes of Windows.
[[nodiscard]] std::string with_slashes(std::string_view name);

}  // namespace occlod
