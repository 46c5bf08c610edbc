// Material libraries: whatever the text, its materials have colours that can be shown and textures at finite places, or
// it is refused with an Error of one line.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "base/text.h"
#include "mesh/materials.h"
#include "occlod/base.h"

namespace occlod {
namespace {

void expect(bool holds) {
  if (!holds) std::abort();
}

void read(std::string_view bytes) {
  const FileErrors errors("fuzz");
  std::string converted;
  for (const MtlMaterial& read : parse_mtl(as_utf8(bytes, converted, errors), errors)) {
    for (int k = 0; k < 4; ++k) expect(read.material.base_color[k] >= 0.0F && read.material.base_color[k] <= 1.0F);
    const Surface& surface = read.material.surface;
    for (int k = 0; k < 3; ++k) expect(surface.emissive[k] >= 0.0F && surface.emissive[k] <= 1.0F);
    for (const float value : {surface.metallic, surface.roughness}) expect(value >= 0.0F && value <= 1.0F);
    for (const TextureId id : read.material.textures()) expect(id == no_texture);
    expect(read.material.name.find('\n') == std::string::npos);
    for (const MtlMap* map : {&read.color, &read.normals, &read.emission}) {
      expect(map->texture.file.find('\n') == std::string::npos);
      for (int k = 0; k < 2; ++k)
        expect(std::isfinite(map->placement.scale[k]) && std::isfinite(map->placement.offset[k]));
    }
  }
}

}  // namespace
}  // namespace occlod

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    occlod::read({reinterpret_cast<const char*>(data), size});
  } catch (const occlod::Error& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
  return 0;
}
