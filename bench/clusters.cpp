// bench_clusters: clusters beside those of meshoptimizer's clusterlod.h: time to build, triangles stored, and triangles
// drawn at cuts that are as far from the input, measured by the same code.
#include "occlod/clusters.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "measure/surface_distance.h"
#include "occlod/build_hlod.h"
#include "occlod/hlod.h"
#include "peers/raw_clusters.h"
#include "support/bench_meshes.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

struct Options {
  std::vector<std::string> meshes = {"scans/dragon_vrip_res2.ply", "scans/armadillo_100k.obj", "scans/turbineblade.ply",
                                     "scans/bun_zipper.ply"};
  std::string peer;
  std::size_t samples = 100'000;
  std::uint32_t max_triangles = 128;
  int repeat = 5;
  bool measured = false;
  bool nodes = false;
  bool only_time = false;
};

// Processor time, since all run on one thread.
double milliseconds_since(std::clock_t start) {
  return 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

// What both builders give.
struct Subject {
  RawClusters clusters;
  std::vector<glm::vec3> positions;
};

Subject build_ours(const TriangleMesh& mesh, const Options& options) {
  hlod::ClusterOptions build;
  build.max_triangles = options.max_triangles;
  build.threads = 1;
  if (options.measured) build.error_bound = ErrorBound::measured;
  std::vector<double> times;
  hlod::ClusterLod lod;
  for (int round = 0; round < options.repeat; ++round) {
    const std::clock_t start = std::clock();
    lod = hlod::build_clusters(mesh, build);
    times.push_back(milliseconds_since(start));
  }
  std::sort(times.begin(), times.end());
  Subject subject;
  subject.positions = lod.vertices.positions;
  RawClusters& raw = subject.clusters;
  raw.milliseconds = {times[times.size() / 2]};
  for (const hlod::ClusterGroup& group : lod.groups) raw.group_errors.push_back(group.error);
  for (const hlod::Cluster& cluster : lod.clusters) {
    raw.groups.push_back(cluster.group);
    raw.refined.push_back(cluster.refined);
    raw.vertex_counts.push_back(cluster.vertex_count);
    raw.index_counts.push_back(cluster.index_count);
    const auto first = lod.indices.begin() + cluster.first_index;
    raw.indices.insert(raw.indices.end(), first, first + cluster.index_count);
  }
  return subject;
}

// The nodes of an HLOD as clusters: what a parent replaces of a node.
Subject build_nodes(const TriangleMesh& mesh, const Options& options) {
  hlod::HlodBuildOptions build;
  build.node_triangles = options.max_triangles;
  build.threads = 1;
  std::vector<double> times;
  hlod::Hlod nodes;
  for (int round = 0; round < options.repeat; ++round) {
    const std::clock_t start = std::clock();
    nodes = build_hlod(mesh, build);
    times.push_back(milliseconds_since(start));
  }
  std::sort(times.begin(), times.end());
  Subject subject;
  RawClusters& raw = subject.clusters;
  raw.milliseconds = {times[times.size() / 2]};
  for (const hlod::Node& node : nodes.data().nodes) raw.group_errors.push_back(node.error);
  raw.group_errors.push_back(hlod::endless_error);
  for (hlod::NodeId n = 0; n < nodes.node_count(); ++n) {
    const hlod::NodeMesh node = nodes.mesh(n);
    const auto first = static_cast<std::uint32_t>(subject.positions.size());
    subject.positions.insert(subject.positions.end(), node.positions.begin(), node.positions.end());
    for (const hlod::Patch& patch : nodes.patches(n)) {
      raw.groups.push_back(patch.parent == no_id ? static_cast<std::uint32_t>(nodes.node_count()) : patch.parent);
      raw.refined.push_back(nodes.node(n).level == 0 ? no_id : n);
      raw.index_counts.push_back(patch.index_count);
      std::vector<std::uint16_t> used(node.indices.begin() + patch.first_index,
                                      node.indices.begin() + patch.first_index + patch.index_count);
      for (const std::uint16_t i : used) raw.indices.push_back(first + i);
      std::sort(used.begin(), used.end());
      raw.vertex_counts.push_back(static_cast<std::uint32_t>(std::unique(used.begin(), used.end()) - used.begin()));
    }
  }
  return subject;
}

Subject build_theirs(const TriangleMesh& mesh, const Options& options) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path();
  const std::string in = folder / "bench_clusters_mesh.raw", out = folder / "bench_clusters_peer.raw";
  RawMesh raw;
  for (const glm::vec3& p : mesh.positions) raw.positions.insert(raw.positions.end(), {p.x, p.y, p.z});
  for (const Triangle& t : mesh.wedge_triangles()) raw.indices.insert(raw.indices.end(), {t.x, t.y, t.z});
  Subject subject;
  subject.positions = mesh.positions;
  const std::string command =
      fmt::format("{} {} {} {} {}", options.peer, in, out, options.max_triangles, options.repeat);
  if (!write_raw(in, raw) || std::system(command.c_str()) != 0 || !read_raw(out, subject.clusters))
    throw Error({options.peer, "", "failed", "give the program bench_clusterlod"});
  std::filesystem::remove(in);
  std::filesystem::remove(out);
  return subject;
}

// Returns the triangles that are drawn where an error is allowed: the rule of clusterlod.h.
std::vector<Triangle> cut(const RawClusters& clusters, float allowed) {
  std::vector<Triangle> triangles;
  std::size_t first = 0;
  for (std::size_t c = 0; c < clusters.groups.size(); ++c) {
    const std::size_t end = first + clusters.index_counts[c];
    const bool is_fine = clusters.refined[c] == no_id || clusters.group_errors[clusters.refined[c]] <= allowed;
    if (is_fine && clusters.group_errors[clusters.groups[c]] > allowed)
      for (std::size_t i = first; i < end; i += 3)
        triangles.emplace_back(clusters.indices[i], clusters.indices[i + 1], clusters.indices[i + 2]);
    first = end;
  }
  return triangles;
}

struct Point {
  double triangles = 0.0, rms = 0.0, max = 0.0;
};

// Measures cuts from many triangles to few.
std::vector<Point> curve(const measure::Surface& input, const Subject& subject, const Options& options) {
  std::vector<Point> points;
  std::vector<float> errors;
  for (const float error : subject.clusters.group_errors)
    if (error < hlod::endless_error && error > 0.0F) errors.push_back(error);
  if (errors.empty()) return points;
  std::sort(errors.begin(), errors.end());
  const double most = errors.back();
  std::size_t last = 0;
  for (double allowed = errors[errors.size() / 20]; allowed <= 1.3 * most; allowed *= 1.3) {
    const std::vector<Triangle> triangles = cut(subject.clusters, static_cast<float>(allowed));
    if (triangles.size() == last || triangles.empty()) continue;
    last = triangles.size();
    const measure::Surface surface(subject.positions, triangles);
    const measure::SurfaceDistance distance = measure::surface_distance(input, surface, {options.samples, 1});
    points.push_back({static_cast<double>(triangles.size()), distance.rms(), distance.farther().max});
    if (triangles.size() < 500) break;
  }
  return points;
}

// Returns the triangles of the curve at a distance, between its neighbours; none where it does not reach.
std::optional<double> triangles_at(const std::vector<Point>& points, double wanted, double Point::*distance) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Point &a = points[i - 1], &b = points[i];
    if (!(a.*distance <= wanted && wanted <= b.*distance && a.*distance < b.*distance)) continue;
    const double way = std::log(wanted / (a.*distance)) / std::log(b.*distance / (a.*distance));
    return std::exp(std::log(a.triangles) + way * std::log(b.triangles / a.triangles));
  }
  return std::nullopt;
}

std::string ratios(const std::vector<Point>& ours, const std::vector<Point>& theirs, double Point::*distance) {
  std::vector<std::string> texts;
  double sum = 0.0;
  int count = 0;
  for (const Point& point : ours) {
    const std::optional<double> peer = triangles_at(theirs, point.*distance, distance);
    if (!peer) continue;
    texts.push_back(fmt::format("{:.2f}", point.triangles / *peer));
    sum += std::log(point.triangles / *peer);
    ++count;
  }
  return count == 0 ? "-" : fmt::format("{:.3f} ({})", std::exp(sum / count), fmt::join(texts, " "));
}

void print(const std::string& name, const char* builder, const TriangleMesh& mesh, const Subject& subject) {
  const RawClusters& c = subject.clusters;
  double vertices = 0.0;
  for (const std::uint32_t count : c.vertex_counts) vertices += count;
  const double stored = static_cast<double>(c.indices.size() / 3), clusters = static_cast<double>(c.groups.size());
  fmt::print("| {} | {} | {:.0f} | {:.3f} | {} | {} | {:.1f} | {:.1f} |\n", name, builder, c.milliseconds[0],
             stored / static_cast<double>(mesh.triangle_count()), c.group_errors.size(), c.groups.size(),
             stored / clusters, vertices / clusters);
  std::fflush(stdout);
}

void print_rows(const std::string& name, const Options& options) {
  const TriangleMesh mesh = load_bench_mesh(name);
  const Subject ours = build_ours(mesh, options);
  print(name, "ours", mesh, ours);
  std::optional<Subject> nodes;
  if (options.nodes) {
    nodes = build_nodes(mesh, options);
    print(name, "nodes", mesh, *nodes);
  }
  std::optional<Subject> theirs;
  if (!options.peer.empty()) {
    theirs = build_theirs(mesh, options);
    print(name, "clusterlod", mesh, *theirs);
  }
  if (options.only_time) return;
  const measure::Surface input(mesh.positions, mesh.triangles);
  const std::vector<Point> of_ours = curve(input, ours, options);
  for (const Point& p : of_ours)
    fmt::print("ours {} {:.0f} {:.5g} {:.5g}\n", name, p.triangles, p.rms / input.diagonal(), p.max / input.diagonal());
  if (nodes)
    fmt::print("triangles drawn at equal RMS distance, nodes to ours: {}\n",
               ratios(curve(input, *nodes, options), of_ours, &Point::rms));
  if (!theirs) return;
  const std::vector<Point> of_theirs = curve(input, *theirs, options);
  for (const Point& p : of_theirs)
    fmt::print("clusterlod {} {:.0f} {:.5g} {:.5g}\n", name, p.triangles, p.rms / input.diagonal(),
               p.max / input.diagonal());
  fmt::print("triangles drawn at equal RMS distance, ours to clusterlod's: {}\n",
             ratios(of_ours, of_theirs, &Point::rms));
  fmt::print("at equal largest distance: {}\n", ratios(of_ours, of_theirs, &Point::max));
}

void run(const Options& options) {
  fmt::print(
      "| mesh | builder | ms | stored | groups | clusters | triangles | vertices "
      "|\n|---|---|---|---|---|---|---|---|\n");
  for (const std::string& name : available(options.meshes)) print_rows(name, options);
}

int run(int argc, char** argv) {
  CLI::App app("Clusters, beside those of meshoptimizer's clusterlod.h.", "bench_clusters");
  Options options;
  app.add_option("MESHES", options.meshes, "Files in folders of OCCLOD_MESHES, or planet:LEVEL")->capture_default_str();
  app.add_option("--peer", options.peer, "The program bench_clusterlod");
  app.add_option("--clusters", options.max_triangles, "The most triangles of a cluster")->capture_default_str();
  app.add_option("--samples", options.samples, "Points on each surface")->capture_default_str();
  app.add_flag("--measured", options.measured, "Ours by measured errors");
  app.add_flag("--nodes", options.nodes, "Also the nodes of an HLOD, used as clusters");
  app.add_flag("--only-time", options.only_time, "Do not measure cuts");
  add_repeat_option(app, options.repeat, "Builds");
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
