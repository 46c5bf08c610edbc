// bench_stability: what it costs that no view culls what it sees, no damaged file is used and no occluder hides what is
// seen: each beside what would be done without. Processor time of one thread.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "base/timing.h"
#include "occlod/build_hierarchy.h"
#include "occlod/refiner.h"
#include "occlod/visibility.h"
#include "support/bench_meshes.h"
#include "support/cpu_clock.h"
#include "support/planet_views.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string mesh = "planet:8";
  std::size_t budget = 10'000;
  int repeat = 15;
  fs::path json;  // where the rows go as well
};

struct Node {
  Sphere sphere;
  NormalCone cone;
};

// What the tests would be in the precision of the data, as textbooks have them: nothing gives way to rounding.
class NaiveView {
 public:
  NaiveView(const View& view, const ObjectView& object)
      : planes_(object.planes()),
        eye_(object.eye()),
        focal_length_px_(static_cast<float>(view.focal_length_px())),
        direction_(view.direction()),
        cos_corner_(static_cast<float>(view.cos_corner_angle())) {}

  [[nodiscard]] bool may_be_inside(const Sphere& sphere) const {
    return std::all_of(planes_.begin(), planes_.end(), [&](const glm::vec4& plane) {
      return glm::dot(glm::vec3(plane), sphere.center) + plane.w >= -sphere.radius;
    });
  }
  [[nodiscard]] bool faces_away(const NormalCone& cone, const Sphere& sphere) const {
    if (!cone.culls()) return false;
    const glm::vec3 d = sphere.center - eye_;
    const float along = glm::dot(d, cone.axis);
    const float across = std::sqrt(std::max(glm::dot(d, d) - along * along, 0.0F));
    return along * cone.cos_angle - across * std::sqrt(1.0F - cone.cos_angle * cone.cos_angle) > sphere.radius;
  }
  [[nodiscard]] float largest_scale_px(const Sphere& sphere) const {
    const glm::vec3 d = sphere.center - eye_;
    const float distance = glm::length(d), nearest = distance - sphere.radius;
    if (!(nearest > 0.0F)) return std::numeric_limits<float>::infinity();
    const float cos_center = glm::clamp(glm::dot(d, direction_) / distance, -1.0F, 1.0F);
    const float sin_center = std::sqrt(1.0F - cos_center * cos_center), sin_radius = sphere.radius / distance;
    const float cos_radius = std::sqrt(1.0F - sin_radius * sin_radius);
    const float cos_largest = std::max(cos_corner_, cos_center * cos_radius - sin_center * sin_radius);
    return focal_length_px_ / (nearest * cos_largest * cos_largest);
  }

 private:
  std::array<glm::vec4, 6> planes_;
  glm::vec3 eye_;
  float focal_length_px_;
  glm::vec3 direction_;
  float cos_corner_;
};

struct Row {
  std::string what, with, without;  // ways
  double with_ms = 0.0, without_ms = 0.0;
  std::size_t count = 1;  // times are for so many
  std::string unit;

  // ms, or ns for each of many.
  [[nodiscard]] double in_unit(double ms) const { return count == 1 ? ms : ms * 1e6 / static_cast<double>(count); }
};

// Medians of rounds in which both have their turn. Both return something that depends on all that they have done.
void measure(Row& row, int repeat, const std::function<double()>& with, const std::function<double()>& without) {
  std::vector<double> with_ms, without_ms;
  volatile double kept = 0.0;
  for (int round = 0; round <= repeat; ++round)
    for (const auto& [work, times] : {std::pair(&with, &with_ms), std::pair(&without, &without_ms)}) {
      const double start = thread_cpu_ms();
      kept = kept + (*work)();
      if (round > 0) times->push_back(thread_cpu_ms() - start);
    }
  row.with_ms = median(with_ms);
  row.without_ms = median(without_ms);
}

// Prints rows and keeps them.
class Table {
 public:
  Table() { fmt::print("| what | with | without | unit | costs | ratio |\n|---|---|---|---|---|---|\n"); }

  void add(const Row& row) {
    const double with = row.in_unit(row.with_ms), without = row.in_unit(row.without_ms);
    fmt::print("| {} | {}: {:.3g} | {}: {:.3g} | {} | {:+.3g} | {:.2f} |\n", row.what, row.with, with, row.without,
               without, row.unit, with - without, with / without);
    rows_.push_back({{"what", row.what},
                     {"unit", row.unit},
                     {"with", {{"way", row.with}, {"value", with}}},
                     {"without", {{"way", row.without}, {"value", without}}}});
  }

  void write(const fs::path& path) const {
    AtomicFile file(path);
    file.stream() << rows_.dump(1) << '\n';
    file.commit();
  }

 private:
  nlohmann::ordered_json rows_ = nlohmann::ordered_json::array();
};

std::vector<Node> nodes_of(const Hierarchy& hierarchy) {
  std::vector<Node> nodes;
  for (SplitId s = 0; s < hierarchy.split_count(); ++s)
    nodes.push_back({hierarchy.node(s).sphere, hierarchy.node(s).cone()});
  return nodes;
}

template <typename Verdict>
auto sum_over(const std::vector<Node>& nodes, const Verdict& verdict) {
  return [&nodes, verdict] {
    double sum = 0.0;
    for (const Node& node : nodes) sum += static_cast<double>(verdict(node));
    return sum;
  };
}

void measure_rounding(const Hierarchy& hierarchy, const Options& options, Table& table) {
  const std::vector<Node> nodes = nodes_of(hierarchy);
  for (const NamedCamera& named : planet_views()) {
    const View view(named.camera);
    const ObjectView object(view, glm::dmat4(1.0));
    const NaiveView naive(view, object);
    const auto row = [&](const std::string& what, const auto& with, const auto& without) {
      Row r{what + ", " + std::string(named.name), "double or slack", "single", 0, 0, nodes.size(), "ns a node"};
      measure(r, options.repeat, sum_over(nodes, with), sum_over(nodes, without));
      table.add(r);
    };
    row(
        "frustum", [&](const Node& n) { return object.may_be_inside(n.sphere); },
        [&](const Node& n) { return naive.may_be_inside(n.sphere); });
    row(
        "normal cone", [&](const Node& n) { return faces_away(n.cone, n.sphere, object.eye()); },
        [&](const Node& n) { return naive.faces_away(n.cone, n.sphere); });
    row(
        "largest scale", [&](const Node& n) { return std::min(object.largest_scale_px(n.sphere), 1e9F); },
        [&](const Node& n) { return std::min(naive.largest_scale_px(n.sphere), 1e9F); });
  }
}

// The first look at all of a file that the system has in memory already.
void measure_file(const Hierarchy& hierarchy, const Options& options, Table& table) {
  const fs::path file = fs::temp_directory_path() / "occlod_bench_stability.olod";
  write_olod(file, hierarchy, {});
  Row row{"all blocks of a mapped file", "checked", "only read", 0, 0, 1, "ms"};
  measure(
      row, options.repeat,
      [&] {
        const OlodFile opened = read_olod(file);
        opened.hierarchy.require_all();
        return static_cast<double>(opened.hierarchy.split_count());
      },
      [&] {
        const OlodFile opened = read_olod(file);
        const HierarchyView& view = opened.hierarchy.data();
        double sum = 0.0;
        const auto add = [&](const auto& array) {
          const auto bytes = std::as_bytes(array);
          std::uint64_t words = 0;
          for (std::size_t i = 0; i + 8 <= bytes.size(); i += 8) {
            std::uint64_t word = 0;
            std::memcpy(&word, bytes.data() + i, 8);
            words += word;
          }
          sum += static_cast<double>(words);
        };
        add(view.positions);
        add(view.nodes);
        add(view.stars);
        return sum;
      });
  table.add(row);
  fs::remove(file);
}

void measure_occluder(const Hierarchy& hierarchy, const Options& options, Table& table) {
  Refiner refiner(std::vector<RefineObject>{{&hierarchy, glm::dmat4(1.0), false}});
  const auto occlusion = make_software_occlusion();
  for (const NamedCamera& named : planet_views()) {
    const auto refine = [&](OccluderMode mode) {
      return [&, mode] {
        RefineOptions refine_options;
        refine_options.budget = options.budget;
        refine_options.mode = mode;
        return static_cast<double>(refiner.refine(View(named.camera), refine_options, *occlusion).stats.queries);
      };
    };
    Row row{fmt::format("{} triangles, software occlusion, {}", options.budget, named.name),
            "conservative",
            "paper",
            0,
            0,
            1,
            "ms"};
    measure(row, options.repeat, refine(OccluderMode::conservative), refine(OccluderMode::paper));
    table.add(row);
  }
}

void run(const Options& options) {
  const Hierarchy hierarchy = build_hierarchy(load_bench_mesh(options.mesh));
  Table table;
  measure_rounding(hierarchy, options, table);
  measure_file(hierarchy, options, table);
  measure_occluder(hierarchy, options, table);
  if (!options.json.empty()) table.write(options.json);
}

int run(int argc, char** argv) {
  CLI::App app("What stability costs.", "bench_stability");
  Options options;
  app.add_option("MESH", options.mesh, "A mesh, or planet:LEVEL")->capture_default_str();
  app.add_option("--budget", options.budget, "Triangles")->capture_default_str();
  app.add_option("--json", options.json, "A file for the same rows");
  add_repeat_option(app, options.repeat, "Rounds after the first");
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
