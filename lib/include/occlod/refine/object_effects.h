// Which of the effects that cost time work on one object, and what they did there.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace occlod {

// Regions of an object: the cells of a grid over its box, x fastest; a node belongs to the one that holds the middle of
// its sphere.
inline constexpr std::size_t effect_regions_per_axis = 4;
inline constexpr std::size_t effect_region_count =
    effect_regions_per_axis * effect_regions_per_axis * effect_regions_per_axis;
inline constexpr std::uint64_t all_effect_regions = ~std::uint64_t{0};

struct ObjectEffects {
  bool cones = true;  // drop subtrees whose normal cone faces away. With Culling::star this changes what is looked at
                      // and not what is worth a triangle
  bool occlusion = true;                       // ask whether parts of it are hidden; it hides others all the same
  std::uint64_t regions = all_effect_regions;  // of these, only in the regions whose bits are set

  // In so many regions it is asked.
  [[nodiscard]] int regions_on() const noexcept { return occlusion ? std::popcount(regions) : 0; }
  friend bool operator==(const ObjectEffects&, const ObjectEffects&) = default;
};

struct ObjectEffectStats {
  std::size_t cone_tests = 0;
  std::size_t cone_culled = 0;
  struct Region {
    std::uint32_t queries = 0;
    std::uint32_t hidden = 0;         // of these
    std::uint32_t hidden_stars = 0;   // of these, questions about the star of one split
    float hidden_subtrees_px = 0.0F;  // sum of the errors of the others, each no more than most_error_px: as many
                                      // splits as this has of the error at the end are below them
    static constexpr float most_error_px = 1e4F;
  };
  std::array<Region, effect_region_count> regions{};

  // Of all regions.
  [[nodiscard]] std::size_t queries() const noexcept {
    return std::accumulate(regions.begin(), regions.end(), std::size_t{0},
                           [](std::size_t sum, const Region& region) { return sum + region.queries; });
  }
  [[nodiscard]] std::size_t hidden() const noexcept {
    return std::accumulate(regions.begin(), regions.end(), std::size_t{0},
                           [](std::size_t sum, const Region& region) { return sum + region.hidden; });
  }
};

}  // namespace occlod
