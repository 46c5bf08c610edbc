// Makes Settings from access to the value: `at(settings)` is a reference to it, const for const settings.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "setting_table.h"

namespace occlod::viewer {

struct Label {
  const char* name;
  const char* label;
  const char* help;
};

struct Range {
  double least = 0.0;
  double most = 0.0;
  bool logarithmic = false;
  const char* unit = "";
};

// Throws Error at `place` unless the number is finite and inside the range.
[[nodiscard]] double number_in(const Range& range, const JsonPlace& place);
// Returns the place of a name among the choices. Throws Error that lists them.
[[nodiscard]] std::size_t choice_in(const std::vector<const char*>& choices, const JsonPlace& place);

template <class Access>
Setting toggle(const Label& label, Access at) {
  Setting setting{label.name, label.label, label.help, Setting::Kind::toggle};
  setting.get = [at](const Settings& s) { return nlohmann::json(at(s)); };
  setting.set = [at](Settings& s, const JsonPlace& place) { at(s) = place.boolean(); };
  return setting;
}

template <class Access>
Setting number(const Label& label, const Range& range, Access at) {
  Setting setting{label.name,  label.label, label.help,        Setting::Kind::number,
                  range.least, range.most,  range.logarithmic, range.unit};
  setting.get = [at](const Settings& s) { return nlohmann::json(at(s)); };
  setting.set = [at, range](Settings& s, const JsonPlace& place) { at(s) = number_in(range, place); };
  return setting;
}

template <class Access>
Setting integer(const Label& label, const Range& range, Access at) {
  Setting setting{label.name,  label.label, label.help,        Setting::Kind::integer,
                  range.least, range.most,  range.logarithmic, range.unit};
  setting.get = [at](const Settings& s) { return nlohmann::json(at(s)); };
  setting.set = [at, range](Settings& s, const JsonPlace& place) {
    const double value = number_in(range, place);
    if (value != std::floor(value)) place.fail("is not a whole number");
    using Integer = std::remove_reference_t<decltype(at(s))>;
    at(s) = static_cast<Integer>(value);
  };
  return setting;
}

// Lists choices in the order of the enum.
template <class Access>
Setting choice(const Label& label, std::vector<const char*> choices, Access at) {
  Setting setting{label.name, label.label, label.help, Setting::Kind::choice};
  setting.get = [at, choices](const Settings& s) { return nlohmann::json(choices[static_cast<std::size_t>(at(s))]); };
  setting.set = [at, choices](Settings& s, const JsonPlace& place) {
    at(s) = static_cast<std::remove_reference_t<decltype(at(s))>>(choice_in(choices, place));
  };
  setting.choices = std::move(choices);
  return setting;
}

// Takes ascending integers >= 1, possibly none.
template <class Access>
Setting integers(const Label& label, Access at) {
  Setting setting{label.name, label.label, label.help, Setting::Kind::integers};
  setting.get = [at](const Settings& s) { return nlohmann::json(at(s)); };
  setting.set = [at](Settings& s, const JsonPlace& place) {
    std::remove_reference_t<decltype(at(s))> values;
    for (const JsonPlace& element : place.elements(0)) {
      const auto value = static_cast<std::uint32_t>(element.integer(1));
      if (!values.empty() && value <= values.back()) element.fail("is not larger than the one before it");
      values.push_back(value);
    }
    at(s) = values;
  };
  return setting;
}

[[nodiscard]] inline Setting not_kept(Setting setting) {
  setting.kept = false;
  return setting;
}

}  // namespace occlod::viewer
