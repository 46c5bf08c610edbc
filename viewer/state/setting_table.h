// Lists every setting by name: what panels draw, scripts set and the settings file keeps.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/strict_json.h"
#include "settings.h"

namespace occlod::viewer {

struct Setting {
  enum class Kind { toggle, integer, number, choice, integers };

  const char* name = "";   // in scripts and in the settings file
  const char* label = "";  // in panels
  const char* help = "";   // one sentence
  Kind kind = Kind::toggle;
  double least = 0.0;
  double most = 0.0;
  bool logarithmic = false;
  const char* unit = "";
  std::vector<const char*> choices{};
  bool kept = true;  // from one run to the next
  std::function<nlohmann::json(const Settings&)> get{};
  std::function<void(Settings&, const JsonPlace&)> set{};  // throws Error for an invalid value; see assign()
};

// Sets it to the value at `place`. Throws Error that names the setting and the value when it is invalid.
void assign(const Setting& setting, Settings& settings, const JsonPlace& place);

// Settings are in the order in which panels show them.
[[nodiscard]] std::span<const Setting> refine_settings();
[[nodiscard]] std::span<const Setting> hlod_settings();
[[nodiscard]] std::span<const Setting> cells_settings();
[[nodiscard]] std::span<const Setting> look_settings();
[[nodiscard]] std::span<const Setting> study_settings();
[[nodiscard]] std::span<const Setting> camera_settings();
[[nodiscard]] std::span<const Setting> window_settings();
[[nodiscard]] std::vector<const Setting*> all_settings();

// Returns null for an unknown name.
[[nodiscard]] const Setting* find_setting(std::string_view name);

}  // namespace occlod::viewer
