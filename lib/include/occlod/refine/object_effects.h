// Which of the tests that cost time are made for one object, and what they achieved there.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace occlod {

// Regions of an object are the cells of a grid over its box. A node is in the one that contains the centre of its
// sphere.
inline constexpr std::size_t effect_regions_per_axis = 4;
// Region i is cell (i % 4, i / 4 % 4, i / 16).
inline constexpr std::size_t effect_region_count =
    effect_regions_per_axis * effect_regions_per_axis * effect_regions_per_axis;
// One bit for each region.
inline constexpr std::uint64_t all_effect_regions = ~std::uint64_t{0};

// The tests that are made for one object.
struct ObjectEffects {
  bool cones = true;      // drop subtrees whose normal cone faces away; with Culling::star this saves time and does not
                          // change which splits are worth a triangle
  bool occlusion = true;  // ask whether parts of it are hidden; it hides others in any case
  std::uint64_t regions = all_effect_regions;  // occlusion: only in the regions whose bits are set

  // Number of regions in which occlusion is asked about.
  [[nodiscard]] int regions_on() const noexcept { return occlusion ? std::popcount(regions) : 0; }
  friend bool operator==(const ObjectEffects&, const ObjectEffects&) = default;
};

// What the tests did for one object in one call.
struct ObjectEffectStats {
  std::size_t cone_tests = 0;   // nodes whose normal cone was tested
  std::size_t cone_culled = 0;  // of these, nodes that faced away
  // What queries did in one region.
  struct Region {
    std::uint32_t queries = 0;        // answered
    std::uint32_t hidden = 0;         // of these, answered hidden
    std::uint32_t hidden_stars = 0;   // of the hidden ones, queries about the star of one split
    float hidden_subtrees_px = 0.0F;  // sum over the other hidden ones of the node's error, each at most most_error_px.
                                      // Divided by RefineStats::level_px: about the splits below them that were saved
    static constexpr float most_error_px = 1e4F;  // pixels
  };
  std::array<Region, effect_region_count> regions{};  // by region

  // Queries in all regions.
  [[nodiscard]] std::size_t queries() const noexcept {
    return std::accumulate(regions.begin(), regions.end(), std::size_t{0},
                           [](std::size_t sum, const Region& region) { return sum + region.queries; });
  }
  // Of these, answered hidden.
  [[nodiscard]] std::size_t hidden() const noexcept {
    return std::accumulate(regions.begin(), regions.end(), std::size_t{0},
                           [](std::size_t sum, const Region& region) { return sum + region.hidden; });
  }
};

}  // namespace occlod
