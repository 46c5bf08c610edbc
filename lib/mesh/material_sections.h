// The materials of .olod and .ohlod files.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "occlod/mesh/triangle_mesh.h"
#include "mesh/section_file.h"

namespace occlod::sections {

struct Materials {
  std::vector<Material> materials;
  std::vector<Texture> textures;
  TextureOrigin origin = TextureOrigin::bottom_left;
};

// As JSON text, and the bytes of embedded images, one after the other. Stays where it is while a SectionWriter has it.
class MaterialSections {
 public:
  // `view`: HierarchyView or HlodView.
  template <typename View>
  void add(const View& view, SectionWriter& writer) {
    pack(view.materials, view.textures, view.texture_origin);
    add_to(writer);
  }

 private:
  void pack(std::span<const Material> materials, std::span<const Texture> textures, TextureOrigin origin);
  void add_to(SectionWriter& writer) const;

  std::string text_;
  std::vector<std::uint8_t> images_;
};

// Nothing but the defaults when the file has no such sections. Refuses what MaterialSections does not write.
[[nodiscard]] Materials read_materials(SectionReader& reader);

}  // namespace occlod::sections
