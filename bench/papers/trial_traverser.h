// Traversal by the strategies of papers, to compare with: rivals of ours, and oracles that tell what could be reached.
#pragma once

#include "hlod/draw/trial.h"
#include "occlod/device.h"
#include "occlod/traverser.h"
#include "occlod/view.h"

namespace occlod::hlod {

// Strategies of users, and those that they are compared with.
enum class TrialStrategy {
  vfc,        // as Strategy::vfc
  sw,         // asks every node and waits, by screen-space error
  sw_b,       // the same by biased error: the fewest nodes, the most waiting
  boolean,    // coherent hierarchical culling (Bittner and others 2004; Gobetti & Marton 2005), by screen-space error
  simp,       // Charalambos 2006: visibility predicted by the place in the queue
  coh,        // as Strategy::coh
  ideal,      // what sw_b draws, known beforehand and drawn without a query: an oracle
  nohc,       // as Strategy::nohc
  optimum,    // what single queries can reach at best: only hidden nodes are asked, where that is cheapest; an oracle
  batch,      // as Strategy::batch
  automatic,  // as Strategy::automatic
  chc_plus,   // CHC++, Mattausch and others 2008: hidden nodes in groups, visible ones now and then
  two_pass,   // as GPU-driven engines: what was visible is drawn, the rest tested against it once
  cesium,     // cesium-native's rule: what is hidden is not refined, but drawn
};

// Null for those of users, which strategy_of() names.
[[nodiscard]] const Rival* rival_of(TrialStrategy strategy);
// Of a rival vfc.
[[nodiscard]] Strategy strategy_of(TrialStrategy strategy);
// Whether it decides by the device's costs.
[[nodiscard]] bool needs_costs(TrialStrategy strategy);

// TraverseOptions and Trial in one.
struct TrialOptions {
  TrialStrategy strategy = TrialStrategy::coh;
  double tolerance_px = 1.0;
  Bias bias;  // of sw_b, simp, coh, ideal, batch and automatic
  bool biased = true;
  Metric metric = Metric::box;
  Alpha alpha = Alpha::exact;
  Coherence coherence = Coherence::mended;
  bool geomorph = false;
  bool within = false;
  RenderDevice* oracle = nullptr;  // of ideal and optimum
  DeviceCosts costs = {};
  int prefetch_frames = 15;
  CoverModel cover_model = CoverModel::in_scene;

  [[nodiscard]] TraverseOptions traverse() const;
  [[nodiscard]] Trial trial() const;
};

class TrialTraverser : public Traverser {
 public:
  using Traverser::Traverser;
  const Frame& draw_frame(const View& view, RenderDevice& device, const TrialOptions& options = {});
};

}  // namespace occlod::hlod
