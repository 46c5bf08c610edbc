#include "setting_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "occlod/base.h"
#include "setting_kinds.h"

namespace occlod::viewer {

double number_in(const Range& range, const JsonPlace& place) {
  const double value = place.number();
  if (!(value >= range.least && value <= range.most))
    place.fail(fmt::format("is not between {} and {}", range.least, range.most));
  return value;
}

std::size_t choice_in(const std::vector<const char*>& choices, const JsonPlace& place) {
  const std::string name = place.string();
  for (std::size_t i = 0; i < choices.size(); ++i)
    if (name == choices[i]) return i;
  place.fail("is none of its choices", fmt::format("use one of: {}", fmt::join(choices, ", ")));
}

void assign(const Setting& setting, Settings& settings, const JsonPlace& place) {
  try {
    setting.set(settings, place);
  } catch (const Error& error) {
    const Diagnosis& d = error.diagnosis();
    throw Error({d.subject, d.place, fmt::format("{} = {} {}", setting.name, place.text(), d.problem), d.remedy});
  }
}

std::vector<const Setting*> all_settings() {
  std::vector<const Setting*> all;
  for (const auto& group : {refine_settings(), hlod_settings(), cells_settings(), look_settings(), study_settings(),
                            camera_settings(), window_settings()})
    for (const Setting& setting : group) all.push_back(&setting);
  return all;
}

const Setting* find_setting(std::string_view name) {
  for (const Setting* setting : all_settings())
    if (setting->name == name) return setting;
  return nullptr;
}

}  // namespace occlod::viewer
