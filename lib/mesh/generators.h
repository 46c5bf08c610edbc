// Looks up generators and their parameters, and declares the functions behind their names.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "occlod/generate.h"
#include "occlod/mesh.h"

namespace occlod {

// Returns the generator or parameter of this name, or null.
template <class Named>
const Named* find_named(std::span<const Named> all, std::string_view name) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

// Returns the names of generators or parameters: "blocks, facade_cells, seed".
template <class Named>
std::string names_of(std::span<const Named> all) {
  std::string names;
  for (const Named& one : all) names.append(names.empty() ? "" : ", ").append(one.name);
  return names;
}

// Returns what the parameter accepts: "a whole number from 1 to 256".
[[nodiscard]] std::string accepted_by(const GeneratorParameter& parameter);

// Returns the generator of this name. Throws Error that lists all of them.
[[nodiscard]] const Generator& generator_of(std::string_view name);

// Returns the values of all parameters. Throws Error for one that is unknown or not accepted.
[[nodiscard]] GeneratorValues complete_values(const Generator& generator, const GeneratorValues& given);

// Collects components in `part`, and passes parts to a visitor; without a visitor `part` becomes the whole mesh.
class PartGiver {
 public:
  PartGiver() = default;
  explicit PartGiver(const PartVisitor& visit) : visit_(&visit) {}

  [[nodiscard]] bool gives_parts() const noexcept { return visit_ != nullptr; }

  // Call after each component; components are never cut.
  void end_component() {
    constexpr std::size_t enough = std::size_t{1} << 18U;  // triangles
    if (part.triangle_count() >= enough) give();
  }
  // Passes on what has been collected, if anything; the first `repeated` vertices are the last ones of the part before.
  void give(std::size_t repeated = 0) {
    if (!gives_parts() || part.triangles.empty()) return;
    (*visit_)(part, repeated);
    part.positions.clear();
    part.triangles.clear();
  }

  TriangleMesh part;

 private:
  const PartVisitor* visit_ = nullptr;
};

// Each appends its mesh; `values` are those of complete_values().
void append_rough_planet(const GeneratorValues& values, PartGiver& parts);
void append_city(const GeneratorValues& values, PartGiver& parts);
void append_pipes(const GeneratorValues& values, PartGiver& parts);
void append_plant(const GeneratorValues& values, PartGiver& parts);
void append_spheres_behind_wall(const GeneratorValues& values, PartGiver& parts);

// Returns one of complete_values() as a Number, which its parameter's range fits.
template <class Number = int>
Number value_of(const GeneratorValues& values, std::string_view parameter) {
  return static_cast<Number>(values.find(parameter)->second);
}

}  // namespace occlod
