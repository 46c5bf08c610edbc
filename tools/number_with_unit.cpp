#include "number_with_unit.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <system_error>

#include "base/text.h"
#include "occlod/base.h"
#include "option_values.h"

namespace occlod::tool {
namespace {

// Returns the number before a suffix; nothing for other text and for what is below 0.
std::optional<double> number_before(const std::string& text, std::string_view suffix) {
  if (!text.ends_with(suffix)) return std::nullopt;
  const char* const end = text.data() + text.size() - suffix.size();
  double value = 0.0;
  const auto [stop, problem] = parse_double(text.data(), end, value);
  if (problem != std::errc() || stop != end || !std::isfinite(value) || std::signbit(value)) return std::nullopt;
  return value;
}

// Adds an option whose text `parse` turns into a value.
template <typename Value, typename Parse>
CLI::Option* add_parsed(CLI::App& command, const std::string& name, std::optional<Value>& value, const Parse& parse,
                        const std::string& wanted, const std::string& about) {
  const auto check = CLI::Validator(
      [parse, wanted](std::string& text) {
        return parse(text) ? std::string() : fmt::format("{} is not {}", shown(text), wanted);
      },
      "", name);
  return command
      .add_option_function<std::string>(
          name, [&value, parse](const std::string& text) { value = parse(text); }, about)
      ->transform(check);
}

}  // namespace

std::optional<double> ratio_of(const std::string& text) {
  std::optional<double> value = number_before(text, "");
  if (const auto percent = number_before(text, "%")) value = *percent / 100.0;
  return value && *value <= 1.0 ? value : std::nullopt;
}

std::optional<Length> length_of(const std::string& text) {
  using Of = Length::Of;
  if (const auto value = number_before(text, "")) return Length{Of::mesh, *value};
  if (const auto value = number_before(text, "%")) return Length{Of::diagonal, *value / 100.0};
  if (const auto value = number_before(text, "mm")) return Length{Of::metre, *value / 1000.0};
  if (const auto value = number_before(text, "cm")) return Length{Of::metre, *value / 100.0};
  if (const auto value = number_before(text, "m")) return Length{Of::metre, *value};
  return std::nullopt;
}

double in_mesh_units(const Length& length, const std::string& file, double diagonal) {
  if (length.of == Length::Of::diagonal) return length.value * diagonal;
  if (length.of == Length::Of::metre && !file.ends_with(".glb") && !file.ends_with(".gltf"))
    throw Error(
        {file, "", "has no unit of length, as only glTF has", "give --error as a number in its units, or in %"});
  return length.value;
}

CLI::Option* add_ratio(CLI::App& command, std::optional<double>& ratio, const std::string& about) {
  const auto parse = [](const std::string& text) {
    const auto value = ratio_of(text);
    return value && *value > 0.0 ? value : std::nullopt;
  };
  return add_parsed(command, "--ratio", ratio, parse, "a share above 0 and at most 1, such as 10% or 0.1", about)
      ->type_name("R");
}

CLI::Option* add_error(CLI::App& command, std::optional<Length>& error, Zero zero, const std::string& about) {
  const auto parse = [zero](const std::string& text) {
    const auto length = length_of(text);
    return length && (length->value > 0.0 || zero == Zero::taken) ? length : std::nullopt;
  };
  const std::string wanted = zero == Zero::taken ? "a length of at least 0" : "a length above 0";
  return add_parsed(command, "--error", error, parse, wanted + ", such as 0.5, 0.5mm or 0.1%", about)->type_name("E");
}

}  // namespace occlod::tool
