// What `--json` prints: one object, keys in the order in which they are explained.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "occlod/hierarchy.h"
#include "occlod/mesh.h"
#include "occlod/view.h"

namespace occlod::tool {

using Json = nlohmann::ordered_json;

[[nodiscard]] Json to_json(const glm::dvec3& vector);
[[nodiscard]] Json to_json(const glm::dmat4& matrix);  // 16 numbers, by columns
[[nodiscard]] Json to_json(const Camera& camera);
[[nodiscard]] Json to_json(const MeshReport& report);
[[nodiscard]] Json to_json(const LeftOut& counts);
[[nodiscard]] Json topology_to_json(const MeshReport& report);  // the last part of it: what is kept as it is
// vertices, triangles, base_triangles, splits, faces, bytes, bytes_per_vertex, error_bound.
[[nodiscard]] Json counts_of(const Hierarchy& hierarchy);

// To standard output; numbers that are not finite become null.
void print_json(const Json& object);
// For people: one "key  value" line each; lists and objects within are left out.
void print_lines(const Json& object);
void print_lines(const MeshReport& report);
// "71396 texture coordinates, 34 groups": what is not 0, or "nothing".
[[nodiscard]] std::string in_words(const LeftOut& counts);

}  // namespace occlod::tool
