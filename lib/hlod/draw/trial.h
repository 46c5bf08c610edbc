// How traversal may be varied for comparisons with papers. Users have no such choice: bench/papers sets it, by
// Traverser::set_trial().
#pragma once

#include <memory>

#include "hlod/draw/cover_model.h"
#include "occlod/device.h"

namespace occlod::hlod {

class Policy;

// How the error of a node on the screen is bounded.
enum class Metric {
  box,         // screen_error_px()
  sphere,      // sphere_error_px(), as published
  guaranteed,  // guaranteed_error_px(): a bound, several times the others; nodes are not refined within
};

// How the pixels of a node's box on an empty screen are counted.
enum class Alpha {
  exact,  // area of the box's outline inside the image
  paper,  // Charalambos 2006, sec. 4.3: a cube of the box's volume seen from the front
};

// When coh asks about nodes.
enum class Coherence {
  // When all that is known to be visible has been drawn. A node that may stand for its children again is asked about
  // while these are drawn once more. So nothing is taken for visible that shows only through a hole where something is
  // still to be drawn.
  mended,
  published,  // Charalambos and others 2007: in turn; such a node is drawn when its answer comes, not its children
};

// A strategy that draws in place of TraverseOptions::strategy.
struct Rival {
  std::unique_ptr<Policy> (*make)() = nullptr;
  bool needs_costs = false;   // it decides by TraverseOptions::costs
  bool needs_oracle = false;  // it is told what is hidden by Trial::oracle
  bool is_ideal = false;      // it is traversed on the oracle, and what that draws is drawn on the device
};

struct Trial {
  const Rival* rival = nullptr;             // outlives the traverser; null: none. A change forgets what was visible
  bool biased = true;                       // false: whatever is visible counts in full, with every strategy
  Metric metric = Metric::box;              // of the error that is compared with the tolerance
  Alpha alpha = Alpha::exact;               // how mu is computed for the bias
  Coherence coherence = Coherence::mended;  // of coh
  // Of nohc and batch. `printed` also means that benefits are spread over log2 of the nodes, as in a binary tree; else
  // over the levels.
  CoverModel cover_model = CoverModel::printed;
  // Of a rival that needs one: draws and asks by stop-and-wait, so that it is known what to draw. Not the device that
  // is drawn on; its time is nobody's.
  RenderDevice* oracle = nullptr;

  friend bool operator==(const Trial&, const Trial&) = default;
};

}  // namespace occlod::hlod
