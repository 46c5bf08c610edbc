// Prints the object of `--json`, whose keys are in the order in which they are documented.
#pragma once

#include <filesystem>
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
[[nodiscard]] Json to_json(const glm::dmat4& matrix);  // 16 numbers, column by column
[[nodiscard]] Json to_json(const Camera& camera);
[[nodiscard]] Json to_json(const MeshReport& report);
[[nodiscard]] Json to_json(const LeftOut& counts);
[[nodiscard]] Json topology_to_json(const MeshReport& report);  // topology only, which cleaning does not change
// Returns the corners of a box that is relative to an origin.
[[nodiscard]] Json to_json(const Box& box, const glm::dvec3& origin);
// Adds "origin", which print_lines() explains, unless it is 0.
void add_origin(Json& object, const glm::dvec3& origin);
// Tells that the file at `path` lacks the origin of its mesh, if it does: STL has no place for it.
void note_lost_origin(const std::filesystem::path& path, const glm::dvec3& origin);
// Returns vertices, triangles, base_triangles, splits, faces, bytes, bytes_per_vertex and error_bound, and any origin.
[[nodiscard]] Json counts_of(const Hierarchy& hierarchy);

// Prints to standard output. Numbers that are not finite become null.
void print_json(const Json& object);
// Prints one "key  value" line each for people. Nested lists and objects are left out, but for an origin.
void print_lines(const Json& object);
void print_lines(const MeshReport& report);
// Returns the counts, like "34 groups (g), 12 lines (l)", or "nothing".
[[nodiscard]] std::string in_words(const LeftOut& counts);
// Prints a result, and what was left out of the mesh that it was made from: as JSON or in lines.
void print_result(Json result, const LeftOut& left_out, bool json);

}  // namespace occlod::tool
