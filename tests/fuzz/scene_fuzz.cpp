// Scene descriptions: whatever the text, it is read, or refused with an Error. Nothing is loaded. Every frame of a path
// that was read has a view.
#include <cstddef>
#include <cstdint>

#include "fuzz/memory_file.h"
#include "occlod/base.h"
#include "occlod/scene.h"
#include "occlod/view.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const occlod::fuzz::MemoryFile file(data, size);
  occlod::SceneDescription scene;
  try {
    scene = occlod::read_scene(file.path());
  } catch (const occlod::Error&) {
    return 0;  // refused
  }
  for (const auto& [name, path] : scene.paths)
    for (const int frame : {0, path.frames / 2, path.frames - 1}) (void)occlod::View(occlod::camera_at(path, frame));
  return 0;
}
