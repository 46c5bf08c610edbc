// The generators and their options, each described once: for their checks, scene files, names of meshes and the command
// line.
#pragma once

#include <cstdint>
#include <tuple>
#include <type_traits>

#include "base/option_checker.h"
#include "occlod/generate.h"

namespace occlod {

template <class Options, class Value>
struct GeneratorOption {
  const char* name;
  Value Options::*field;
  double low, high;  // of an integer or a double; a seed is any number of 64 bits
  const char* about;
};

template <class Options>
constexpr GeneratorOption<Options, std::uint64_t> seed_option() {
  return {"seed", &Options::seed, 0.0, 0.0, "random seed"};
}

template <class Options>
struct Generator;  // specialised below: name, about, options, generate and stream

template <>
struct Generator<RoughPlanetOptions> {
  using O = RoughPlanetOptions;
  static constexpr const char* name = "rough-planet";
  static constexpr const char* about = "a sphere with random hills: 8 * 4^level triangles";
  static constexpr auto options = std::tuple(
      GeneratorOption<O, int>{"level", &O::level, 0, 11, "subdivisions"}, seed_option<O>(),
      GeneratorOption<O, double>{"amplitude", &O::amplitude, 0.0, 0.99, "largest height of a hill, of the radius"},
      GeneratorOption<O, double>{"frequency", &O::frequency, 0.0, 1e6, "noise cells per radius"},
      GeneratorOption<O, int>{"octaves", &O::octaves, 0, 30, "octaves of noise"});
  static constexpr auto generate = generate_rough_planet;
  static constexpr auto stream = stream_rough_planet;
};

template <>
struct Generator<CityOptions> {
  using O = CityOptions;
  static constexpr const char* name = "city";
  static constexpr const char* about = "blocks of buildings on a plane, z up";
  static constexpr auto options =
      std::tuple(GeneratorOption<O, int>{"blocks", &O::blocks, 1, 256, "blocks along each side"},
                 GeneratorOption<O, int>{"facade_cells", &O::facade_cells, 1, 256,
                                         "cells along each edge of a wall; two triangles per cell"},
                 seed_option<O>());
  static constexpr auto generate = generate_city;
  static constexpr auto stream = stream_city;
};

template <>
struct Generator<PipesOptions> {
  using O = PipesOptions;
  static constexpr const char* name = "pipes";
  static constexpr const char* about = "a bundle of bent pipes in a unit cube";
  static constexpr auto options = std::tuple(
      GeneratorOption<O, int>{"pipes", &O::pipes, 1, 1'000'000, "number of pipes"},
      GeneratorOption<O, int>{"bends", &O::bends, 1, 100'000, "straight pieces per pipe"},
      GeneratorOption<O, int>{"sides", &O::sides, 3, 4096, "corners of the cross-section"}, seed_option<O>());
  static constexpr auto generate = generate_pipes;
  static constexpr auto stream = stream_pipes;
};

template <>
struct Generator<PlantOptions> {
  using O = PlantOptions;
  static constexpr const char* name = "plant";
  static constexpr const char* about = "storeys of rooms full of pipes, with floors, walls and doors, z up";
  static constexpr auto options = std::tuple(
      GeneratorOption<O, int>{"storeys", &O::storeys, 1, 64, "number of storeys"},
      GeneratorOption<O, int>{"bays", &O::bays, 1, 256, "rooms along the aisle of each storey"},
      GeneratorOption<O, int>{"pipes", &O::pipes, 1, 10'000, "pipes on each side of a room"},
      GeneratorOption<O, int>{"bends", &O::bends, 1, 100'000, "straight pieces per pipe"},
      GeneratorOption<O, int>{"sides", &O::sides, 3, 4096, "corners of the cross-section"}, seed_option<O>());
  static constexpr auto generate = generate_plant;
  static constexpr auto stream = stream_plant;
};

template <>
struct Generator<SpheresBehindWallOptions> {
  using O = SpheresBehindWallOptions;
  static constexpr const char* name = "spheres-behind-wall";
  static constexpr const char* about = "spheres that a wall hides from +x";
  static constexpr auto options =
      std::tuple(GeneratorOption<O, int>{"spheres", &O::spheres, 1, 1'000'000, "number of spheres"},
                 GeneratorOption<O, int>{"level", &O::level, 0, 8, "subdivisions of each sphere"},
                 GeneratorOption<O, int>{"wall_cells", &O::wall_cells, 1, 4096, "cells along each edge of the wall"},
                 seed_option<O>());
  static constexpr auto generate = generate_spheres_behind_wall;
  static constexpr auto stream = stream_spheres_behind_wall;
};

// Calls visit(Options()) for the default options of each.
template <class Visit>
void for_each_generator(const Visit& visit) {
  visit(RoughPlanetOptions());
  visit(CityOptions());
  visit(PipesOptions());
  visit(PlantOptions());
  visit(SpheresBehindWallOptions());
}

// Calls visit(option, value) for each GeneratorOption and the field that it is of, which may be assigned where
// `options` are not constant.
template <class Options, class Visit>
void for_each_option(Options& options, const Visit& visit) {
  std::apply([&](const auto&... option) { (visit(option, options.*option.field), ...); },
             Generator<std::remove_const_t<Options>>::options);
}

// Throws Error that names an option out of its range.
template <class Options>
void check_ranges(const Options& options, const OptionChecker& check) {
  for_each_option(options, [&](const auto& option, const auto& value) {
    if constexpr (!std::is_same_v<decltype(value), const std::uint64_t&>)
      check.in_range(option.name, value, option.low, option.high);
  });
}

}  // namespace occlod
