#include "mesh/generators.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <utility>

#include "occlod/base.h"

namespace occlod {
namespace {

// Larger whole numbers are not all exact in a double: one of them could come out as another seed.
constexpr GeneratorParameter seed = {"seed", 0, 0x1p53 - 1, 1, true, "random seed"};

constexpr GeneratorParameter rough_planet[] = {
    {"level", 0, 11, 8, true, "subdivisions"},
    seed,
    {"amplitude", 0, 0.99, 0.08, false, "largest height of a hill, of the radius"},
    {"frequency", 0, 1e6, 4, false, "noise cells per radius in the first octave"},
    {"octaves", 0, 30, 6, true, "octaves of noise, each half as high and twice as fine"}};

constexpr GeneratorParameter city[] = {
    {"blocks", 1, 256, 16, true, "blocks along each side, each of four buildings"},
    {"facade_cells", 1, 256, 8, true, "cells along each edge of a wall; two triangles per cell"},
    seed};

constexpr GeneratorParameter pipes[] = {{"pipes", 1, 1'000'000, 64, true, "number of pipes"},
                                        {"bends", 1, 100'000, 12, true, "straight pieces per pipe"},
                                        {"sides", 3, 4096, 16, true, "corners of the cross-section"},
                                        seed};

constexpr GeneratorParameter plant[] = {{"storeys", 1, 64, 4, true, "number of storeys"},
                                        {"bays", 1, 256, 8, true, "rooms along the aisle of each storey"},
                                        {"pipes", 1, 10'000, 64, true, "pipes on each side of a room"},
                                        {"bends", 1, 100'000, 48, true, "straight pieces per pipe"},
                                        {"sides", 3, 4096, 32, true, "corners of the cross-section"},
                                        seed};

constexpr GeneratorParameter spheres_behind_wall[] = {
    {"spheres", 1, 1'000'000, 64, true, "number of spheres"},
    {"level", 0, 8, 4, true, "subdivisions of each sphere"},
    {"wall_cells", 1, 4096, 32, true, "cells along each edge of the wall"},
    seed};

constexpr Generator table[] = {
    {"rough-planet", "a sphere of radius 1 with random hills: 8 * 4^level triangles", rough_planet},
    {"city", "blocks of buildings on a plane, in metres, z up", city},
    {"pipes", "a bundle of bent pipes in a unit cube", pipes},
    {"plant", "storeys of rooms full of pipes, with floors, walls and doors, in metres, z up", plant},
    {"spheres-behind-wall", "spheres that a wall in the plane x = 0 hides from +x", spheres_behind_wall}};

// In the order of the table.
constexpr void (*append[])(const GeneratorValues&, PartGiver&) = {append_rough_planet, append_city, append_pipes,
                                                                  append_plant, append_spheres_behind_wall};
static_assert(std::size(append) == std::size(table));

void run(std::string_view name, const GeneratorValues& values, PartGiver& parts) {
  const Generator& generator = generator_of(name);
  append[&generator - table](complete_values(generator, values), parts);
}

}  // namespace

bool GeneratorParameter::accepts(double value) const noexcept {
  return value >= min && value <= max && (!whole || value == std::floor(value));
}

std::span<const Generator> generators() noexcept { return table; }

std::string accepted_by(const GeneratorParameter& parameter) {
  return fmt::format("a {} from {} to {}", parameter.whole ? "whole number" : "number", parameter.min, parameter.max);
}

const Generator& generator_of(std::string_view name) {
  if (const Generator* const generator = find_named(generators(), name)) return *generator;
  throw Error({std::string(name), "", "is not a generator", "use one of: " + names_of(generators())});
}

GeneratorValues complete_values(const Generator& generator, const GeneratorValues& given) {
  GeneratorValues values;
  for (const GeneratorParameter& parameter : generator.parameters)
    values.emplace(parameter.name, parameter.default_value);
  for (const auto& [name, value] : given) {
    const GeneratorParameter* const parameter = find_named(generator.parameters, name);
    const auto refuse = [&generator, place = "option " + name](const std::string& problem, const std::string& remedy) {
      throw Error({std::string(generator.name), place, problem, remedy});
    };
    if (parameter == nullptr) refuse("is not known", "use one of: " + names_of(generator.parameters));
    if (!parameter->accepts(value))
      refuse(fmt::format("{} is out of range", value), "choose " + accepted_by(*parameter));
    values[name] = value;
  }
  return values;
}

TriangleMesh generate(std::string_view generator, const GeneratorValues& values) {
  PartGiver whole;
  run(generator, values, whole);
  return std::move(whole.part);
}

void stream_generated(std::string_view generator, const GeneratorValues& values, const PartVisitor& visit) {
  PartGiver parts(visit);
  run(generator, values, parts);
  parts.give();
}

}  // namespace occlod
