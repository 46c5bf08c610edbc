// The same bytes and the same triangles on every machine: hashes of both are those of expected.txt, for every
// instruction set that this machine has and for several numbers of threads.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <glm/common.hpp>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "hashes/expected_hashes.h"
#include "occlod/build_hierarchy.h"
#include "occlod/build_hlod.h"
#include "occlod/generate.h"
#include "occlod/mesh.h"
#include "occlod/node_store.h"
#include "occlod/refiner.h"
#include "occlod/visibility.h"
#include "raster/every_target.h"
#include "refine/tuning.h"

namespace occlod {
namespace {

// A scene that needs no file, and the way of an eye through it.
struct Scene {
  std::string name;
  TriangleMesh mesh;
  Camera first, last;
  bool two_sided = false;
};

struct Way {
  std::string name;
  bool occlusion;
  RefineOptions options;
};

constexpr int path_frames = 6;

Camera camera(glm::dvec3 eye, glm::dvec3 target, glm::dvec3 up, double far) {
  Camera camera;
  camera.eye = eye;
  camera.target = target;
  camera.up = up;
  camera.fov_y_deg = 60.0;
  camera.width = 640;
  camera.height = 480;
  camera.near = far / 4096.0;
  camera.far = far;
  return camera;
}

std::vector<Scene> scenes() {
  const glm::dvec3 y{0.0, 1.0, 0.0}, z{0.0, 0.0, 1.0};
  std::vector<Scene> scenes;
  scenes.push_back({"planet", generate("rough-planet", {{"level", 6}}),
                    camera({0.0, 1.15, 0.1}, {0.0, 0.95, -0.5}, y, 8.0),
                    camera({0.1, 1.1, -0.3}, {0.0, 0.8, -0.9}, y, 8.0)});
  scenes.push_back({"city", generate("city", {{"blocks", 5}, {"facade_cells", 6}}),
                    camera({60.0, 121.0, 1.7}, {250.0, 120.0, 8.0}, z, 1024.0),
                    camera({140.0, 120.0, 40.0}, {250.0, 150.0, 10.0}, z, 1024.0)});
  scenes.push_back({"pipes", generate("pipes", {{"pipes", 32}}), camera({0.5, 0.5, 1.6}, {0.5, 0.5, 0.5}, y, 8.0),
                    camera({1.2, 0.6, 0.9}, {0.4, 0.5, 0.5}, y, 8.0)});
  scenes.push_back({"spheres_behind_wall", generate("spheres-behind-wall", {{"spheres", 32}, {"level", 3}}),
                    camera({3.0, 0.2, 0.1}, {0.0, 0.0, 0.0}, z, 16.0),
                    camera({1.5, 2.0, 0.6}, {-0.5, 0.0, 0.0}, z, 16.0), true});
  return scenes;
}

std::vector<Way> ways() {
  const RefineOptions star{.budget = 4'000};
  RefineOptions subtree = star, conservative = star, steps = star;
  tune(subtree).culling = Culling::subtree;
  tune(subtree).proxy = Proxy::cylinder;
  tune(subtree).final_check = false;
  conservative.mode = OccluderMode::conservative;
  tune(conservative).proxy = Proxy::sphere;
  tune(steps).occluder_splits = {100, 400, 900};
  return {{"star.none", false, star},          {"star.software", true, star},        {"subtree.none", false, subtree},
          {"subtree.software", true, subtree}, {"conservative", true, conservative}, {"steps", true, steps}};
}

std::uint64_t fnv(std::uint64_t hash, std::uint64_t value) { return (hash ^ value) * 0x100000001b3ULL; }

// Of the bytes of the file that write(path) makes.
template <typename Write>
std::uint64_t file_hash(const Write& write) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("occlod_hashes_" + std::to_string(getpid()) + ".olod");
  write(file);
  std::ifstream bytes(file, std::ios::binary);
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (auto byte = std::istreambuf_iterator<char>(bytes); byte != std::istreambuf_iterator<char>(); ++byte)
    hash = fnv(hash, static_cast<unsigned char>(*byte));
  std::filesystem::remove(file);
  return hash;
}

Camera between(const Camera& first, const Camera& last, double share) {
  Camera camera = first;
  camera.eye = glm::mix(first.eye, last.eye, share);
  camera.target = glm::mix(first.target, last.target, share);
  return camera;
}

// Of the triangles of all frames from `first` to `last`.
std::uint64_t path_hash(const Scene& scene, Refiner refiner, const Way& way, Visibility& visibility) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (int frame = 0; frame < path_frames; ++frame) {
    const View view(between(scene.first, scene.last, static_cast<double>(frame) / (path_frames - 1)));
    hash = fnv(hash, refiner.update(view, way.options, visibility).hash());
  }
  return hash;
}

void compare_ways(const Scene& scene, const Hierarchy& hierarchy, test::ExpectedHashes& expected,
                  const std::string& where) {
  const RefineObject objects[] = {{.hierarchy = &hierarchy, .two_sided = scene.two_sided}};
  const std::unique_ptr<Visibility> software = make_software_occlusion();
  NoOcclusion none;
  for (const Way& way : ways()) {
    Visibility& visibility = way.occlusion ? *software : static_cast<Visibility&>(none);
    const auto name = [&](const char* kind) { return scene.name + '.' + way.name + '.' + kind; };
    Refiner refiner(objects);
    expected.compare(name("scratch"), refiner.refine(View(scene.last), way.options, visibility).hash(), where);
    expected.compare(name("orthographic"),
                     refiner.refine(View(orthographic(scene.first)), way.options, visibility).hash(), where);
    expected.compare(name("path"), path_hash(scene, Refiner(objects), way, visibility), where);
  }
}

void compare_hlods(const Scene& scene, const CleanMesh& cleaned, int threads, test::ExpectedHashes& expected) {
  hlod::HlodBuildOptions options;
  options.node_triangles = 300;
  options.threads = threads;
  const auto compare = [&](const char* kind) {
    const hlod::Hlod hlod = build_hlod(cleaned.mesh, options);
    const std::uint64_t hash = file_hash([&](const std::filesystem::path& file) {
      write_ohlod(file, hlod, cleaned.report, {.compression = OlodCompression::none});
    });
    expected.compare(scene.name + kind, hash, std::to_string(threads) + " threads");
  };
  compare(".hlod.shifted");
  options.grouping = hlod::Grouping::nested;
  compare(".hlod.nested.locked");
  options.borders = hlod::Borders::free;
  compare(".hlod.nested.free");
}

TEST(Hashes, AreTheSameEverywhere) {
  test::ExpectedHashes expected(OCCLOD_EXPECTED_HASHES);
  for (const Scene& scene : scenes()) {
    const CleanMesh cleaned = clean(scene.mesh, {}, scene.name);
    for (const int threads : {1, 2, 5}) {
      BuildOptions options;
      options.threads = threads;
      const Hierarchy hierarchy = build_hierarchy(cleaned.mesh, options);
      const std::uint64_t hash =
          file_hash([&](const std::filesystem::path& file) { write_olod(file, hierarchy, cleaned.report); });
      expected.compare(scene.name + ".file", hash, std::to_string(threads) + " threads");
      compare_hlods(scene, cleaned, threads, expected);
    }
    const Hierarchy hierarchy = build_hierarchy(cleaned.mesh);
    test::for_every_target([&](const char* target) { compare_ways(scene, hierarchy, expected, target); });
  }
  expected.finish();
}

// What is hashed is work worth hashing: the budget leaves most of each scene out, and occlusion decides what.
TEST(Hashes, AreOfMeshesThatOcclusionDecides) {
  const RefineOptions options = ways().front().options;
  for (const Scene& scene : scenes()) {
    const Hierarchy hierarchy = build_hierarchy(clean(scene.mesh, {}, scene.name).mesh);
    const RefineObject objects[] = {{.hierarchy = &hierarchy, .two_sided = scene.two_sided}};
    const std::unique_ptr<Visibility> software = make_software_occlusion();
    NoOcclusion none;
    Refiner refiner(objects);
    EXPECT_GT(refiner.full_triangles(), 2 * options.budget) << scene.name;
    const std::uint64_t without = refiner.refine(View(scene.last), options, none).hash();
    EXPECT_NE(refiner.refine(View(scene.last), options, *software).hash(), without) << scene.name;
  }
}

}  // namespace
}  // namespace occlod
