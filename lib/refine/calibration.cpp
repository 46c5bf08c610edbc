#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "base/file_input.h"
#include "base/option_checker.h"
#include "base/strict_json.h"
#include "base/timing.h"
#include "occlod/auto_refiner.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "occlod/item_buffer.h"
#include "occlod/refiner.h"
#include "raster/clip.h"
#include "raster/device_cost_fields.h"
#include "refine/star_visibility.h"
#include "refine/tuning.h"
#include "refine/weigh.h"

namespace occlod {
namespace {

// Calls visit(key, value) for each number. `Costs` may be const.
template <typename Costs, typename Visit>
void for_each_backend_cost(Costs& costs, const Visit& visit) {
  visit("occluder_triangle_ns", costs.occluder_triangle_ns);
  visit("occluder_fragment_ns", costs.occluder_fragment_ns);
  visit("occluder_pixel_ns", costs.occluder_pixel_ns);
  visit("query_ns", costs.query_ns);
  visit("latency_ns", costs.latency_ns);
}
template <typename Costs, typename Visit>
void for_each_cost(Costs& costs, const Visit& visit) {
  visit("visit_ns", costs.visit_ns);
  visit("far_visit_ns", costs.far_visit_ns);
  visit("cone_ns", costs.cone_ns);
  visit("split_ns", costs.split_ns);
  visit("kept_split_ns", costs.kept_split_ns);
  visit("triangle_ns", costs.triangle_ns);
  visit("fragment_ns", costs.fragment_ns);
}

constexpr std::size_t passes = 5;  // passes over all measurements
constexpr int rounds = 2;          // repetitions of each measurement in a pass
constexpr int image_side = 1024;   // a usual size; smaller images would fit into caches
constexpr double min_ns = 0.01;    // the resolution of the clock

// Returns the shorter time of two rounds, ns: other load on the machine can only make a round longer.
template <typename Work>
double fastest_ns(const Work& work) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < rounds; ++i) {
    const Clock::time_point start = Clock::now();
    work();
    best = std::min(best, 1e6 * milliseconds_since(start));
  }
  return best;
}

double per(double ns, std::size_t count) { return std::max(ns / static_cast<double>(count), min_ns); }

View view_from(double distance) {
  Camera camera;
  camera.eye = {0.0, 0.0, distance};
  camera.width = image_side;
  camera.height = image_side;
  camera.near = 0.001 * distance;
  camera.far = 2.0 * distance;
  return View(camera);
}

// Refinement visits about as many nodes together.
constexpr std::size_t visits_at_once = 64;

// Visits splits many at a time. `stride` is the step from one to the next; each is visited once if it has no common
// divisor with their number.
template <typename Visit>
void visit_all(SplitId splits, SplitId stride, const Visit& visit) {
  std::array<SplitId, visits_at_once> some;
  std::size_t size = 0;
  for (SplitId i = 0, s = 0; i < splits; ++i, s = (s + stride) % splits) {
    some[size++] = s;
    if (size < some.size() && i + 1 < splits) continue;
    visit(std::span<const SplitId>(some.data(), size));
    size = 0;
  }
}

// Returns the time of a visit, ns, in an order that prefetchers cannot predict, after filling the caches with other
// data.
template <typename Visit>
double far_visit_ns(SplitId splits, const Visit& visit) {
  constexpr std::size_t cache_bytes = std::size_t{24} << 20U;
  constexpr SplitId stride = 389;  // prime
  const std::vector<char> other(cache_bytes, 1);
  volatile char sink = 0;
  for (std::size_t i = 0; i < cache_bytes; i += 64) sink = static_cast<char>(sink + other[i]);
  const Clock::time_point start = Clock::now();
  visit_all(splits, stride, visit);
  return per(1e6 * milliseconds_since(start), splits);
}

// Measures on one mesh: from far, where the cost depends on triangles, and from near, where it depends on fragments (O+
// and O- of Guthe et al., sec. 3.2.2).
class Workload {
 public:
  void measure_refinement(Calibration& calibration) const;
  // `calibration` holds the costs of refinement from scratch.
  [[nodiscard]] double kept_split_ns(const Calibration& calibration) const;
  void measure_drawing(Calibration& calibration) const;
  // `calibration` holds the costs of refinement.
  [[nodiscard]] BackendCosts costs_of(Visibility& backend, const Calibration& calibration) const;

 private:
  [[nodiscard]] RefineOptions half_budget() const {
    RefineOptions options;
    options.budget = mesh_.triangle_count() / 2;
    return options;
  }
  [[nodiscard]] double query_ns(Visibility& backend, const Calibration& calibration) const;
  template <typename Draw>
  [[nodiscard]] double one_planet_ns(const Draw& draw, const View& view) const;
  template <typename Draw>
  [[nodiscard]] double fragment_ns(const Draw& draw, double triangle_ns) const;
  [[nodiscard]] std::vector<OccluderPart> planets(std::size_t count) const {
    return std::vector<OccluderPart>(count, {0, mesh_.positions, mesh_.triangles});
  }
  [[nodiscard]] std::vector<OccluderPart> walls(std::size_t count) const {
    return std::vector<OccluderPart>(count, {0, wall_positions_, wall_triangles_});
  }

  TriangleMesh mesh_ = generate("rough-planet", {{"level", 4}});
  Hierarchy hierarchy_ = build_hierarchy(mesh_);
  std::vector<glm::vec3> wall_positions_ = {
      {-9.0F, -9.0F, 0.0F}, {9.0F, -9.0F, 0.0F}, {9.0F, 9.0F, 0.0F}, {-9.0F, 9.0F, 0.0F}};
  std::vector<Triangle> wall_triangles_ = {{0, 1, 2}, {0, 2, 3}};
  View near_ = view_from(3.0);     // the planet is large in it; the wall reaches beyond its edges
  View nearer_ = view_from(2.98);  // the next frame
  View far_ = view_from(20.0);     // its triangles are a few pixels wide
};

void Workload::measure_refinement(Calibration& calibration) const {
  const ObjectView view(near_, glm::dmat4(1.0));
  const auto splits = static_cast<SplitId>(hierarchy_.split_count());
  volatile float sink = 0.0F;  // keeps the compiler from removing the loops
  StarVisibility star;
  std::array<StarView, visits_at_once> stars;
  std::array<float, visits_at_once> scales;
  const auto visit = [&](std::span<const SplitId> some) {
    weigh_splits(hierarchy_, some, view, false, scales);
    star.evaluate(hierarchy_, some, view, false, stars);
    sink = sink + scales[0] + stars[0].visible_share;
  };
  calibration.visit_ns = per(fastest_ns([&] { visit_all(splits, 1, visit); }), splits);
  calibration.far_visit_ns = std::max(calibration.visit_ns, far_visit_ns(splits, visit));
  calibration.cone_ns = per(fastest_ns([&] {
                              for (SplitId s = 0; s < splits; ++s) {
                                const SplitNode& node = hierarchy_.node(s);
                                sink = sink + (faces_away(node.cone(), node.sphere, view.eye()) ? 1.0F : 0.0F);
                              }
                            }),
                            splits);
  const RefineObject objects[] = {{.hierarchy = &hierarchy_}};
  Refiner refiner(objects);
  NoOcclusion none;
  RefineStats stats;
  const double all = fastest_ns([&] { stats = refiner.refine(near_, half_budget(), none).stats; });
  const double visits = static_cast<double>(stats.visits) * calibration.visit_ns;
  calibration.split_ns = std::max(per(all - visits, stats.splits), calibration.visit_ns);
  calibration.kept_split_ns = kept_split_ns(calibration);
}

// Returns the time per kept split of a frame, ns, without visits and changes.
double Workload::kept_split_ns(const Calibration& calibration) const {
  const RefineObject objects[] = {{.hierarchy = &hierarchy_}};
  Refiner refiner(objects);
  NoOcclusion none;
  bool at_near = false;
  const auto next_frame = [&] {
    at_near = !at_near;
    return refiner.update(at_near ? near_ : nearer_, half_budget(), none).stats;
  };
  (void)next_frame();
  RefineStats stats;
  const double all = fastest_ns([&] { stats = next_frame(); });
  const double changes = static_cast<double>(stats.new_splits + stats.merged_splits) * calibration.split_ns;
  return per(all - changes - static_cast<double>(stats.visits) * calibration.visit_ns, stats.splits);
}

// Returns the time that one more planet takes, ns. `draw` draws parts in a view and returns the time, ns; what is done
// once per image cancels.
template <typename Draw>
double Workload::one_planet_ns(const Draw& draw, const View& view) const {
  constexpr std::size_t more = 4;
  return (draw(planets(1 + more), view) - draw(planets(1), view)) / static_cast<double>(more);
}

// Returns the time per fragment, ns: what a near planet takes beyond the cost of its triangles.
template <typename Draw>
double Workload::fragment_ns(const Draw& draw, double triangle_ns) const {
  const ObjectView view(near_, glm::dmat4(1.0));
  const double layers = count_fragments(mesh_.positions, mesh_.triangles, view, true, 1).all.layers;
  const double triangles_ns = triangle_ns * static_cast<double>(mesh_.triangle_count());
  return std::max((one_planet_ns(draw, near_) - triangles_ns) / (layers * image_side * image_side), min_ns);
}

void Workload::measure_drawing(Calibration& calibration) const {
  ItemBuffer items;
  const auto draw = [&](const std::vector<OccluderPart>& parts, const View& view) {
    return fastest_ns([&] {
      items.reset(view.width(), view.height());
      for (const OccluderPart& part : parts)
        draw_items(items, part.positions, part.triangles, glm::mat4(view.world_to_clip()), 0);
    });
  };
  calibration.triangle_ns = per(one_planet_ns(draw, far_), mesh_.triangle_count());
  calibration.fragment_ns = per(draw(walls(1), near_), std::size_t{image_side} * image_side);
}

// Returns the extra time per query, ns, when refinement queries all that it can instead of nothing. The cost of the
// occluder cancels; collecting the queries and keeping the answers are included.
double Workload::query_ns(Visibility& backend, const Calibration& calibration) const {
  constexpr std::uint32_t no_levels = 1U << 30U;  // no forest is this deep
  const RefineObject objects[] = {{.hierarchy = &hierarchy_}};
  Refiner refiner(objects);
  RefineOptions options = half_budget();
  tune(options).occluder_splits = {64};
  tune(options).retest_hidden = false;
  tune(options).final_check = false;
  std::array<double, 2> ns{}, queries{};
  for (const std::size_t asks : {0U, 1U}) {
    tune(options).ask_stars = asks != 0;
    tune(options).level_step = asks != 0 ? 1 : no_levels;
    RefineStats stats;
    const double all = fastest_ns([&] { stats = refiner.refine(near_, options, backend).stats; });
    ns[asks] = all - static_cast<double>(stats.visits) * calibration.visit_ns -
               static_cast<double>(stats.splits) * calibration.split_ns;
    queries[asks] = static_cast<double>(stats.queries);
  }
  return std::max(ns[1] - ns[0], 0.0) / std::max(queries[1] - queries[0], 1.0);
}

BackendCosts Workload::costs_of(Visibility& backend, const Calibration& calibration) const {
  BackendCosts costs;
  costs.name = backend.name();
  const auto draw = [&](const std::vector<OccluderPart>& parts, const View& view) {
    const ObjectView objects[] = {ObjectView(view, glm::dmat4(1.0))};
    backend.begin_view(view, objects);
    return fastest_ns([&] {
      backend.draw_occluder(parts);
      backend.submit({0, Sphere{{}, 0.1F}});
      (void)backend.collect();  // a backend may defer drawing until a query is submitted
    });
  };
  costs.occluder_triangle_ns = per(one_planet_ns(draw, far_), mesh_.triangle_count());
  costs.occluder_fragment_ns = fragment_ns(draw, costs.occluder_triangle_ns);
  const double walls_ns = draw(walls(5), near_), wall_ns = draw(walls(1), near_);
  costs.occluder_pixel_ns = per(wall_ns - (walls_ns - wall_ns) / 4.0, std::size_t{image_side} * image_side);

  (void)draw(planets(1), near_);
  costs.latency_ns = per(fastest_ns([&] {
                           backend.submit({0, hierarchy_.node(0).box()});
                           (void)backend.collect();
                         }),
                         1);
  // This difference of two times is the least certain cost: on the shipped scenes, a query among many takes between
  // half the time of a query that is waited for and all of it.
  costs.query_ns = std::clamp(query_ns(backend, calibration), 0.5 * costs.latency_ns, costs.latency_ns);
  return costs;
}

}  // namespace

// Returns the medians over all passes, also of differences, which other load can make smaller as well as larger.
Calibration measure_calibration(std::span<const std::unique_ptr<Visibility>> backends) {
  const Workload workload;
  std::array<Calibration, passes> found;
  for (Calibration& calibration : found) {
    workload.measure_refinement(calibration);
    workload.measure_drawing(calibration);
    for (const std::unique_ptr<Visibility>& backend : backends)
      calibration.backends.push_back(workload.costs_of(*backend, calibration));
  }
  Calibration result = found.front();
  const auto take_medians = [&](const auto& for_each, const auto& of, auto& costs) {
    std::vector<std::vector<double>> values;
    for (Calibration& calibration : found) {
      std::size_t i = 0;
      for_each(of(calibration), [&](const char*, double value) {
        values.resize(std::max(values.size(), i + 1));
        values[i++].push_back(value);
      });
    }
    std::size_t i = 0;
    for_each(costs, [&](const char*, double& value) { value = median(std::move(values[i++])); });
  };
  take_medians([](auto& costs, const auto& visit) { for_each_cost(costs, visit); },
               [](Calibration& c) -> Calibration& { return c; }, result);
  for (std::size_t b = 0; b < backends.size(); ++b)
    take_medians([](auto& costs, const auto& visit) { for_each_backend_cost(costs, visit); },
                 [b](Calibration& c) -> BackendCosts& { return c.backends[b]; }, result.backends[b]);
  return result;
}

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

// Throws Error when the last element of an array so far has the name of an earlier one.
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
