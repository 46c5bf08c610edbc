// Refines, draws and times views of the same objects one after the other.
#pragma once

#include <span>
#include <vector>

#include "occlod/auto_refiner.h"
#include "occlod/item_buffer.h"
#include "occlod/picture.h"
#include "occlod/refiner.h"
#include "occlod/scene.h"
#include "occlod/view.h"

namespace occlod::tool {

// Holds medians over all repetitions.
struct RenderTimes {
  double refine_ms = 0.0;
  double occlusion_ms = 0.0;
  double draw_ms = 0.0;

  [[nodiscard]] double frame_ms() const { return refine_ms + occlusion_ms + draw_ms; }
};

// Tells how a view follows the previous one: not at all (Refiner::refine()), or as the next frame (Refiner::update()).
enum class Following { none, frame_to_frame };

// Uses one Refiner and one item buffer for all views. `objects` must outlive it.
class Measurement {
 public:
  explicit Measurement(const std::vector<LoadedObject>& objects, Following following = Following::none);

  // Forgets earlier times.
  void begin();
  // Repeats once more; the accessors then refer to that repetition. Frame to frame, each repetition is one more frame.
  void repeat(const View& view, const RefineOptions& options, Visibility& visibility);
  void repeat(const View& view, const RefineOptions& options, AutoRefiner& refiner);

  [[nodiscard]] const Refiner& refiner() const { return refiner_; }
  [[nodiscard]] const Refinement& refinement() const { return *refinement_; }
  [[nodiscard]] const ItemBuffer& items() const { return items_; }
  [[nodiscard]] std::span<const DrawObject> objects() const { return drawn_; }
  [[nodiscard]] std::size_t visible_triangles() const;
  [[nodiscard]] RenderTimes times() const;  // since begin()

 private:
  void take(const Refinement& refinement);
  void draw(const View& view, const RefineOptions& options);

  const std::vector<LoadedObject>& objects_;
  Following following_;
  Refiner refiner_;
  const Refinement* refinement_ = nullptr;
  std::vector<MorphedPositions> morphed_;  // per object, once there are geomorphs to draw
  std::vector<DrawObject> drawn_;
  ItemBuffer items_;
  std::vector<double> refine_ms_;
  std::vector<double> occlusion_ms_;
  std::vector<double> draw_ms_;
};

}  // namespace occlod::tool
