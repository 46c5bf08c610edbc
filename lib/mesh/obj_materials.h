// The materials of an OBJ file: usemtl lines and the files that mtllib lines name.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/file_input.h"
#include "mesh/material_table.h"
#include "mesh/parse_mtl.h"
#include "mesh/polygon_soup.h"
#include "base/text_cursor.h"

namespace occlod {

// Fills the materials and textures of a soup, in the order of their names on usemtl lines. The soup outlives
// it.
class ObjMaterials {
 public:
  explicit ObjMaterials(SoupTables& soup) : soup_(soup), table_(soup) {}

  // Of the polygons from here on. Those before the first have a material without a name: true for the first where there
  // are some.
  [[nodiscard]] bool use(std::string_view name, bool has_polygons, const TextCursor& cursor);
  // What follows mtllib: a name, or several between blanks.
  void add_library(std::string_view names) { libraries_.emplace_back(names); }
  // Whether polygons have materials, and that of the next one.
  [[nodiscard]] bool any() const { return !soup_.materials.empty(); }
  [[nodiscard]] MaterialId current() const { return current_; }
  // Looks up the materials. One that no library has keeps its name and counts as left out. Throws Error that names the
  // library for one that cannot be read, but not for one that does not exist.
  void read_libraries(const FileErrors& errors);
  // Of the textures, by material; after read_libraries().
  [[nodiscard]] std::span<const MapPlacement> placements() const { return placements_; }

 private:
  void read_library(const std::filesystem::path& path, const std::filesystem::path& folder);

  SoupTables& soup_;
  MaterialTable table_;
  MaterialId current_ = 0;
  std::vector<std::string> libraries_;
  std::vector<bool> is_defined_;          // by material
  std::vector<MapPlacement> placements_;  // likewise
};

}  // namespace occlod
