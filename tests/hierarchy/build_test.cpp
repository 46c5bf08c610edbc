#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "hierarchy/hierarchy_bytes.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/mesh.h"
#include "splits/star.h"
#include "support/meshes.h"

namespace occlod {
namespace {

struct NamedMesh {
  const char* name;
  TriangleMesh mesh;
};

std::vector<NamedMesh> all_meshes() {
  return {{"single_triangle", test::single_triangle()},
          {"grid", test::grid(12, 9)},
          {"fan", test::fan(200)},
          {"moebius", test::moebius(20)},
          {"tetrahedron", test::tetrahedron()},
          {"sphere", test::octahedron_sphere(4)},
          {"noisy_sphere", test::noisy_sphere(5, 1)},
          {"torus", test::torus(24, 12)},
          {"double_sided_quad", test::double_sided_quad()},
          {"bow_tie", test::bow_tie()},
          {"book", test::book(5)},
          {"two_components", test::two_components()},
          {"many_tetrahedra", test::many_tetrahedra(40)}};
}

TEST(BuildHierarchy, EveryKindOfMeshBuildsValidatesAndComesBack) {
  for (const std::size_t base : {0U, 4U, 64U}) {
    for (const NamedMesh& input : all_meshes()) {
      SCOPED_TRACE(input.name);
      BuildOptions options;
      options.base_triangles = base;
      const Hierarchy hierarchy = build_hierarchy(input.mesh, options);
      const std::vector<std::string> violations = validate(hierarchy);
      EXPECT_TRUE(violations.empty()) << violations[0];
      EXPECT_TRUE(restores(hierarchy, input.mesh));
      EXPECT_LE(hierarchy.base_triangle_count(), base);  // any mesh can be taken apart down to nothing
      EXPECT_EQ(hierarchy.vertex_count(), input.mesh.vertex_count());
    }
  }
}

// Down to nothing, or to a few triangles for every third seed.
void expect_valid_hierarchy(const TriangleMesh& mesh, unsigned seed) {
  BuildOptions options;
  options.base_triangles = seed % 3 == 0 ? 8 : 0;
  const Hierarchy hierarchy = build_hierarchy(mesh, options);
  const std::vector<std::string> violations = validate(hierarchy);
  ASSERT_TRUE(violations.empty()) << "seed " << seed << ": " << violations[0];
  ASSERT_TRUE(restores(hierarchy, mesh)) << "seed " << seed;
}

// Triangles between random vertices: edges of any degree, faces back to back, faces repeated and turned over, so that
// collapses fold faces onto each other and take whole pieces away in every way there is. Whatever comes, what is
// applied must conform, and all of it must be the input.
TEST(BuildHierarchy, RandomSoupsAreValid) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> coordinate(-1.0F, 1.0F);
    TriangleMesh soup;
    const std::size_t vertices = 6 + random() % 60, triangles = vertices / 2 + random() % (3 * vertices);
    for (std::size_t v = 0; v < vertices; ++v)
      soup.positions.emplace_back(coordinate(random), coordinate(random), coordinate(random));
    while (soup.triangles.size() < triangles) {
      // Near in number, so that triangles often share edges.
      const auto a = static_cast<VertexId>(random() % vertices);
      const auto near = [&] { return static_cast<VertexId>((a + 1 + random() % 4) % vertices); };
      const Triangle t(a, near(), near());
      if (t.x != t.y && t.y != t.z && t.z != t.x) soup.triangles.push_back(t);
    }
    expect_valid_hierarchy(clean(soup, {}, "soup").mesh, seed);
    if (HasFatalFailure()) return;
  }
}

// The same for surfaces that are pinched together where they should not be.
TEST(BuildHierarchy, PinchedSurfacesAreValid) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    TriangleMesh pinched = seed % 2 == 0 ? test::noisy_sphere(3, seed) : test::grid(12, 12);
    const std::size_t vertices = pinched.positions.size();
    std::vector<VertexId> merged(vertices);
    for (VertexId v = 0; v < vertices; ++v)
      merged[v] = random() % 4 == 0 ? static_cast<VertexId>((v + 1 + random() % 30) % vertices) : v;
    for (Triangle& t : pinched.triangles) t = {merged[t.x], merged[t.y], merged[t.z]};
    expect_valid_hierarchy(clean(pinched, {}, "pinched").mesh, seed);
    if (HasFatalFailure()) return;
  }
}

TEST(BuildHierarchy, SameInputGivesTheSameBytes) {
  const TriangleMesh mesh = test::noisy_sphere(4, 3);
  const Hierarchy a = build_hierarchy(mesh);
  const Hierarchy b = build_hierarchy(mesh);
  EXPECT_TRUE(test::same_bytes(a, b));
}

TEST(BuildHierarchy, ThreadsDoNotChangeTheBytes) {
  const TriangleMesh mesh = test::noisy_sphere(7, 3);  // large enough for several blocks in several passes
  BuildOptions options;
  options.threads = 1;
  const Hierarchy one = build_hierarchy(mesh, options);
  EXPECT_TRUE(validate(one).empty());
  for (const int threads : {2, 5}) {
    options.threads = threads;
    const Hierarchy many = build_hierarchy(mesh, options);
    EXPECT_TRUE(test::same_bytes(one, many));
  }
}

TEST(BuildHierarchy, BlocksLeaveNoSeam) {
  // Morton curves are cut by the planes through the middle of their grid. Were that the same plane in every pass,
  // vertices near it could not collapse before the last block and would crowd there. Of a sphere's surface the slab |x|
  // < h holds the share h; the sphere is finer than that nowhere.
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(8, 1));
  const std::size_t coarse = 80'000;  // vertices, long before the last block
  for (int axis = 0; axis < 3; ++axis) {
    const auto in_slab = std::count_if(hierarchy.positions().begin(), hierarchy.positions().begin() + coarse,
                                       [&](const glm::vec3& p) { return std::abs(p[axis]) < 0.02F; });
    EXPECT_LT(static_cast<double>(in_slab), 1.35 * 0.02 * static_cast<double>(coarse));
  }
}

TEST(BuildHierarchy, FlatSurfaceCollapsesWithoutError) {
  // Every collapse inside a flat square, or along its sides, leaves the same square until only its two triangles are
  // left.
  BuildOptions options;
  options.base_triangles = 2;
  const Hierarchy hierarchy = build_hierarchy(test::grid(10, 10), options);
  EXPECT_EQ(hierarchy.base_triangle_count(), 2U);
  EXPECT_LT(hierarchy.error_bound(), 2e-5F);  // what rounding upwards adds over some collapses in a row
  const Box& box = hierarchy.box();
  std::vector<glm::vec3> corners;
  for (const Triangle& t : hierarchy.data().base_faces)
    for (int k = 0; k < 3; ++k) corners.push_back(hierarchy.positions()[t[k]]);
  const Box base_box = bounding_box(corners);
  EXPECT_EQ(base_box.min, box.min);
  EXPECT_EQ(base_box.max, box.max);
}

TEST(BuildHierarchy, ClosedSurfaceStaysClosedAndOfItsGenus) {
  // As long as only legal collapses are needed, V - E + F of a torus is 0; with E = 3F/2, V = F/2.
  BuildOptions options;
  options.base_triangles = 100;
  const Hierarchy hierarchy = build_hierarchy(test::torus(40, 20), options);
  EXPECT_EQ(hierarchy.base_triangle_count(), 100U);
  EXPECT_EQ(hierarchy.base_vertex_count(), 50U);
}

TEST(BuildHierarchy, ComponentThatVanishesHasItsExtentAsError) {
  // Forty tetrahedra, far fewer triangles allowed: whole components go. The split that brings one back removes no face
  // and must not claim a smaller error than what is missing without it.
  BuildOptions options;
  options.base_triangles = 0;
  const Hierarchy hierarchy = build_hierarchy(test::many_tetrahedra(40), options);
  int vanished = 0;
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    const SplitStar star = star_of(hierarchy, s);
    if (star.removed_count() > 0) continue;
    ++vanished;
    std::vector<glm::vec3> corners;
    star.for_each_inserted([&](const Triangle& t) {
      for (int k = 0; k < 3; ++k) corners.push_back(hierarchy.positions()[t[k]]);
    });
    const Box box = bounding_box(corners);
    EXPECT_GE(hierarchy.node(s).guaranteed_error, glm::length(box.max - box.min) / std::sqrt(3.0F));
  }
  EXPECT_EQ(vanished, 40);
}

TEST(BuildHierarchy, AttributesFollowTheirVertices) {
  TriangleMesh mesh = test::octahedron_sphere(3);
  for (const glm::vec3& p : mesh.positions) {
    mesh.normals.push_back(p);
    mesh.colors.emplace_back(glm::u8vec4(glm::vec4(127.0F * p + 128.0F, 255.0F)));
  }
  const Hierarchy hierarchy = build_hierarchy(mesh);
  ASSERT_EQ(hierarchy.data().normals.size(), mesh.vertex_count());
  ASSERT_EQ(hierarchy.data().colors.size(), mesh.vertex_count());
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const glm::vec3& p = hierarchy.positions()[v];
    EXPECT_EQ(hierarchy.data().normals[v], p);
    EXPECT_EQ(hierarchy.data().colors[v], glm::u8vec4(glm::vec4(127.0F * p + 128.0F, 255.0F)));
  }
}

TEST(Build, RefusesOptionsOutOfRange) {
  struct Row {
    const char* field;
    BuildOptions options;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const Row& row : {Row{"boundary_weight", {.boundary_weight = nan}},
                         {"boundary_weight", {.boundary_weight = infinite}},
                         {"boundary_weight", {.boundary_weight = -1.0}},
                         {"boundary_weight", {.boundary_weight = 1.1e6}},
                         {"threads", {.threads = -1}},
                         {"threads", {.threads = 1025}}}) {
    try {
      (void)build_hierarchy(test::tetrahedron(), row.options);
      ADD_FAILURE() << row.field << " is accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.diagnosis().place, std::string("option ") + row.field);
    }
  }
}

TEST(BuildHierarchy, RefusesWhatCannotBeBuilt) {
  EXPECT_THROW((void)build_hierarchy(TriangleMesh{}), Error);
  TriangleMesh nan = test::tetrahedron();
  nan.positions[2].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW((void)build_hierarchy(nan), Error);
  TriangleMesh out_of_range = test::tetrahedron();
  out_of_range.triangles[1].z = 4;
  EXPECT_THROW((void)build_hierarchy(out_of_range), Error);
  TriangleMesh repeated = test::tetrahedron();
  repeated.triangles[1].z = repeated.triangles[1].x;
  EXPECT_THROW((void)build_hierarchy(repeated), Error);
}

// From the thread that builds, ascending shares, and often: a third of the build never passes without a call.
TEST(BuildHierarchy, TellsItsProgress) {
  for (const int threads : {1, 3}) {
    BuildOptions options;
    options.threads = threads;
    std::vector<double> shares;
    const std::thread::id caller = std::this_thread::get_id();
    options.progress = [&](double done) {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      shares.push_back(done);
      return true;
    };
    (void)build_hierarchy(test::noisy_sphere(8, 1), options);
    ASSERT_GE(shares.size(), 4U);
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
    EXPECT_GE(shares.front(), 0.0);
    EXPECT_EQ(shares.back(), 1.0);
    // With several threads the system may let the caller rest while the others work.
    for (std::size_t i = 1; threads == 1 && i < shares.size(); ++i) EXPECT_LT(shares[i] - shares[i - 1], 1.0 / 3);
  }
}

// Wherever it is cancelled, by an answer or by an exception, the build ends with all its threads: nothing calls later.
TEST(BuildHierarchy, CancelsWhenProgressSaysSo) {
  const TriangleMesh mesh = test::noisy_sphere(7, 1);
  for (const int threads : {1, 3})
    for (const double limit : {0.0, 0.2, 0.5}) {
      BuildOptions options;
      options.threads = threads;
      int calls_after = 0;
      bool cancelled = false;
      options.progress = [&](double done) {
        calls_after += cancelled ? 1 : 0;
        cancelled = done >= limit;
        return !cancelled;
      };
      EXPECT_THROW((void)build_hierarchy(mesh, options), Error);
      EXPECT_TRUE(cancelled);
      EXPECT_EQ(calls_after, 0);
      options.progress = [](double) -> bool { throw std::domain_error("stop"); };
      EXPECT_THROW((void)build_hierarchy(mesh, options), std::domain_error);
    }
}

}  // namespace
}  // namespace occlod
