// Options of bench_hlod_compare that users of `occlod hlod render` do not have: strategies of papers, what they vary,
// simulated devices and a simulated disk.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "json_output.h"
#include "occlod/device.h"
#include "papers/simulated_link.h"
#include "papers/trial_traverser.h"

namespace CLI {
class App;
}

namespace occlod::hlod {
class NodeImages;
}

namespace occlod::tool {

// In the order in which help lists them.
[[nodiscard]] const std::vector<std::pair<std::string, hlod::TrialStrategy>>& trial_strategies();
[[nodiscard]] const std::string& name_of(hlod::TrialStrategy strategy);

// --tolerance, --bias, --metric, --alpha, --coherence, --cover-model, --within.
void add_trial_options(CLI::App& command, hlod::TrialOptions& options);
// All but the strategy, the oracle and the costs.
[[nodiscard]] Json to_json(const hlod::TrialOptions& options);

// --memory, --load.
void add_trial_cache_options(CLI::App& command, std::optional<hlod::TrialCacheOptions>& options);
// The mode as it is given on the command line.
[[nodiscard]] Json to_json(const hlod::TrialCacheOptions& options);

struct TrialDevice {
  std::string name;  // as on the command line
  std::unique_ptr<hlod::RenderDevice> device;
  std::optional<hlod::DeviceCosts> costs;  // by definition, of simulated ones
};

// For help.
inline constexpr const char* trial_device_names = "software, virtual:PRESET, gl, egl or osmesa";

// One of those; `images` are for simulated ones, see SoftwareDrawing::share_images(). Throws Error for any other name,
// and when this machine or build has no such device.
[[nodiscard]] TrialDevice make_trial_device(const std::string& name,
                                            const std::shared_ptr<hlod::NodeImages>& images = nullptr);
// Answers as the recording says. Throws Error.
[[nodiscard]] TrialDevice replaying_device(const std::string& file);

}  // namespace occlod::tool
