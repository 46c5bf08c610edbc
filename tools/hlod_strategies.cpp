#include "hlod_strategies.h"

#include <algorithm>

namespace occlod::tool {

const std::vector<std::pair<std::string, hlod::Strategy>>& strategies() {
  using hlod::Strategy;
  static const std::vector<std::pair<std::string, Strategy>> all = {
      {"vfc", Strategy::vfc},           {"sw", Strategy::sw},         {"sw-b", Strategy::sw_b},
      {"bool", Strategy::boolean},      {"simp", Strategy::simp},     {"coh", Strategy::coh},
      {"ideal", Strategy::ideal},       {"nohc", Strategy::nohc},     {"chc++", Strategy::chc_plus},
      {"two-pass", Strategy::two_pass}, {"cesium", Strategy::cesium}, {"optimum", Strategy::optimum},
      {"batch", Strategy::batch},       {"auto", Strategy::automatic}};
  return all;
}

const std::string& name_of(hlod::Strategy strategy) {
  const auto found = std::find_if(strategies().begin(), strategies().end(),
                                  [&](const auto& named) { return named.second == strategy; });
  return found->first;
}

}  // namespace occlod::tool
