// Implements `occlod compare A B`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "commands.h"
#include "global_options.h"
#include "json_output.h"
#include "measure/attribute_distance.h"
#include "measure/surface_distance.h"
#include "occlod/build_hierarchy.h"
#include "occlod/mesh_file.h"
#include "option_values.h"

namespace occlod::tool {
namespace {

using measure::AttributeDifference;
using measure::AttributeDistance;
using measure::OneWayDistance;
using measure::SurfaceDistance;
using measure::TextureSlip;

constexpr std::uint64_t max_samples = 1'000'000'000;  // about an hour

struct Options {
  std::string a;
  std::string b;
  measure::SampleOptions sampling;
  bool json = false;
};

// Reads a mesh, or a hierarchy with all of its splits applied.
TriangleMesh read_surface(const std::filesystem::path& file) {
  if (file.extension() != ".olod") return read_mesh(file).mesh;
  const Hierarchy hierarchy = read_olod(file).hierarchy;
  return cut_mesh(hierarchy, full_cut(hierarchy));
}

Json to_json(double rms, const OneWayDistance& farthest, double percent, const glm::dvec3& origin) {
  return {{"rms", rms},
          {"rms_percent", percent * rms},
          {"max", farthest.max},
          {"max_percent", percent * farthest.max},
          {"max_at", tool::to_json(origin + farthest.max_at)}};
}

Json to_json(const AttributeDifference& difference) { return {{"rms", difference.rms}, {"max", difference.max}}; }

Json to_json(const TextureSlip& slip, double percent, const glm::dvec3& origin) {
  return {{"rms", slip.rms},
          {"rms_percent", percent * slip.rms},
          {"max", slip.max},
          {"max_percent", percent * slip.max},
          {"max_at", tool::to_json(origin + slip.max_at)},
          {"lost", slip.lost},
          {"search_radius", slip.radius}};
}

Json report_of(const Options& options, const SurfaceDistance& distance, const AttributeDistance& attributes,
               double diagonal, const glm::dvec3& origin) {
  const double percent = 100.0 / diagonal;
  Json report = {{"a", options.a},
                 {"b", options.b},
                 {"samples", options.sampling.samples},
                 {"seed", options.sampling.seed},
                 {"diagonal", diagonal}};
  report.update(to_json(distance.rms(), distance.farther(), percent, origin));
  report["a_to_b"] = to_json(distance.a_to_b.rms, distance.a_to_b, percent, origin);
  report["b_to_a"] = to_json(distance.b_to_a.rms, distance.b_to_a, percent, origin);
  if (attributes.texture) report["texture_slip"] = to_json(*attributes.texture, percent, origin);
  if (attributes.normals) report["normals_deg"] = to_json(*attributes.normals);
  if (attributes.colors) report["colors"] = to_json(*attributes.colors);
  return report;
}

void print_row(const std::string& name, const Json& way) {
  const Json& at = way["max_at"];
  fmt::print("{:<7} {:>12.6g} {:>9.4f} {:>12.6g} {:>9.4f}  {:.9g} {:.9g} {:.9g}\n", name, way["rms"].get<double>(),
             way["rms_percent"].get<double>(), way["max"].get<double>(), way["max_percent"].get<double>(),
             at[0].get<double>(), at[1].get<double>(), at[2].get<double>());
}

void print_table(const Json& report) {
  fmt::print("{:<7} {:>12} {:>9} {:>12} {:>9}  {}\n", "", "rms", "rms %", "max", "max %", "max at");
  print_row("a to b", report["a_to_b"]);
  print_row("b to a", report["b_to_a"]);
  print_row("larger", report);
  if (report.contains("texture_slip")) {
    const Json& slip = report["texture_slip"];
    print_row("texture", slip);
    if (const auto lost = slip["lost"].get<std::size_t>(); lost > 0)
      fmt::print("        {} of {} texels are farther than {:.6g}, and count as that\n", lost,
                 report["samples"].get<std::size_t>(), slip["search_radius"].get<double>());
  }
  const auto print_difference = [&](const char* name, const char* key, double scale, const char* unit) {
    if (report.contains(key))
      fmt::print("{:<7} {:>12.6g} {:>9} {:>12.6g}  {}\n", name, scale * report[key]["rms"].get<double>(), "",
                 scale * report[key]["max"].get<double>(), unit);
  };
  print_difference("normals", "normals_deg", 1.0, "degrees");
  print_difference("colors", "colors", 100.0, "% of full brightness");
}

// Measures attributes at A's samples.
AttributeDistance attributes_between(const TriangleMesh& a, const TriangleMesh& b, const Options& options) {
  const bool have_some = (!a.texture_coordinates.empty() && !b.texture_coordinates.empty()) ||
                         (!a.normals.empty() && !b.normals.empty()) || (!a.colors.empty() && !b.colors.empty());
  if (!have_some) return {};
  return measure::attribute_distance(a, b, {.samples = options.sampling.samples, .seed = options.sampling.seed});
}

void run(const Options& options) {
  const TriangleMesh a = read_surface(options.a);
  TriangleMesh b = read_surface(options.b);
  move_origin(b, a.origin);
  const measure::Surface surface_a(a.positions, a.triangles), surface_b(b.positions, b.triangles);
  const SurfaceDistance distance = surface_distance(surface_a, surface_b, options.sampling);
  const Json report = report_of(options, distance, attributes_between(a, b, options), surface_a.diagonal(), a.origin);
  options.json ? print_json(report) : print_table(report);
}

}  // namespace

void add_compare(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("compare", "Measure the distance between two meshes, in both directions");
  command.footer(
      "Distances are in the unit of the meshes, percentages relative to the diagonal of A's bounding box.\n"
      "The RMS is over points spread evenly over the area, the maximum over these points and all vertices.\n"
      "Where both have texture coordinates: how far A's texels are, on B, from where they should be.\n"
      "Where both have normals or colours: how much those differ at the nearest points of B.\n"
      "A program with this command contains parts of CGAL under the GPL.");
  const auto options = std::make_shared<Options>();
  add_file(command, "A", options->a, "A mesh, or an .olod file (its full mesh)")->required();
  add_file(command, "B", options->b, "Another mesh or .olod file")->required();
  add_number(command, "--samples", options->sampling.samples, WholeRange{1, max_samples}, "Points on each surface")
      ->capture_default_str();
  add_number(command, "--seed", options->sampling.seed, WholeRange{}, "Random seed of the points")
      ->capture_default_str();
  command.callback([options, &command] {
    read_global_options(command, {.json = &options->json});
    run(*options);
  });
}

}  // namespace occlod::tool
