// Decodes the image that a node of an HLOD has of its own.
#pragma once

#include <string>

#include "occlod/hlod.h"
#include "occlod/picture.h"

namespace occlod::tool {

// Returns the image of a mesh that has one. Texels that none of its triangles shows, and that filtering does not read
// beside those, are black in the file; here they are means of what is shown nearby, so that smaller versions of the
// image show no black at the borders of charts. Throws Error that names the image `name` when it cannot be decoded.
// O(pixels + triangles).
[[nodiscard]] Image image_of_node(const hlod::NodeMesh& mesh, const std::string& name);

}  // namespace occlod::tool
