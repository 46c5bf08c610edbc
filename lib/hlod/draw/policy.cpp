#include "hlod/draw/policy.h"

#include <cassert>

namespace occlod::hlod {

std::unique_ptr<Policy> make_policy(Strategy strategy) {
  switch (strategy) {
    case Strategy::vfc:
      return make_frustum_policy();
    case Strategy::sw:
      return make_waiting_policy(false);
    case Strategy::sw_b:
    case Strategy::ideal:
      return make_waiting_policy(true);
    case Strategy::boolean:
      return make_boolean_policy();
    case Strategy::simp:
      return make_queue_place_policy();
    case Strategy::coh:
      return make_coherent_policy();
    case Strategy::nohc:
      return make_near_optimal_policy();
    case Strategy::chc_plus:
      return make_grouping_policy();
    case Strategy::two_pass:
      return make_two_pass_policy();
    case Strategy::cesium:
      return make_cesium_policy();
    case Strategy::optimum:
      return make_optimum_policy();
    case Strategy::batch:
      return make_batch_policy();
    case Strategy::automatic:
      break;
  }
  assert(false);
  return nullptr;
}

}  // namespace occlod::hlod
