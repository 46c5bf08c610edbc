// Tells when `occlod repair` would change a mesh.
#pragma once

#include <optional>
#include <string>

#include "occlod/mesh.h"

namespace occlod::tool {

// Returns one line, or nothing when a repair would fix nothing that the report counts. Edges and vertices that are not
// manifold do not count: welding would undo taking them apart, and hierarchies are built from them as they are.
[[nodiscard]] std::optional<std::string> repair_advice(const MeshReport& report);

}  // namespace occlod::tool
