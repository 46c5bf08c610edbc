// Refinement that asks about occlusion only where that is expected to pay: the setting `auto`.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "occlod/effects/effect_choice.h"
#include "occlod/refine/refiner.h"

namespace occlod {

// What an AutoRefiner chooses from, and by what costs.
struct AutoOptions {
  std::optional<Calibration> calibration;  // none: measured, some 150 ms
  std::vector<std::unique_ptr<Visibility>>
      backends;  // to choose from, each with another name; none: the software backend
};

// A Refiner that learns from view to view. Its choices depend on the calibration and on counts, never on a clock: the
// same calibration, objects, views and options in the same order give the same meshes. One thread at a time.
class AutoRefiner {
 public:
  // Throws Error when a hierarchy or a backend is missing, when check_calibration() refuses the calibration, or when it
  // does not know a backend.
  explicit AutoRefiner(std::span<const RefineObject> objects, AutoOptions options = {});
  ~AutoRefiner();
  AutoRefiner(AutoRefiner&&) noexcept;
  AutoRefiner& operator=(AutoRefiner&&) noexcept;

  // As given or measured, of the given backends in their order.
  [[nodiscard]] const Calibration& calibration() const noexcept;
  // As Refiner::base_triangles().
  [[nodiscard]] std::size_t base_triangles() const noexcept;
  // As Refiner::full_triangles().
  [[nodiscard]] std::size_t full_triangles() const noexcept;

  // As Refiner::set_transform().
  void set_transform(std::size_t object, const glm::dmat4& object_to_world);

  // As Refiner::refine(), with effects chosen for the view in place of options.occluder but its mode, of
  // options.queries but its proxy, and of options.effects. Throws Error likewise.
  const Refinement& refine(const View& view, const RefineOptions& options);
  // As Refiner::update(), with effects chosen for each view; a change of effects does not start from scratch. They stay
  // the same while the same view and options are given again, and where another choice would be only a little better.
  // Normal cones stay on: they are tested many at a time.
  const Refinement& update(const View& view, const RefineOptions& options);

  // As Refiner::take_result().
  [[nodiscard]] Refinement take_result();

  // As Refiner::visibility_ages().
  [[nodiscard]] std::vector<std::uint32_t> visibility_ages(std::size_t object) const;

  // About the last view; valid until the next call.
  [[nodiscard]] const EffectReport& report() const noexcept;
  // The backend with this index, as EffectChoice::backend gives it.
  [[nodiscard]] Visibility& backend(std::size_t index) const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace occlod
