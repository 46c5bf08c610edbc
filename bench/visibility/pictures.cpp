// Pairs of pictures as in figures 2 to 7 of Birkholz & Rahn.
#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>
#include <span>

#include "drawing.h"
#include "occlod/picture.h"
#include "refine/tuning.h"
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

bool is_roofed(std::span<const DrawObject> objects, const Camera& camera) {
  Camera upwards = camera;
  upwards.target = camera.eye + glm::normalize(camera.up);
  upwards.up = View(camera).direction();
  upwards.fov_y_deg = 1.0;
  upwards.width = upwards.height = 1;
  ItemBuffer items;
  draw_items(items, objects, View(upwards));
  return items.items[0] != no_item;
}

constexpr double share_above_eye = 0.15;  // of what is higher than an eye under a roof: what is left of it

// From above; a roof over the eye is cut off, with most of what is higher than the eye.
View above(std::span<const DrawObject> objects, const View& view) {
  Camera camera = birdseye_camera(objects, view);
  if (is_roofed(objects, view.camera())) {
    const double to_eye = glm::dot(camera.eye - view.camera().eye, glm::normalize(view.camera().up));
    const double to_top = 2.0 * camera.near;  // as birdseye_camera() places the near plane
    camera.near = to_eye + share_above_eye * (to_top - to_eye);
  }
  return View(camera);
}

Pictures draw(const SceneRun& run, const tool::Measurement& measurement) {
  const auto objects = measurement.objects();
  return {shade(measurement.items(), objects, run.view),
          birdseye(objects, measurement.items(), run.view, above(objects, run.view))};
}

}  // namespace

void write_pictures(SceneRun& run, const VisibilityOptions& options, Culling with) {
  if (options.out.empty() || !run.is_decided_by(options.table_budget)) return;
  (void)measure_share(run.without, run.view, refine_options(options.table_budget, Culling::subtree), run.none);
  (void)measure_share(run.with, run.view, refine_options(options.table_budget, with), *run.software);
  const Pictures papers = draw(run, run.without), ours = draw(run, run.with);
  write_png(options.out / (run.description.name + "_view.png"), beside(papers.view, ours.view));
  write_png(options.out / (run.description.name + "_birdseye.png"), beside(papers.birdseye, ours.birdseye));
}

}  // namespace occlod::bench
