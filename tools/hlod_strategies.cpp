#include "hlod_strategies.h"

#include <algorithm>

namespace occlod::tool {

const std::vector<std::pair<std::string, hlod::Strategy>>& strategies() {
  using hlod::Strategy;
  static const std::vector<std::pair<std::string, Strategy>> all = {{"vfc", Strategy::vfc},
                                                                    {"coh", Strategy::coh},
                                                                    {"nohc", Strategy::nohc},
                                                                    {"batch", Strategy::batch},
                                                                    {"auto", Strategy::automatic}};
  return all;
}

const std::string& name_of(hlod::Strategy strategy) {
  const auto found = std::find_if(strategies().begin(), strategies().end(),
                                  [&](const auto& named) { return named.second == strategy; });
  return found->first;
}

}  // namespace occlod::tool
