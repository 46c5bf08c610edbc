#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "calibration_fields.h"
#include "core/option_checker.h"
#include "io/atomic_file.h"
#include "occlod/effects/calibration.h"
#include "scene/strict_json.h"

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

}  // namespace

void check_calibration(const Calibration& calibration) {
  const OptionChecker check("calibration");
  for_each_cost(calibration, [&](const char* key, double value) { check.positive(key, value); });
  for (const BackendCosts& costs : calibration.backends)
    for_each_backend_cost(
        costs, [&](const char* key, double value) { check.positive((costs.name + "." + key).c_str(), value); });
}

Calibration read_calibration(const std::filesystem::path& path) {
  const nlohmann::json json = parse_json_file(path);
  const std::string file = path.string();
  const JsonPlace place(json, file);
  place.expect_keys(
      {"visit_ns", "far_visit_ns", "cone_ns", "split_ns", "kept_split_ns", "triangle_ns", "fragment_ns", "backends"});
  Calibration calibration;
  for_each_cost(calibration, [&](const char* key, double& value) { value = positive(place.at(key)); });
  for (const JsonPlace& backend : place.at("backends").elements()) {
    calibration.backends.push_back(read_backend(backend));
    for (std::size_t i = 0; i + 1 < calibration.backends.size(); ++i)
      if (calibration.backends[i].name == calibration.backends.back().name)
        backend.at("name").fail("is there twice", "leave one of them out");
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
  return json.dump(2) + "\n";
}

void write_calibration(const std::filesystem::path& path, const Calibration& calibration) {
  AtomicFile file(path);
  file.stream() << calibration_json(calibration);
  file.commit();
}

}  // namespace occlod
