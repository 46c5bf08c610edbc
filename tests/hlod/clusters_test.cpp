// Clusters under the rule by which renderers cut them: whatever the eye and the tolerance, what is drawn is the input's
// surface, whole and without cracks.
#include "occlod/clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "occlod/generate.h"
#include "occlod/mesh_file.h"
#include "splits/surface_distance.h"
#include "support/meshes.h"
#include "support/test_meshes.h"

namespace occlod::hlod {
namespace {

ClusterLod build(const TriangleMesh& mesh, ErrorBound bound = ErrorBound::accumulated, int threads = 2) {
  ClusterOptions options;
  options.error_bound = bound;
  options.threads = threads;
  return build_clusters(mesh, options);
}

// Where an eye is and what it allows.
struct Sight {
  glm::dvec3 eye{0.0};
  double allowed = 0.0;  // error over distance; object units if is_parallel
  bool is_parallel = false;

  [[nodiscard]] bool allows(const Sphere& sphere, float error) const {
    if (error == endless_error) return false;
    return (is_parallel ? static_cast<double>(error) : projected_error(sphere, error, eye, 1.0, 1e-6)) <= allowed;
  }
};

// Returns the clusters that are drawn, by the rule of clusterlod.h.
std::vector<std::uint32_t> drawn(const ClusterLod& lod, const Sight& sight) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t c = 0; c < lod.clusters.size(); ++c) {
    const Cluster& cluster = lod.clusters[c];
    const ClusterGroup& group = lod.groups[cluster.group];
    const bool is_fine_enough =
        cluster.refined == no_id || sight.allows(lod.groups[cluster.refined].sphere, lod.groups[cluster.refined].error);
    if (is_fine_enough && !sight.allows(group.sphere, group.error)) result.push_back(c);
  }
  return result;
}

std::vector<Triangle> triangles_of(const ClusterLod& lod, const std::vector<std::uint32_t>& clusters) {
  std::vector<Triangle> triangles;
  for (const std::uint32_t c : clusters)
    for (std::uint32_t i = 0; i < lod.clusters[c].index_count; i += 3) {
      const std::uint32_t* const at = &lod.indices[lod.clusters[c].first_index + i];
      triangles.emplace_back(at[0], at[1], at[2]);
    }
  return triangles;
}

using Point = std::array<float, 3>;
Point point(const glm::vec3& p) { return {p.x, p.y, p.z}; }

// The directed edges that no reverse cancels, and how often each is there.
using Border = std::map<std::pair<Point, Point>, int>;
Border border_of(const std::vector<glm::vec3>& positions, const std::vector<Triangle>& triangles) {
  Border net;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const Point a = point(positions[t[k]]), b = point(positions[t[(k + 1) % 3]]);
      net[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  std::erase_if(net, [](const auto& edge) { return edge.second == 0; });
  return net;
}

double area_of(const std::vector<glm::vec3>& positions, const std::vector<Triangle>& triangles) {
  double area = 0.0;
  for (const Triangle& t : triangles) {
    const glm::dvec3 a(positions[t.x]), b(positions[t.y]), c(positions[t.z]);
    area += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  return area;
}

std::vector<Sight> sights(const TriangleMesh& mesh, const ClusterLod& lod, std::size_t count) {
  std::mt19937_64 random(7);
  const Box box = bounding_box(mesh.positions);
  const glm::dvec3 low(box.min), size = glm::dvec3(box.max) - low;
  std::vector<float> errors;
  for (const ClusterGroup& group : lod.groups)
    if (group.error < endless_error) errors.push_back(group.error);
  if (errors.empty()) errors = {1.0F};
  std::uniform_real_distribution<double> real(0.0, 1.0);
  std::vector<Sight> result = {{.allowed = -1.0, .is_parallel = true}, {.allowed = 1e30, .is_parallel = true}};
  while (result.size() < count) {
    const double error = errors[random() % errors.size()];
    if (result.size() % 3 == 0) {
      result.push_back({.allowed = error, .is_parallel = true});
      continue;
    }
    const glm::dvec3 eye = low + size * (glm::dvec3(real(random), real(random), real(random)) * 3.0 - 1.0);
    result.push_back({.eye = eye, .allowed = error / (glm::length(size) * std::exp2(4.0 * real(random) - 2.0))});
  }
  return result;
}

// Checks the rule of cutting. A mesh without a border has none in any cut; of others a cut has borders only between
// vertices of the input's border.
void expect_whole_cuts(const TriangleMesh& mesh, const ClusterLod& lod, std::size_t count) {
  const Border of_input = border_of(mesh.positions, mesh.triangles);
  std::set<Point> on_border;
  for (const auto& [edge, times] : of_input) on_border.insert({edge.first, edge.second});
  const double area = area_of(mesh.positions, mesh.triangles);
  for (const Sight& sight : sights(mesh, lod, count)) {
    const std::vector<Triangle> triangles = triangles_of(lod, drawn(lod, sight));
    ASSERT_FALSE(triangles.empty());
    std::size_t cracks = 0;
    for (const auto& [edge, times] : border_of(lod.vertices.positions, triangles))
      if (!on_border.contains(edge.first) || !on_border.contains(edge.second)) ++cracks;
    EXPECT_EQ(cracks, 0U) << "allowed " << sight.allowed;
    EXPECT_LT(area_of(lod.vertices.positions, triangles), 1.05 * area);  // nothing is drawn twice
  }
}

// Checks what each cluster and group says of itself, and that errors and spheres grow from level to level.
void expect_sound(const ClusterLod& lod, std::uint32_t max_triangles) {
  std::vector<std::uint8_t> is_used(lod.indices.size(), 0);
  for (std::uint32_t c = 0; c < lod.clusters.size(); ++c) {
    const Cluster& cluster = lod.clusters[c];
    ASSERT_GT(cluster.index_count, 0U);
    ASSERT_EQ(cluster.index_count % 3, 0U);
    ASSERT_LE(cluster.index_count / 3, max_triangles);
    ASSERT_LE(cluster.first_index + cluster.index_count, lod.indices.size());
    std::set<std::uint32_t> different;
    for (std::uint32_t i = cluster.first_index; i < cluster.first_index + cluster.index_count; ++i) {
      ASSERT_EQ(is_used[i]++, 0);
      ASSERT_LT(lod.indices[i], lod.vertices.positions.size());
      different.insert(lod.indices[i]);
      const glm::dvec3 p(lod.vertices.positions[lod.indices[i]]);
      EXPECT_LE(glm::distance(p, glm::dvec3(cluster.sphere.center)), static_cast<double>(cluster.sphere.radius));
      EXPECT_LE(glm::distance(p, glm::dvec3(lod.groups[cluster.group].sphere.center)),
                static_cast<double>(lod.groups[cluster.group].sphere.radius));
    }
    EXPECT_EQ(cluster.vertex_count, different.size());
    EXPECT_LE(different.size(), 256U);
    const ClusterGroup& group = lod.groups[cluster.group];
    EXPECT_TRUE(c >= group.first_cluster && c < group.first_cluster + group.cluster_count);
    EXPECT_EQ(group.level, cluster.level);
    EXPECT_LE(cluster.error, group.error);
    EXPECT_EQ(cluster.refined == no_id, cluster.level == 0);
    if (cluster.refined == no_id) {
      EXPECT_EQ(cluster.error, 0.0F);
      continue;
    }
    const ClusterGroup& finer = lod.groups[cluster.refined];
    EXPECT_EQ(finer.level + 1, cluster.level);
    EXPECT_EQ(cluster.error, finer.error);
    EXPECT_LE(glm::distance(glm::dvec3(finer.sphere.center), glm::dvec3(group.sphere.center)) +
                  static_cast<double>(finer.sphere.radius),
              static_cast<double>(group.sphere.radius));
  }
  EXPECT_EQ(std::count(is_used.begin(), is_used.end(), 0), 0);
}

std::vector<std::array<Point, 3>> sorted_triangles(const std::vector<glm::vec3>& positions,
                                                   const std::vector<Triangle>& triangles) {
  std::vector<std::array<Point, 3>> result;
  for (const Triangle& t : triangles) {
    std::array<Point, 3> corners = {point(positions[t.x]), point(positions[t.y]), point(positions[t.z])};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    result.push_back(corners);
  }
  std::sort(result.begin(), result.end());
  return result;
}

// With tolerance 0 the input itself is drawn.
void expect_input(const TriangleMesh& mesh, const ClusterLod& lod) {
  const std::vector<Triangle> finest = triangles_of(lod, drawn(lod, {.allowed = -1.0, .is_parallel = true}));
  EXPECT_EQ(sorted_triangles(lod.vertices.positions, finest), sorted_triangles(mesh.positions, mesh.triangles));
}

TEST(Clusters, AnyCutIsTheSurface) {
  const std::vector<std::pair<const char*, TriangleMesh>> meshes = {
      {"single_triangle", occlod::test::single_triangle()},
      {"grid", occlod::test::grid(120, 90)},
      {"moebius", occlod::test::moebius(3000)},
      {"noisy_sphere", occlod::test::noisy_sphere(6, 1)},
      {"torus", occlod::test::torus(200, 60)},
      {"many_tetrahedra", occlod::test::many_tetrahedra(2000)},
      {"book", occlod::test::book(5000)},
      {"city", generate("city", {{"blocks", 2}, {"facade_cells", 8}})}};
  for (const auto& [name, mesh] : meshes) {
    SCOPED_TRACE(name);
    const ClusterLod lod = build(mesh);
    expect_sound(lod, 128);
    expect_input(mesh, lod);
    expect_whole_cuts(mesh, lod, 14);
  }
}

class RealClusters : public ::testing::TestWithParam<const char*> {};

TEST_P(RealClusters, AnyCutIsTheSurface) {
  OCCLOD_FIND_TEST_MESH_OR_SKIP(path, GetParam());
  const TriangleMesh mesh = read_mesh(path).mesh;
  const ClusterLod lod = build(mesh);
  expect_sound(lod, 128);
  expect_input(mesh, lod);
  expect_whole_cuts(mesh, lod, 12);
  // Seams keep more: charts must not slip.
  const double most = mesh.texture_coordinates.empty() ? 2.0 : 2.1;
  EXPECT_LT(static_cast<double>(lod.stored_triangles()), most * static_cast<double>(lod.input_triangles));
}

INSTANTIATE_TEST_SUITE_P(Meshes, RealClusters,
                         ::testing::Values("scans/dragon_vrip_res2.ply", "scans/armadillo_100k.obj",
                                           "scans/bun_zipper.ply", "textured/beast.obj"));

// Loose triangles share no vertices: 85 of them have 255.
TEST(Clusters, KeepToTheirVertices) {
  TriangleMesh mesh;
  for (int i = 0; i < 1000; ++i)
    occlod::test::append(mesh, occlod::test::single_triangle(), glm::vec3(2 * (i % 30), 2 * (i / 30), i % 7));
  const ClusterLod lod = build(mesh);
  expect_sound(lod, 128);
  expect_input(mesh, lod);
}

TEST(Clusters, LevelsHalve) {
  const ClusterLod lod = build(occlod::test::noisy_sphere(6, 1));
  std::map<std::uint32_t, double> triangles;
  for (const Cluster& cluster : lod.clusters) triangles[cluster.level] += cluster.index_count / 3;
  ASSERT_GE(triangles.size(), 6U);
  for (std::uint32_t level = 1; level < triangles.size(); ++level) {
    EXPECT_LT(triangles[level], 0.65 * triangles[level - 1]) << level;
    EXPECT_GT(triangles[level], 0.3 * triangles[level - 1]) << level;
  }
  EXPECT_EQ(lod.clusters.back().group, lod.groups.size() - 1);
  EXPECT_EQ(lod.groups.back().error, endless_error);
  EXPECT_LE(triangles.rbegin()->second, 128.0);  // nothing is left to halve
}

TEST(Clusters, ErrorsAreBoundsWhenMeasured) {
  const std::vector<std::pair<const char*, TriangleMesh>> meshes = {{"noisy_sphere", occlod::test::noisy_sphere(6, 2)},
                                                                    {"torus", occlod::test::torus(150, 60)},
                                                                    {"grid", occlod::test::grid(90, 70)}};
  for (const auto& [name, mesh] : meshes) {
    SCOPED_TRACE(name);
    const ClusterLod lod = build(mesh, ErrorBound::measured);
    const SurfaceView input{mesh.positions, mesh.triangles};
    const SurfaceTree tree(input);
    for (const Cluster& cluster : lod.clusters) {
      const auto id = static_cast<std::uint32_t>(&cluster - lod.clusters.data());
      for (const Triangle& t : triangles_of(lod, {id})) {
        const std::array corners = {glm::dvec3(lod.vertices.positions[t.x]), glm::dvec3(lod.vertices.positions[t.y]),
                                    glm::dvec3(lod.vertices.positions[t.z])};
        const glm::dvec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        for (const glm::dvec3& p : {middle, (corners[0] + corners[1]) / 2.0, (corners[1] + corners[2]) / 2.0})
          EXPECT_LE(std::sqrt(tree.nearest(p, 0.0, no_id).distance2), static_cast<double>(cluster.error) + 1e-6);
      }
    }
    for (const Sight& sight : sights(mesh, lod, 12)) {
      if (!sight.is_parallel || sight.allowed < 0.0) continue;
      const std::vector<std::uint32_t> clusters = drawn(lod, sight);
      float most = 0.0F;
      for (const std::uint32_t c : clusters) most = std::max(most, lod.clusters[c].error);
      const std::vector<Triangle> triangles = triangles_of(lod, clusters);
      const SurfaceView cut{lod.vertices.positions, triangles};
      EXPECT_LE(farthest_vertex(input, SurfaceTree(cut), 1), static_cast<double>(most) + 1e-6);
    }
  }
}

TEST(Clusters, AreTheSameForAnyThreads) {
  const TriangleMesh mesh = occlod::test::noisy_sphere(6, 3);
  const std::filesystem::path folder = ::testing::TempDir();
  const auto bytes = [&](int threads) {
    const std::filesystem::path path = folder / "clusters_threads.glb";
    write_clusters(path, build(mesh, ErrorBound::accumulated, threads));
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string one = bytes(1);
  EXPECT_GT(one.size(), 100'000U);
  EXPECT_TRUE(one == bytes(2));
  EXPECT_TRUE(one == bytes(5));
}

// A GLB file, taken apart as a program without this library does.
struct Glb {
  nlohmann::json json;
  std::string buffer;

  explicit Glb(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(file), {});
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    json = nlohmann::json::parse(bytes.substr(20, length));
    buffer = bytes.substr(28 + length);
  }

  template <typename Value>
  [[nodiscard]] std::vector<Value> view(std::size_t index) const {
    const nlohmann::json& view = json["bufferViews"][index];
    std::vector<Value> values(view["byteLength"].get<std::size_t>() / sizeof(Value));
    std::memcpy(values.data(), buffer.data() + view["byteOffset"].get<std::size_t>(), values.size() * sizeof(Value));
    return values;
  }
};

TEST(ClusterFile, HoldsTheArraysAndTheInput) {
  const TriangleMesh mesh = occlod::test::noisy_sphere(5, 1);
  const ClusterLod lod = build(mesh);
  const std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / "clusters.glb";
  EXPECT_TRUE(write_clusters(path, lod).empty());
  const Glb glb(path);
  const nlohmann::json& extras = glb.json["meshes"][0]["extras"]["clusters"];
  EXPECT_EQ(extras["levels"], lod.clusters.back().level + 1);
  EXPECT_EQ(extras["groupCount"], lod.groups.size());
  EXPECT_EQ(extras["clusterCount"], lod.clusters.size());
  const nlohmann::json& accessor = glb.json["accessors"][extras["indices"].get<std::size_t>()];
  EXPECT_EQ(glb.view<std::uint32_t>(accessor["bufferView"]), lod.indices);
  const auto groups = glb.view<std::array<float, 8>>(extras["groups"]);
  ASSERT_EQ(groups.size(), lod.groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const ClusterGroup& group = lod.groups[g];
    EXPECT_EQ((std::array{groups[g][0], groups[g][1], groups[g][2]}), point(group.sphere.center));
    EXPECT_EQ(groups[g][3], group.sphere.radius);
    EXPECT_EQ(groups[g][4], group.error);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(groups[g][5]), group.first_cluster);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(groups[g][6]), group.cluster_count);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(groups[g][7]), group.level);
  }
  const auto clusters = glb.view<std::array<std::uint32_t, 12>>(extras["clusters"]);
  ASSERT_EQ(clusters.size(), lod.clusters.size());
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    const Cluster& cluster = lod.clusters[c];
    EXPECT_EQ(std::bit_cast<float>(clusters[c][3]), cluster.sphere.radius);
    EXPECT_EQ(std::bit_cast<float>(clusters[c][4]), cluster.error);
    EXPECT_EQ((std::array{clusters[c][5], clusters[c][6], clusters[c][7], clusters[c][8], clusters[c][9],
                          clusters[c][10], clusters[c][11]}),
              (std::array{cluster.first_index, cluster.index_count, cluster.vertex_count, cluster.group,
                          cluster.refined, std::uint32_t{cluster.material}, cluster.level}));
  }
  const TriangleMesh read = read_mesh(path).mesh;
  EXPECT_EQ(sorted_triangles(read.positions, read.triangles), sorted_triangles(mesh.positions, mesh.triangles));
}

TEST(ClusterFile, KeepsMaterialsAndAttributesPacked) {
  OCCLOD_FIND_TEST_MESH_OR_SKIP(path, "textured/beast.obj");
  const TriangleMesh mesh = read_mesh(path).mesh;
  const ClusterLod lod = build(mesh);
  const std::filesystem::path written = std::filesystem::path(::testing::TempDir()) / "packed_clusters.glb";
  for (const bool compresses : {false, true}) {
    try {
      write_clusters(written, lod, {compresses, path.parent_path()});
    } catch (const Error& error) {
      EXPECT_TRUE(compresses && std::string(error.what()).find("without meshoptimizer") != std::string::npos);
      continue;
    }
    const TriangleMesh read = read_mesh(written).mesh;
    EXPECT_EQ(sorted_triangles(read.positions, read.triangles), sorted_triangles(mesh.positions, mesh.triangles));
    EXPECT_EQ(read.texture_coordinates.empty(), mesh.texture_coordinates.empty());
    EXPECT_EQ(read.wedge_count(), mesh.wedge_count());
    EXPECT_EQ(read.materials.size(), mesh.materials.size());
  }
}

TEST(Clusters, RefuseWhatTheyCannotDo) {
  const TriangleMesh mesh = occlod::test::tetrahedron();
  for (const std::uint32_t triangles : {0U, 31U, 257U}) {
    ClusterOptions options;
    options.max_triangles = triangles;
    EXPECT_THROW((void)build_clusters(mesh, options), Error) << triangles;
  }
  EXPECT_THROW((void)build_clusters(TriangleMesh()), Error);
  ClusterOptions options;
  options.progress = [](double) { return false; };
  EXPECT_THROW((void)build_clusters(mesh, options), Error);
}

}  // namespace
}  // namespace occlod::hlod
