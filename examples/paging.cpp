// Builds an HLOD from triangles that are never in memory as a whole, and draws it within a fixed number of bytes:
// meshes of nodes come from the file while the camera moves. Writes paging.ohlod and paging.png.
#include <algorithm>
#include <cmath>
#include <exception>
#include <iostream>

#include "occlod/build_hlod.h"
#include "occlod/node_store.h"
#include "occlod/occlod.h"
#include "occlod/picture.h"
#include "occlod/traverser.h"

namespace hlod = occlod::hlod;
namespace {

// Builds within 256 MiB of main memory; arrays that do not fit go to files in the working directory. stream_scene()
// makes such a source from files; here a generator gives a city of 790,784 triangles in pieces.
void build(const std::filesystem::path& path) {
  const occlod::MemoryLimit limit(std::size_t{256} << 20U, ".");
  const hlod::TriangleSource source = [](hlod::TriangleSink& sink) {
    occlod::stream_generated("city", {}, [&](const occlod::TriangleMesh& part, std::size_t) { sink.add(part); });
  };
  occlod::MeshReport report;
  const hlod::Hlod built = hlod::build_hlod(source, {}, report);
  occlod::write_ohlod(path, built, report);
  std::cout << report.triangles_read << " triangles built, with up to " << (limit.max_scratch_bytes() >> 20U)
            << " MiB in scratch files\n";
}

}  // namespace

int main() try {
  build("paging.ohlod");
  const hlod::Hlod city = occlod::open_ohlod("paging.ohlod", {.budget_bytes = std::size_t{6} << 20U}).hlod;
  const hlod::PlacedHlod objects[] = {{.hlod = &city}};
  hlod::Traverser traverser(objects);
  hlod::SoftwareDevice device;
  occlod::Camera camera{.target = {900.0, 480.0, 14.0}, .up = {0.0, 0.0, 1.0}, .near = 0.2, .far = 3000.0};
  // Frames never wait for the file: where a mesh is missing, or the budget is too small, something coarser is drawn.
  for (int i = 0; i <= 60; ++i) {
    camera.eye = {125.0 + 3.5 * i, 481.0, 1.7};
    const hlod::Frame& frame = traverser.draw_frame(occlod::View(camera), device, {.tolerance_px = 4.0});
    const hlod::StoreStats stats = city.store()->stats();
    if (i % 20 == 0)
      std::cout << "frame " << i << ": " << frame.stats.drawn_triangles << " triangles, " << stats.resident_nodes
                << " of " << city.node_count() << " nodes in " << (stats.resident_bytes >> 10U) << " KiB, "
                << stats.missing << " missing\n";
  }

  // The last frame, the darker the farther.
  const occlod::DepthBuffer depth = device.depth();
  occlod::Image image{depth.width, depth.height, {}};
  for (const float nearness : depth.nearness)
    image.pixels.emplace_back(glm::vec3(std::clamp(255.0F + 32.0F * std::log(nearness), 0.0F, 255.0F)), 255);
  occlod::write_png("paging.png", image);
} catch (const std::exception& error) {
  std::cerr << "paging: " << error.what() << '\n';
  return 1;
}
