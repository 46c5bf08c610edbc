// Draws an HLOD by OpenGL, without a window, and leaves out what OpenGL's occlusion queries find hidden. Writes the
// last frame to opengl.png. Runs on a GPU, or on Mesa's llvmpipe.
#include <exception>
#include <iostream>

#include "occlod/build_hlod.h"
#include "occlod/gl.h"
#include "occlod/occlod.h"
#include "occlod/traverser.h"

namespace hlod = occlod::hlod;

int main() try {
  const std::shared_ptr<occlod::gl::Context> context = occlod::gl::create_any_context();
  std::cout << context->renderer() << ", " << context->platform_name() << '\n';
  const std::unique_ptr<occlod::gl::HlodDevice> device = occlod::gl::make_hlod_device(context);

  const hlod::Hlod city = hlod::build_hlod(occlod::generate("city", {{"blocks", 16}, {"facade_cells", 4}}));
  const hlod::PlacedHlod objects[] = {{.hlod = &city}};
  hlod::Traverser traverser(objects);

  occlod::Camera camera{
      .up = {0.0, 0.0, 1.0}, .fov_y_deg = 60.0, .width = 960, .height = 540, .near = 0.2, .far = 3000.0};
  for (int i = 0; i < 20; ++i) {
    camera.eye = {125.0 + 3.5 * i, 481.0, 1.7};
    camera.target = {900.0, 480.0, 14.0};
    const hlod::Frame& frame =
        traverser.draw_frame(occlod::View(camera), *device, {.strategy = hlod::Strategy::coh, .tolerance_px = 1.0});
    if (i % 5 == 0)
      std::cout << "frame " << i << ": " << frame.stats.drawn_triangles << " triangles, " << frame.stats.queries
                << " queries, " << frame.stats.hidden_nodes << " nodes hidden\n";
  }
  occlod::write_png("opengl.png", device->read_image());
} catch (const std::exception& error) {
  std::cerr << "opengl: " << error.what() << '\n';
  return 1;
}
