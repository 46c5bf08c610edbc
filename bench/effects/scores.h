// What a way to refine is worth in the views of a scene.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "accuracy.h"
#include "occlod/refine/refiner.h"
#include "visibility/scene_run.h"

namespace occlod::bench {

// Refines a view; what it returns lives until the next call.
using Refine = std::function<const Refinement&(const View& view)>;

// Of one way, by view.
struct Scores {
  std::vector<std::vector<double>> frame_ms;  // of all rounds
  std::vector<double> error_px;

  // Geometric mean over the views of median time * error.
  [[nodiscard]] double score() const;
  [[nodiscard]] double frame_ms_mean() const;  // likewise
  [[nodiscard]] double error_px_mean() const;
};

// The views of one scene, and the pictures of its full meshes.
class ScoredViews {
 public:
  ScoredViews(const SceneRun& run, int frames);
  [[nodiscard]] std::size_t size() const { return views_.size(); }
  [[nodiscard]] const View& view(std::size_t i) const { return views_[i]; }

  // Refines and draws view i.
  void draw(std::size_t i, const Refine& refine);
  // One more round of view i: refines and draws, and adds the time; the error when it is the first.
  void add(std::size_t i, const Refine& refine, Scores& scores);

 private:
  const SceneRun& run_;
  std::vector<View> views_;
  std::vector<tool::FullMeshPicture> full_;
  std::vector<DrawObject> drawn_;
  ItemBuffer items_;
};

}  // namespace occlod::bench
