// bench_update SCENE.json PATH BUDGET: the processor time of Refiner::update() for each frame of a path, and a hash of
// all meshes, as JSON. bench/python_update.py does the same from Python.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <memory>
#include <vector>

#include "occlod/refiner.h"
#include "occlod/scene.h"
#include "occlod/visibility.h"

namespace {

double processor_ms() { return 1e3 * static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC); }

void run(const std::filesystem::path& file, const std::string& name, std::size_t budget) {
  const occlod::SceneDescription scene = occlod::read_scene(file);
  const std::vector<occlod::LoadedObject> loaded = occlod::load_objects(scene, file.parent_path());
  std::vector<occlod::RefineObject> objects;
  for (const occlod::LoadedObject& object : loaded)
    objects.push_back({object.hierarchy.get(), object.object_to_world, object.two_sided});
  const occlod::CameraPath& path = scene.paths.at(name);
  std::vector<occlod::View> views;
  for (int frame = 0; frame < path.frames; ++frame) views.emplace_back(camera_at(path, frame));

  occlod::Refiner refiner(objects);
  const std::unique_ptr<occlod::Visibility> visibility = occlod::make_software_occlusion();
  occlod::RefineOptions options;
  options.budget = budget;
  std::size_t triangles = 0;
  std::uint64_t hash = 0;
  double ms = 0.0;
  for (const occlod::View& view : views) {
    const double start = processor_ms();
    const occlod::Refinement& refined = refiner.update(view, options, *visibility);
    for (const occlod::RefinedObject& object : refined.objects) triangles += object.triangles.size();
    ms += processor_ms() - start;
    hash = hash * 31 + refined.hash();
  }
  fmt::print("{{\"ms\": {}, \"triangles\": {}, \"hash\": \"{:016x}\"}}\n", ms / path.frames, triangles, hash);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("bench_update SCENE.json PATH BUDGET\n", stderr);
    return 2;
  }
  try {
    run(argv[1], argv[2], std::strtoull(argv[3], nullptr, 10));
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_update: {}\n", error.what());
    return 1;
  }
  return 0;
}
