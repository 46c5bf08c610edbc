// At tolerance 0 every strategy draws what the input shows, however close the camera: also what has vanished in coarser
// nodes and left no triangle there. Compared with the input itself, drawn without nodes. OCCLOD_SWEEP_HLODS draws that
// many HLODs instead of a few.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <random>
#include <string>

#include "occlod/build_hlod.h"
#include "occlod/device.h"
#include "occlod/item_buffer.h"
#include "occlod/mesh_file.h"
#include "papers/trial_devices.h"
#include "papers/trial_traverser.h"
#include "support/meshes.h"
#include "support/test_meshes.h"
#include "traverse/small_scenes.h"

namespace occlod::hlod {
namespace {

using namespace test;

class Random {
 public:
  explicit Random(std::uint64_t seed) : random_(seed) {}
  double in(double low, double high) { return low + (high - low) * static_cast<double>(random_() >> 11U) * 0x1p-53; }
  int below(int end) { return static_cast<int>(random_() % static_cast<std::uint64_t>(end)); }
  glm::dvec3 point() { return {in(-1.0, 1.0), in(-1.0, 1.0), in(-1.0, 1.0)}; }

 private:
  std::mt19937_64 random_;
};

// Triangles of all sizes, small closed bodies that vanish as a whole, and a sheet with loose corners.
TriangleMesh random_mesh(Random& random) {
  TriangleMesh mesh;
  const int bodies = random.below(60), triangles = random.below(600);
  for (int i = 0; i < bodies; ++i) {
    TriangleMesh body = random.below(2) == 0 ? occlod::test::tetrahedron() : occlod::test::octahedron_sphere(1);
    const auto size = static_cast<float>(std::pow(10.0, random.in(-3.0, -0.5)));
    for (glm::vec3& p : body.positions) p *= size;
    occlod::test::append(mesh, body, glm::vec3(random.point()));
  }
  for (int i = 0; i < triangles; ++i) {
    const double size = std::pow(10.0, random.in(-3.0, 0.0));
    const glm::dvec3 middle = random.point();
    const auto first = static_cast<VertexId>(mesh.positions.size());
    for (int k = 0; k < 3; ++k) mesh.positions.emplace_back(middle + size * random.point());
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  TriangleMesh sheet = occlod::test::grid(4 + random.below(30), 4 + random.below(30));
  for (glm::vec3& p : sheet.positions) p.z = static_cast<float>(random.in(0.0, 0.02));
  occlod::test::append(mesh, sheet, glm::vec3(-0.5F, -0.5F, 0.0F));
  return clean(std::move(mesh), {}, "random mesh").mesh;
}

// Looks at a corner of a triangle, from near by or from among everything.
Camera random_camera(const TriangleMesh& mesh, double extent, Random& random) {
  const Triangle& t = mesh.triangles[static_cast<std::size_t>(random.below(static_cast<int>(mesh.triangle_count())))];
  Camera camera;
  camera.target = glm::dvec3(mesh.positions[t[random.below(3)]]);
  camera.eye = camera.target + extent * std::pow(10.0, random.in(-3.0, 0.0)) * (random.point() + glm::dvec3(0.01));
  camera.up = {0.1, 0.9, 0.3};
  camera.fov_y_deg = random.in(5.0, 70.0);
  if (random.below(3) == 0) camera.principal_point = {random.in(-1.0, 1.0), random.in(-1.0, 1.0)};
  camera.near = 1e-5 * extent;
  camera.far = 10.0 * extent;
  camera.width = camera.height = 96;
  return camera;
}

std::vector<TrialStrategy> strategies() {
  std::vector<TrialStrategy> all{TrialStrategy::vfc};
  all.insert(all.end(), asking_strategies.begin(), asking_strategies.end());
  all.insert(all.end(), later_strategies.begin(), later_strategies.end());
  return all;
}

// Draws the input in random views and counts pixels in which a strategy shows less, or something farther.
class Sweep {
 public:
  explicit Sweep(const TriangleMesh& mesh) : mesh_(mesh) {
    const Box box = bounding_box(mesh.positions);
    extent_ = glm::length(glm::dvec3(box.max) - glm::dvec3(box.min));
  }

  void run(const HlodBuildOptions& options, int views, Random& random) {
    const Hlod hlod = build_hlod(mesh_, options);
    ASSERT_EQ(validate(hlod, 1), std::vector<std::string>());
    const PlacedHlod placed{&hlod, glm::dmat4(1.0), true};
    const std::vector<TrialStrategy> tested = strategies();
    std::vector<TrialTraverser> traversers;
    for (std::size_t i = 0; i < tested.size(); ++i) traversers.emplace_back(std::span(&placed, 1));
    for (int i = 0; i < views; ++i) {
      const View view(random_camera(mesh_, extent_, random));
      DepthBuffer input;
      input.reset(view.width(), view.height());
      draw_depth(input, mesh_.positions, mesh_.triangles, glm::mat4(view.world_to_clip()));
      for (std::size_t s = 0; s < traversers.size(); ++s) {
        TrialOptions trial;
        trial.strategy = tested[s];
        trial.tolerance_px = 0.0;
        trial.biased = false;
        trial.oracle = &oracle_;
        trial.costs = device_preset("query-dear");
        traversers[s].draw_frame(view, device_, trial);
        const std::vector<float> drawn = device_.depth().nearness;
        std::size_t lost = 0;
        for (std::size_t p = 0; p < drawn.size(); ++p) lost += drawn[p] < input.nearness[p] ? 1U : 0U;
        EXPECT_EQ(lost, 0U) << "strategy " << static_cast<int>(trial.strategy) << ", view " << i << ", "
                            << options.node_triangles << " triangles a node";
        ++frames;
      }
    }
  }

  std::size_t frames = 0;

 private:
  const TriangleMesh& mesh_;
  double extent_ = 1.0;
  SoftwareDevice device_, oracle_;
};

HlodBuildOptions random_options(Random& random, int max_node_triangles) {
  HlodBuildOptions options;
  options.node_triangles = static_cast<std::uint32_t>(16 + random.below(max_node_triangles - 15));
  if (random.below(2) == 0) options.grouping = Grouping::nested;
  if (options.grouping == Grouping::nested && random.below(2) == 0) options.borders = Borders::free;
  return options;
}

int hlod_count() {
  const char* const wanted = std::getenv("OCCLOD_SWEEP_HLODS");
  return wanted == nullptr ? 60 : std::atoi(wanted);
}

TEST(InputIsDrawn, OfRandomMeshes) {
  std::size_t frames = 0;
  for (int i = 0; i < hlod_count(); ++i) {
    Random random(static_cast<std::uint64_t>(i));
    const TriangleMesh mesh = random_mesh(random);
    Sweep sweep(mesh);
    sweep.run(random_options(random, 400), 12, random);
    frames += sweep.frames;
  }
  RecordProperty("frames", static_cast<int>(frames));
}

// Its rooms have many small parts, of which a level of 64 triangles a node loses hundreds.
TEST(InputIsDrawn, OfAHospital) {
  OCCLOD_FIND_TEST_MESH_OR_SKIP(path, "scenes/hospital_electrical.ply");
  const TriangleMesh mesh = read_mesh(path).mesh;
  Sweep sweep(mesh);
  for (int i = 0; i < std::max(2, hlod_count() / 10); ++i) {
    Random random(static_cast<std::uint64_t>(1000 + i));
    HlodBuildOptions options = random_options(random, 500);
    if (i < 2) options.node_triangles = 64;
    sweep.run(options, 12, random);
  }
}

}  // namespace
}  // namespace occlod::hlod
