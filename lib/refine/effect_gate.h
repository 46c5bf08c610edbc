// Lets through what the options switch on, object by object and region by region, and counts.
#pragma once

#include <algorithm>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/refine/refiner.h"
#include "refine/entry.h"

namespace occlod {

// The cell of effect_regions_per_axis^3 over `box` that holds p; points outside belong to the cell next to them.
class RegionGrid {
 public:
  explicit RegionGrid(const Box& box);
  [[nodiscard]] std::size_t region_of(const glm::vec3& p) const noexcept;

 private:
  glm::vec3 min_;
  glm::vec3 cells_per_unit_;
};

inline std::size_t RegionGrid::region_of(const glm::vec3& p) const noexcept {
  const auto cell = [&](int axis) {
    constexpr int last = effect_regions_per_axis - 1;
    const float at = (p[axis] - min_[axis]) * cells_per_unit_[axis];
    return static_cast<std::size_t>(std::clamp(at, 0.0F, static_cast<float>(last)));
  };
  return cell(0) + effect_regions_per_axis * (cell(1) + effect_regions_per_axis * cell(2));
}

// Reuses its memory from view to view.
class EffectGate {
 public:
  // Throws Error when options.effects are neither none nor one an object.
  void begin(std::span<const RefineObject> objects, const RefineOptions& options);

  [[nodiscard]] bool tests_cone(std::uint32_t object) const noexcept { return objects_[object].tests_cone; }
  // Counts a test; returns its outcome.
  bool cone_culled(std::uint32_t object, bool culled) noexcept {
    ++stats_[object].cone_tests;
    stats_[object].cone_culled += culled ? 1 : 0;
    return culled;
  }
  // About what lies around `center`.
  [[nodiscard]] bool asks(std::uint32_t object, const glm::vec3& center) const noexcept {
    const std::uint64_t regions = objects_[object].regions;
    if (regions == all_effect_regions) return true;
    return regions != 0 && ((regions >> objects_[object].grid.region_of(center)) & 1U) != 0;
  }
  // A question about what lies around `center`, a star or a subtree with an error of error_px.
  void answered(std::uint32_t object, Entry::Kind kind, const glm::vec3& center, float error_px,
                bool visible) noexcept {
    using Region = ObjectEffectStats::Region;
    Region& region = stats_[object].regions[objects_[object].grid.region_of(center)];
    ++region.queries;
    if (visible) return;
    ++region.hidden;
    if (kind == Entry::Kind::apply)
      ++region.hidden_stars;
    else
      region.hidden_subtrees_px += std::min(error_px, Region::most_error_px);
  }
  [[nodiscard]] std::span<const ObjectEffectStats> stats() const noexcept { return stats_; }

 private:
  struct Object {
    RegionGrid grid;
    std::uint64_t regions = all_effect_regions;
    bool tests_cone = true;
  };
  std::vector<Object> objects_;
  std::vector<ObjectEffectStats> stats_;
};

}  // namespace occlod
