// What a way to refine is worth in the views of a scene.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "accuracy.h"
#include "occlod/refiner.h"
#include "visibility/scene_run.h"

namespace occlod::bench {

// Refines a view; what it returns lives until the next call.
using Refine = std::function<const Refinement&(const View& view)>;

// Of one way, by view.
struct Scores {
  std::vector<std::vector<double>> frame_ms;  // of all rounds
  std::vector<std::vector<double>> error_px;  // likewise; of one round where all are the same

  // Geometric mean over the views of median time * median error.
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
  // One more round of view i: refines and draws, and adds the time and the error; the error of the first only, unless
  // the mesh may differ from round to round.
  void add(std::size_t i, const Refine& refine, Scores& scores, bool may_differ = false);

 private:
  const SceneRun& run_;
  std::vector<View> views_;
  std::vector<tool::FullMeshPicture> full_;
  std::vector<DrawObject> drawn_;
  ItemBuffer items_;
};

}  // namespace occlod::bench
