// Varies traversal for comparisons with papers. Users have no such choice: bench/papers sets it through
// Traverser::set_trial().
#pragma once

#include <memory>

#include "hlod/draw/cover_model.h"
#include "occlod/device.h"

namespace occlod::hlod {

class Policy;

// Names how the error of a node on the screen is bounded.
enum class Metric {
  box,         // screen_error_px()
  sphere,      // sphere_error_px(), as published
  guaranteed,  // guaranteed_error_px(): a bound, several times the others; nodes are not refined within
};

// Names how the pixels of a node's box on an empty screen are counted.
enum class Alpha {
  exact,  // area of the box's outline inside the image
  paper,  // Charalambos 2006, sec. 4.3: a cube of the box's volume seen from the front
};

// Names when coh queries nodes.
enum class Coherence {
  // Nodes are queried when all nodes that are known to be visible have been drawn. While a node that may replace its
  // children again is queried, the children are drawn once more. A node that is refined because of what showed through
  // a hole, before something nearer was drawn, is queried again when the hole is filled.
  mended,
  published,  // Charalambos and others 2007: in turn; such a node is drawn when its answer comes, not its children
};

// Describes a strategy that replaces TraverseOptions::strategy.
struct Rival {
  std::unique_ptr<Policy> (*make)() = nullptr;
  bool needs_costs = false;   // decides by TraverseOptions::costs
  bool needs_oracle = false;  // learns from Trial::oracle what is hidden
  bool is_ideal = false;      // is traversed on the oracle, and the result is drawn on the device
};

struct Trial {
  const Rival* rival = nullptr;             // must outlive the traverser; null: none. A change forgets what was visible
  bool biased = true;                       // false: everything visible counts in full, with every strategy
  Metric metric = Metric::box;              // for the error that is compared with the tolerance
  Alpha alpha = Alpha::exact;               // for mu, from which the bias is computed
  Coherence coherence = Coherence::mended;  // for coh
  // The model of nohc and batch. `printed` also spreads benefits over log2 of the number of nodes, as in a binary tree,
  // instead of over the levels.
  CoverModel cover_model = CoverModel::in_scene;
  // A device that draws and queries by stop-and-wait, for a rival that needs to know what is visible. It differs from
  // the device that is drawn on, and its time does not count.
  RenderDevice* oracle = nullptr;

  friend bool operator==(const Trial&, const Trial&) = default;
};

}  // namespace occlod::hlod
