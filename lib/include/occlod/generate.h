// Generates closed test meshes from a few numbers, each described once in generators(). Deterministic: the same numbers
// give the same bytes on every machine with IEEE arithmetic.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "occlod/mesh.h"

namespace occlod {

// Describes one parameter of a generator.
struct GeneratorParameter {
  std::string_view name;   // "blocks"
  double min;              // smallest value that is allowed
  double max;              // largest value that is allowed
  double default_value;    // taken when none is given
  bool whole;              // only whole numbers are allowed
  std::string_view about;  // "blocks along each side"

  // Returns whether the value is allowed; NaN never is.
  [[nodiscard]] bool accepts(double value) const noexcept;
};

// Describes a generator.
struct Generator {
  std::string_view name;                           // "city"
  std::string_view about;                          // "blocks of buildings on a plane, in metres, z up"
  std::span<const GeneratorParameter> parameters;  // at least one
};

// Returns all generators, the same at each call.
[[nodiscard]] std::span<const Generator> generators() noexcept;

// Holds parameters by name; one that is missing has its default value.
using GeneratorValues = std::map<std::string, double, std::less<>>;

// Returns the mesh of a generator: generate("city", {{"blocks", 4}, {"seed", 7}}). Throws Error for a name that is not
// in generators(), for a value that its parameter does not allow, and for a mesh that would be too large: about 1e9
// triangles. O(size of the mesh).
[[nodiscard]] TriangleMesh generate(std::string_view generator, const GeneratorValues& values = {});

// Takes the next part of a mesh that is larger than memory: some 500,000 triangles with ids into the part's own
// vertices. The first `repeated` vertices are the last ones of the previous part; without them, the vertices and
// triangles of all parts are those of the whole mesh, in the same order. Connected components are not cut, except the
// rough planet.
using PartVisitor = std::function<void(const TriangleMesh& part, std::size_t repeated)>;

// Gives the mesh of generate() in parts. Throws the same.
void stream_generated(std::string_view generator, const GeneratorValues& values, const PartVisitor& visit);

}  // namespace occlod
