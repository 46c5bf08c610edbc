// Attributes that a file gives to the corners of polygons rather than to vertices: OBJ, and PLY with `texcoord`.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/polygon_soup.h"
#include "occlod/core/ids.h"

namespace occlod {

// Indices into the values of CornerAttributes; no_id: none, which is (0, 0) and a zero normal.
struct AttributeCorner {
  std::uint32_t texture = no_id;
  std::uint32_t normal = no_id;
  [[nodiscard]] bool operator==(const AttributeCorner&) const = default;
};

// Of a soup with the same Storage.
template <class Storage>
struct CornerAttributes {
  template <class T>
  using Array = typename Storage::template Array<T>;
  Array<AttributeCorner> corners;  // of all polygons, in order; those missing at the end have none
  Array<glm::vec2> texture_coordinates;
  Array<glm::vec3> normals;
};

// Gives each vertex of a checked soup the attributes of the first corner that uses it and adds vertices at the end,
// which repeat an earlier one, for corners with others. Sets the arrays of the soup of which any corner has a value;
// the vertices that are added have the others of the one that they repeat. Throws Error when ids cannot count the
// vertices. Expected O(n).
template <class Storage>
void split_vertices(BasicPolygonSoup<Storage>& soup, const CornerAttributes<Storage>& attributes,
                    const FileErrors& errors);

}  // namespace occlod
