// Attributes that a file gives to the corners of polygons rather than to vertices: OBJ, and PLY with `texcoord`.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "io/polygon_soup.h"
#include "occlod/core/ids.h"

namespace occlod {

struct CornerAttributes {
  // Indices into the values below; no_id: none, which is (0, 0) and a zero normal.
  struct Corner {
    std::uint32_t texture = no_id;
    std::uint32_t normal = no_id;
    [[nodiscard]] bool operator==(const Corner&) const = default;
  };
  std::vector<Corner> corners;  // of all polygons, in order; those missing at the end have none
  std::vector<glm::vec2> texture_coordinates;
  std::vector<glm::vec3> normals;
};

// Gives each vertex of a checked soup the attributes of the first corner that uses it and adds vertices at the end,
// which repeat an earlier one, for corners with others. Sets the arrays of the soup of which any corner has a value;
// the vertices that are added have the others of the one that they repeat. Throws Error when ids cannot count the
// vertices. Expected O(n).
void split_vertices(PolygonSoup& soup, const CornerAttributes& attributes, const FileErrors& errors);

}  // namespace occlod
