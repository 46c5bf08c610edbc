// Material libraries of OBJ files.
#pragma once

#include <string_view>
#include <vector>

#include "io/file_input.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// A newmtl block, as far as a Material says it.
struct MtlMaterial {
  Material material;  // its texture is not set
  Texture texture;    // its file is empty where there is none
};

// newmtl, Kd, d, Tr and map_Kd, of which the options but -clamp are skipped; the rest is ignored. `text` is UTF-8.
// Throws Error for numbers that cannot be read and for what comes before the first newmtl. O(n).
[[nodiscard]] std::vector<MtlMaterial> parse_mtl(std::string_view text, const FileErrors& errors);

// The name of a file as it stands in a text, with slashes for the backslashes of Windows.
[[nodiscard]] std::string with_slashes(std::string_view name);

}  // namespace occlod
