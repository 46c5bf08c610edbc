// Texture coordinates of materials that scale and move their textures: OBJ.
#pragma once

#include <span>

#include "base/file_input.h"
#include "mesh/parse_mtl.h"
#include "mesh/polygon_soup.h"
#include "mesh/split_vertices.h"

namespace occlod {

// Gives the corners of polygons whose material places its texture coordinates of their own, at the end of those there
// are; others stay as they are, and corners without any have none. `placements`: by material, of a soup whose polygons
// have materials; indices of corners have been checked. Throws Error when ids cannot count the texture coordinates.
// O(corners); a copy of a coordinate for each run of polygons of one placement that uses it.
template <class Storage>
void place_textures(const BasicPolygonSoup<Storage>& soup, std::span<const MapPlacement> placements,
                    CornerAttributes<Storage>& attributes, const FileErrors& errors);

}  // namespace occlod
