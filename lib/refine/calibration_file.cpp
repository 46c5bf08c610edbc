#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "refine/calibration_fields.h"
#include "base/option_checker.h"
#include "raster/device_cost_fields.h"
#include "base/atomic_file.h"
#include "base/file_input.h"
#include "occlod/core/error.h"
#include "occlod/effects/calibration.h"
#include "base/strict_json.h"

namespace occlod {
namespace {

using Json = nlohmann::ordered_json;

double positive(const JsonPlace& place) {
  const double value = place.number();
  if (!(value > 0.0 && std::isfinite(value))) place.fail("is not larger than 0", "measure it again");
  return value;
}

BackendCosts read_backend(const JsonPlace& place) {
  place.expect_keys(
      {"name", "occluder_triangle_ns", "occluder_fragment_ns", "occluder_pixel_ns", "query_ns", "latency_ns"});
  BackendCosts costs;
  costs.name = place.at("name").string();
  for_each_backend_cost(costs, [&](const char* key, double& value) { value = positive(place.at(key)); });
  return costs;
}

hlod::DeviceCosts read_device(const JsonPlace& place) {
  hlod::DeviceCosts costs;
  std::vector<std::string_view> keys{"name", "latency_commands"};
  hlod::for_each_device_cost(costs, [&](const char* key, double) { keys.emplace_back(key); });
  place.expect_keys(keys);
  costs.name = place.at("name").string();
  costs.latency_commands = static_cast<std::uint32_t>(place.at("latency_commands").integer(0));
  hlod::for_each_device_cost(costs, [&](const char* key, double& value) {
    value = place.at(key).number();
    if (!(value >= 0.0 && std::isfinite(value))) place.at(key).fail("is below 0", "measure it again");
  });
  return costs;
}

// Of the elements of an array so far, the last must have a name of its own.
template <typename Costs>
void expect_new_name(const std::vector<Costs>& costs, const JsonPlace& place) {
  for (std::size_t i = 0; i + 1 < costs.size(); ++i)
    if (costs[i].name == costs.back().name) place.at("name").fail("is there twice", "leave one of them out");
}

}  // namespace

const hlod::DeviceCosts& device_costs_of(const Calibration& calibration, std::string_view device) {
  const auto found = std::find_if(calibration.devices.begin(), calibration.devices.end(),
                                  [&](const hlod::DeviceCosts& costs) { return costs.name == device; });
  if (found != calibration.devices.end()) return *found;
  std::string names;
  for (const hlod::DeviceCosts& costs : calibration.devices) names += (names.empty() ? "" : ", ") + costs.name;
  throw Error({"calibration", "devices", "has no device " + in_quotes(std::string(device)),
               names.empty() ? "measure it" : "there are " + names});
}

void check_calibration(const Calibration& calibration) {
  const OptionChecker check("calibration");
  for_each_cost(calibration, [&](const char* key, double value) { check.positive(key, value); });
  for (const BackendCosts& costs : calibration.backends)
    for_each_backend_cost(
        costs, [&](const char* key, double value) { check.positive((costs.name + "." + key).c_str(), value); });
  for (const hlod::DeviceCosts& costs : calibration.devices)
    for_each_device_cost(
        costs, [&](const char* key, double value) { check.at_least((costs.name + "." + key).c_str(), value, 0.0); });
}

Calibration read_calibration(const std::filesystem::path& path) {
  const nlohmann::json json = parse_json_file(path);
  const std::string file = path.string();
  const JsonPlace place(json, file);
  place.expect_keys({"visit_ns", "far_visit_ns", "cone_ns", "split_ns", "kept_split_ns", "triangle_ns", "fragment_ns",
                     "backends", "devices"});
  Calibration calibration;
  for_each_cost(calibration, [&](const char* key, double& value) { value = positive(place.at(key)); });
  for (const JsonPlace& backend : place.at("backends").elements()) {
    calibration.backends.push_back(read_backend(backend));
    expect_new_name(calibration.backends, backend);
  }
  if (const std::optional<JsonPlace> devices = place.find("devices"))
    for (const JsonPlace& device : devices->elements(0)) {
      calibration.devices.push_back(read_device(device));
      expect_new_name(calibration.devices, device);
    }
  return calibration;
}

std::string calibration_json(const Calibration& calibration) {
  Json json;
  for_each_cost(calibration, [&](const char* key, double value) { json[key] = value; });
  json["backends"] = Json::array();
  for (const BackendCosts& costs : calibration.backends) {
    Json backend = {{"name", costs.name}};
    for_each_backend_cost(costs, [&](const char* key, double value) { backend[key] = value; });
    json["backends"].push_back(std::move(backend));
  }
  if (!calibration.devices.empty()) json["devices"] = Json::array();
  for (const hlod::DeviceCosts& costs : calibration.devices) {
    Json device = {{"name", costs.name}, {"latency_commands", costs.latency_commands}};
    hlod::for_each_device_cost(costs, [&](const char* key, double value) { device[key] = value; });
    json["devices"].push_back(std::move(device));
  }
  return json.dump(2) + "\n";
}

void write_calibration(const std::filesystem::path& path, const Calibration& calibration) {
  AtomicFile file(path);
  file.stream() << calibration_json(calibration);
  file.commit();
}

}  // namespace occlod
