// How much of a node's error counts when only part of the node is visible.
#pragma once

namespace occlod::hlod {

// Charalambos and others 2007, sec. 4: a blend of mu itself and a sigmoid with its turning point at t. The paper prints
// no formula; this is the simplest smooth one with the properties that it names (docs/guide/hlod.md).
struct Bias {
  double s = 1.0;  // share of the sigmoid, in [0, 1]; 0: mu itself, as in Charalambos 2006
  double t = 0.3;  // turning point, in [0, 1]: below it errors count less than by mu, above it more

  // mu: visible pixels of a node's box over all pixels that it covers, clamped to [0, 1]. In [0, 1], monotone; 0 at 0,
  // 1 at 1.
  [[nodiscard]] double operator()(double mu) const noexcept;

  friend bool operator==(const Bias&, const Bias&) = default;
};

// Everything visible counts in full: plain screen-space error.
[[nodiscard]] constexpr double no_bias(double mu) noexcept { return mu > 0.0 ? 1.0 : 0.0; }

}  // namespace occlod::hlod
