// Refinement that switches on only those effects that pay: the setting `auto` (docs/guide/effects.md).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "occlod/effects/effect_choice.h"
#include "occlod/refine/refiner.h"

namespace occlod {

struct AutoOptions {
  std::optional<Calibration> calibration;             // nothing: measured, some 40 ms
  std::vector<std::unique_ptr<Visibility>> backends;  // to choose from; none: the software backend
};

// A Refiner that learns from view to view. Its choices depend on the calibration and on counts, never on a clock: the
// same calibration, objects, views and options in the same order give the same meshes. One thread at a time.
class AutoRefiner {
 public:
  // Throws Error when a hierarchy is missing or the calibration knows nothing of a backend.
  explicit AutoRefiner(std::span<const RefineObject> objects, AutoOptions options = {});
  ~AutoRefiner();
  AutoRefiner(AutoRefiner&&) noexcept;
  AutoRefiner& operator=(AutoRefiner&&) noexcept;

  [[nodiscard]] const Calibration& calibration() const noexcept;
  [[nodiscard]] std::size_t base_triangles() const noexcept;
  [[nodiscard]] std::size_t full_triangles() const noexcept;

  // As Refiner::set_transform().
  void set_transform(std::size_t object, const glm::dmat4& object_to_world);

  // As Refiner::refine(), with effects chosen for the view in place of options.occluder but its mode, of
  // options.queries but its proxy, and of options.effects. Throws Error likewise.
  const Refinement& refine(const View& view, const RefineOptions& options);
  // As Refiner::update(), with effects chosen for each view. The mesh goes on when they change. They stay what they are
  // while the same view and options are given again, and where another choice would be but little better. Normal cones
  // stay on: they are weighed many at a time.
  const Refinement& update(const View& view, const RefineOptions& options);

  // As Refiner::visibility_ages().
  [[nodiscard]] std::vector<std::uint32_t> visibility_ages(std::size_t object) const;

  // Of the last view.
  [[nodiscard]] const EffectReport& report() const noexcept;
  // The backend that choice().backend names.
  [[nodiscard]] Visibility& backend(std::size_t index) const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace occlod
