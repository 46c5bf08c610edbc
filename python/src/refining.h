// What Refiner and AutoRefiner have in common in Python: the objects stay alive, calls come one at a time, and results
// outlive the next call.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "occlod/refiner.h"
#include "view_like.h"

namespace occlod::python {

// A backend. Not for two calls at once.
struct PythonVisibility {
  std::unique_ptr<Visibility> backend;
  std::mutex in_use;
};

// The objects of a refiner, which it points into.
class KeptObjects {
 public:
  explicit KeptObjects(std::vector<PlacedObject> objects);
  KeptObjects(const KeptObjects&) = delete;
  KeptObjects& operator=(const KeptObjects&) = delete;

  [[nodiscard]] const std::vector<PlacedObject>& objects() const noexcept { return objects_; }
  [[nodiscard]] const std::vector<RefineObject>& refine_objects() const noexcept { return refine_objects_; }
  void place(std::size_t object, const glm::dmat4& object_to_world) {
    objects_[object].object_to_world = object_to_world;
  }

 private:
  std::vector<PlacedObject> objects_;
  std::vector<RefineObject> refine_objects_;
};

// What one call gave. Points into the refiner until its next call, and has the memory for itself from then on.
class Result {
 public:
  Result(const Refinement& refinement, std::shared_ptr<const void> refiner, std::shared_ptr<const KeptObjects> objects)
      : now_(&refinement), refiner_(std::move(refiner)), objects_(std::move(objects)) {
    for (const PlacedObject& object : objects_->objects()) places_.push_back(object.object_to_world);
  }

  [[nodiscard]] const Refinement& get() const noexcept { return *now_; }
  // Throws IndexError.
  [[nodiscard]] const RefinedObject& object(std::size_t i) const;
  [[nodiscard]] const PlacedObject& placed(std::size_t i) const { return objects_->objects()[i]; }
  // Where the object was in this call.
  [[nodiscard]] const glm::dmat4& place(std::size_t i) const { return places_[i]; }
  // Takes over what it points to: its arrays stay where they are.
  void keep(Refinement refinement) {
    kept_.emplace(std::move(refinement));
    now_ = &*kept_;
    refiner_.reset();
  }

 private:
  const Refinement* now_;
  std::optional<Refinement> kept_;
  std::shared_ptr<const void> refiner_;
  std::shared_ptr<const KeptObjects> objects_;
  std::vector<glm::dmat4> places_;
};

// A refiner with what it needs. `Refining`: Refiner or AutoRefiner.
template <typename Refining>
struct RefinerState {
  template <typename... Arguments>
  explicit RefinerState(std::vector<PlacedObject> placed, Arguments&&... arguments)
      : objects(std::make_shared<KeptObjects>(std::move(placed))),
        refiner(objects->refine_objects(), std::forward<Arguments>(arguments)...) {}

  std::shared_ptr<KeptObjects> objects;
  Refining refiner;
  std::mutex in_use;
  std::weak_ptr<Result> last;              // of the last call; alive while Python holds it or an array of it
  std::shared_ptr<const void> visibility;  // of the last call: the refiner compares its address
};

// Gives the result of `call`, a Refinement, which runs without the GIL and alone: `lock` protects all that it uses.
// Nobody waits for that lock with the GIL in hand.
template <typename Refining, typename Lock, typename Call>
std::shared_ptr<Result> run(const std::shared_ptr<RefinerState<Refining>>& state, const Lock& lock, const Call& call) {
  const ReleasedGil release;
  const auto locked = lock();
  if (const std::shared_ptr<Result> last = state->last.lock()) {
    state->last.reset();
    const HeldGil acquire;  // Python may be reading it
    last->keep(state->refiner.take_result());
  }
  const Refinement& refinement = call();
  auto result = std::make_shared<Result>(refinement, state, state->objects);
  state->last = result;
  return result;
}

// Places an object elsewhere. `Refining` has a RefinerState.
template <typename Refining>
void set_transform(Refining& refining, std::size_t object, const ArrayLike& transform) {
  const glm::dmat4 matrix = to_matrix(transform, "transform");
  const ReleasedGil release;
  const std::scoped_lock lock(refining.state->in_use);
  refining.state->refiner.set_transform(object, matrix);
  refining.state->objects->place(object, matrix);
}

// The objects of an Object, a Hierarchy, or a sequence of them. TypeError for anything else.
[[nodiscard]] std::vector<PlacedObject> to_objects(nb::handle objects);

// `options`, or the standard ones, with `budget` in place of theirs where it is given.
[[nodiscard]] RefineOptions to_options(const std::optional<RefineOptions>& options, std::optional<std::size_t> budget);

}  // namespace occlod::python
