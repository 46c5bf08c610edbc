// Pairs of pictures as in figures 2 to 7 of Birkholz & Rahn.
#include <algorithm>
#include <cstddef>

#include "occlod/picture/picture.h"
#include "visibility/subjects.h"

namespace occlod::bench {
namespace {

constexpr int gap_px = 8;

// Two pictures of one size, white between them.
Image beside(const Image& left, const Image& right) {
  Image image{left.width + gap_px + right.width, left.height, {}};
  const auto width = static_cast<std::size_t>(image.width);
  image.pixels.assign(width * static_cast<std::size_t>(image.height), glm::u8vec4(255));
  for (int y = 0; y < image.height; ++y) {
    const auto target = image.pixels.begin() + std::ptrdiff_t{y} * image.width;
    std::copy_n(left.pixels.begin() + std::ptrdiff_t{y} * left.width, left.width, target);
    std::copy_n(right.pixels.begin() + std::ptrdiff_t{y} * right.width, right.width, target + left.width + gap_px);
  }
  return image;
}

struct Pictures {
  Image view;
  Image birdseye;
};

Pictures draw(const SceneRun& run, const tool::Measurement& measurement) {
  const auto objects = measurement.objects();
  return {shade(measurement.items(), objects, run.view),
          birdseye(objects, measurement.items(), run.view, View(birdseye_camera(objects, run.view)))};
}

}  // namespace

void write_pictures(SceneRun& run, const VisibilityOptions& options) {
  if (options.out.empty() || !run.is_decided_by(options.table_budget)) return;
  (void)measure_share(run, run.without, refine_options(options.table_budget, Culling::subtree), run.none);
  (void)measure_share(run, run.with, refine_options(options.table_budget, Culling::star), *run.software);
  const Pictures papers = draw(run, run.without), ours = draw(run, run.with);
  write_png(options.out / (run.description.name + "_view.png"), beside(papers.view, ours.view));
  write_png(options.out / (run.description.name + "_birdseye.png"), beside(papers.birdseye, ours.birdseye));
}

}  // namespace occlod::bench
