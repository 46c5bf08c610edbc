// How the eye moves, and which cells it may enter soon.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "occlod/viewcells/cell_tree.h"

namespace occlod {

// A cell that may be entered.
struct ExpectedCell {
  CellId leaf = no_id;
  double seconds = 0.0;  // until then, at the soonest
};

// Velocity as an exponential mean over 0.2 s. A step longer than a root cell is a jump, and tells nothing of it.
class WalkMotion {
 public:
  explicit WalkMotion(double jump) : jump_(jump) {}

  void step(const glm::dvec3& eye, double seconds);
  [[nodiscard]] const glm::dvec3& velocity() const noexcept { return velocity_; }

 private:
  double jump_;
  bool is_first_ = true;
  glm::dvec3 eye_{0.0}, velocity_{0.0};
};

// The cells that may be entered within `horizon` seconds, the soonest first; that of the eye is not among them: the
// neighbours across its faces, and what lies in a cone of slope 1/4 around straight ahead. At most `most`.
class CellForecast {
 public:
  explicit CellForecast(const CellTree& tree) : tree_(tree) {}
  // Valid until the next call.
  const std::vector<ExpectedCell>& expect(CellId leaf, const glm::dvec3& eye, const glm::dvec3& velocity,
                                          double horizon, std::size_t most);

 private:
  void add(CellId leaf, double seconds);

  const CellTree& tree_;
  CellId here_ = no_id;
  std::vector<CellId> neighbours_;  // of here_
  std::vector<CellId> found_;       // scratch
  std::vector<ExpectedCell> expected_;
};

}  // namespace occlod
