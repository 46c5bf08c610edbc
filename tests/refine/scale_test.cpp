// Powers of two are exact to multiply with: at any size the same mesh, seen from the same place, refines to the same
// triangles, bit by bit.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>
#include <memory>

#include "occlod/generate.h"
#include "occlod/visibility.h"
#include "refine/refine_support.h"
#include "refine/tuning.h"

namespace occlod {
namespace {

// A planet and, behind it, another that it hides in part. Coordinates are up to some 3 * 2^power, errors down to some
// 2^(power - 20): between -100 and 100 no number that is stored leaves the normal range of floats, but products of two
// lengths do from 2^-63 and 2^64 on, and squares of areas from 2^-32 and 2^32 on.
class ScaledPlanets {
 public:
  explicit ScaledPlanets(int power) : scale_(std::ldexp(1.0, power)) {
    TriangleMesh mesh = generate("rough-planet", {{"level", 4}});
    for (glm::vec3& p : mesh.positions) p *= static_cast<float>(scale_);
    hierarchy_ = build_hierarchy(mesh);
  }

  // Triangles and errors of frames: refined from scratch, from frame to frame, from scratch in a picture that cuts
  // through the planet, and, where sizes allow, the first two with parallel rays.
  [[nodiscard]] std::vector<std::uint64_t> results(const RefineOptions& options, bool two_sided,
                                                   const std::function<std::unique_ptr<Visibility>()>& make) const {
    glm::dmat4 behind(1.0);
    behind[3] = glm::dvec4(1.2 * scale_, 0.1 * scale_, -3.0 * scale_, 1.0);
    Refiner refiner(std::vector<RefineObject>{{&hierarchy_, glm::dmat4(1.0), two_sided}, {&hierarchy_, behind, false}});
    const std::unique_ptr<Visibility> visibility = make();
    std::vector<std::uint64_t> all;
    const auto note = [&](const Refinement& refinement) {
      all.insert(all.end(), {refinement.hash(), refinement.stats.queries_hidden,
                             std::bit_cast<std::uint64_t>(refinement.stats.max_error_px)});
    };
    note(refiner.refine(view({0.3, 0.4, 4.0}), options, *visibility));
    for (const double x : {0.35, 0.5, 0.8}) note(refiner.update(view({x, 0.4, 4.0}), options, *visibility));
    note(refiner.refine(view({0.3, 0.9, 1.1}), options, *visibility));
    if (reaches_parallel_rays())
      for (const double x : {0.3, 0.35, 0.5}) {
        const View parallel(orthographic(view({x, 0.4, 4.0}).camera()));
        note(x == 0.3 ? refiner.refine(parallel, options, *visibility)
                      : refiner.update(parallel, options, *visibility));
      }
    return all;
  }

  // These come from a point 2^27 times as far away as anything in the picture, see ObjectView::eye().
  [[nodiscard]] bool reaches_parallel_rays() const { return scale_ <= 0x1p90; }

 private:
  [[nodiscard]] View view(const glm::dvec3& eye) const {
    Camera camera = test::front_camera();
    camera.eye = scale_ * eye;
    camera.near *= scale_;
    camera.far *= scale_;
    return View(camera);
  }

  double scale_;
  Hierarchy hierarchy_;
};

TEST(Scale, SameTrianglesAtEveryPowerOfTwo) {
  const std::vector<std::function<std::unique_ptr<Visibility>()>> backends = {
      [] { return std::make_unique<NoOcclusion>(); }, [] { return make_software_occlusion(); }};
  const ScaledPlanets unit(0);
  for (const int power : {-100, -66, -53, -33, -20, 20, 33, 46, 66, 90, 100}) {
    const ScaledPlanets scaled(power);
    for (const Culling culling : {Culling::subtree, Culling::star})
      for (const OccluderMode mode : {OccluderMode::paper, OccluderMode::conservative})
        for (const bool two_sided : {false, true})
          for (std::size_t backend = 0; backend < backends.size(); ++backend) {
            RefineOptions options;
            options.budget = 1500;
            tune(options).culling = culling;
            options.mode = mode;
            auto at_unit = unit.results(options, two_sided, backends[backend]);
            if (!scaled.reaches_parallel_rays()) at_unit.resize(at_unit.size() - 9);  // three frames
            EXPECT_EQ(at_unit, scaled.results(options, two_sided, backends[backend]))
                << "2^" << power << ", " << static_cast<int>(culling) << static_cast<int>(mode) << two_sided << backend;
            if (backend == 1 && mode == OccluderMode::paper) {
              EXPECT_GT(at_unit[1], 0U);  // the one in front hides something
            }
          }
  }
}

}  // namespace
}  // namespace occlod
