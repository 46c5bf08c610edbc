// What occlusion hides although it is visible, end to end: scenes refined to one pixel with a backend and without any,
// drawn, and compared (accuracy.h).
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <memory>
#include <numbers>

#include "accuracy.h"
#include "drawing.h"
#include "occlod/build_hierarchy.h"
#include "occlod/visibility.h"
#include "oracle/random_view.h"
#include "support/meshes.h"
#ifdef OCCLOD_HAS_GL
#include "occlod/base.h"
#include "occlod/gl.h"
#include "refine/tuning.h"
#endif

namespace occlod::tool {
namespace {

using test::SceneKind;

constexpr int view_count = 20;

// How often the surface winds around the point: 1 inside a closed solid, 0 outside, up to a half beside a sheet. Sum of
// solid angles (van Oosterom & Strackee 1983).
double winding_number(const TriangleMesh& mesh, const glm::dvec3& point) {
  double sum = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const glm::dvec3 a = glm::normalize(glm::dvec3(mesh.positions[t.x]) - point),
                     b = glm::normalize(glm::dvec3(mesh.positions[t.y]) - point),
                     c = glm::normalize(glm::dvec3(mesh.positions[t.z]) - point);
    sum += 2.0 * std::atan2(glm::dot(a, glm::cross(b, c)), 1.0 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
  }
  return sum / (4.0 * std::numbers::pi);
}

// Nobody stands inside a solid, where there is nothing but its back faces.
Camera random_camera_outside(const TriangleMesh& mesh, test::RandomShapes& random) {
  for (;;) {
    Camera camera = test::random_camera(mesh, random);
    camera.width = 320;
    camera.height = 240;
    if (std::abs(winding_number(mesh, camera.eye)) < 0.5) return camera;
  }
}

LoadedObject loaded(const TriangleMesh& mesh, std::size_t base_triangles = BuildOptions().base_triangles) {
  BuildOptions options;
  options.base_triangles = base_triangles;
  return {std::make_shared<Hierarchy>(build_hierarchy(mesh, options)), glm::dmat4(1.0), false, ""};
}

// Coarse first occluders: the coarser, the farther they bulge.
RefineOptions options_of(OccluderMode mode) {
  RefineOptions options;
  options.mode = mode;
  tune(options).occluder_splits = {30, 300};
  return options;
}

// Of one refinement to a pixel: something was hidden, so that something could have been hidden wrongly.
std::size_t count_hidden(const std::vector<LoadedObject>& objects, const View& view, RefineOptions options,
                         Visibility& visibility) {
  Refiner refiner(refine_objects(objects));
  options.budget = refiner.full_triangles();
  options.tolerance_px = 1.0;
  return refiner.refine(view, options, visibility).stats.queries_hidden;
}

std::size_t count_wrong(const std::vector<LoadedObject>& objects, const View& view, const RefineOptions& options,
                        Visibility& visibility) {
  WronglyHidden wrongly_hidden(objects);
  wrongly_hidden.set_view(view, options);
  return wrongly_hidden.count(options, visibility);
}

// Conservative occluders promise that what they hide the input hides: not one pixel of any view may show it.
void expect_nothing_wrongly_hidden(SceneKind kind, Visibility& visibility) {
  const TriangleMesh mesh = test::scene_mesh(kind);
  const std::vector<LoadedObject> objects = {loaded(mesh)};
  const RefineOptions options = options_of(OccluderMode::conservative);
  test::RandomShapes random(23);
  std::size_t hidden = 0;
  for (int v = 0; v < view_count; ++v) {
    const View view(random_camera_outside(mesh, random));
    EXPECT_EQ(count_wrong(objects, view, options, visibility), 0U) << "view " << v;
    hidden += count_hidden(objects, view, options, visibility);
  }
  EXPECT_GT(hidden, 20U);
}

class ConservativeMode : public testing::TestWithParam<SceneKind> {};
INSTANTIATE_TEST_SUITE_P(Scenes, ConservativeMode,
                         testing::Values(SceneKind::planet, SceneKind::pipes, SceneKind::city,
                                         SceneKind::spheres_behind_wall),
                         [](const auto& param) { return test::label(param.param); });

TEST_P(ConservativeMode, HidesNothingWronglyBySoftware) {
  expect_nothing_wrongly_hidden(GetParam(), *make_software_occlusion());
}

#ifdef OCCLOD_HAS_GL
TEST_P(ConservativeMode, HidesNothingWronglyByQueries) {
  std::unique_ptr<Visibility> queries;
  try {
    queries = gl::make_query_occlusion(gl::create_any_context());
  } catch (const Error& error) {
    GTEST_SKIP() << "no OpenGL context: " << error.what();
  }
  expect_nothing_wrongly_hidden(GetParam(), *queries);
}
#endif

// Keeps the first occluder of each view, the coarsest, where a better one would take back what it hid.
class FirstOccluderOnly final : public Visibility {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "first occluder only"; }
  void begin_view(const View& view, std::span<const ObjectView> objects) override {
    is_drawn_ = false;
    software_->begin_view(view, objects);
  }
  void draw_occluder(std::span<const OccluderPart> parts) override {
    if (!is_drawn_) software_->draw_occluder(parts);
    is_drawn_ = true;
  }
  void submit(const VisibilityQuery& query) override { software_->submit(query); }
  [[nodiscard]] std::uint32_t collect() override { return software_->collect(); }

 private:
  std::unique_ptr<Visibility> software_ = make_software_occlusion();
  bool is_drawn_ = false;
};

// A square sheet with a flat-bottomed pit, 0.3 deep and 0.9 wide, and a ball of radius 0.04 in it, near the left wall.
TriangleMesh ball_in_a_pit() {
  TriangleMesh mesh = test::grid(40, 40);
  for (glm::vec3& p : mesh.positions) {
    const float r = glm::length(glm::vec2(p) - 0.5F) / 0.45F;
    if (r < 1.0F) p.z = -0.3F * (1.0F - std::pow(r, 8.0F));
  }
  TriangleMesh ball = test::octahedron_sphere(3);
  for (glm::vec3& p : ball.positions) p *= 0.04F;
  test::append(mesh, ball, {0.22F, 0.5F, -0.22F});
  return mesh;
}

// The measure counts what it is meant to count. The only occluder is the base mesh: four triangles from the sheet's
// corners to a point of the pit's floor, without the ball. In the ball's place they are at most 0.1 deep, so that it is
// 0.08 behind them; in paper mode it never comes back. Its disc at depth 2.22 has a radius of
// 0.04 / 2.22 * 240 / (2 tan 22.5 degrees) = 5.2 pixels, an area of 86. In conservative mode what hides is
// behind where they have come from by the depth of the pit at least, so behind the ball.
TEST(WronglyHiddenMeasure, CountsWhatACoarseOccluderHidesInPaperModeOnly) {
  const std::vector<LoadedObject> objects = {loaded(ball_in_a_pit(), 4)};
  Camera camera;
  camera.eye = {0.5, 0.5, 2.0};
  camera.target = {0.5, 0.5, 0.0};
  camera.width = 320;
  camera.height = 240;
  const View view(camera);
  FirstOccluderOnly first;
  RefineOptions options;
  tune(options).occluder_splits = {0};
  const std::size_t wrong = count_wrong(objects, view, options, first);
  EXPECT_GT(wrong, 60U);
  EXPECT_LT(wrong, 110U);
  options.mode = OccluderMode::conservative;
  EXPECT_EQ(count_wrong(objects, view, options, first), 0U);
}

}  // namespace
}  // namespace occlod::tool
