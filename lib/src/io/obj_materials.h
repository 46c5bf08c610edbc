// The materials of an OBJ file: usemtl lines and the files that mtllib lines name.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "io/file_input.h"
#include "io/material_table.h"
#include "io/polygon_soup.h"
#include "io/text_cursor.h"

namespace occlod {

// Fills the materials and textures of a soup, in the order of their names on usemtl lines. The soup and the views given
// outlive it.
class ObjMaterials {
 public:
  explicit ObjMaterials(PolygonSoup& soup) : soup_(soup), table_(soup) {}

  // Of the polygons from here on. Those before the first have a material without a name.
  void use(std::string_view name, const TextCursor& cursor);
  // What follows mtllib: a name, or several between blanks.
  void add_library(std::string_view names) { libraries_.push_back(names); }
  // After each polygon.
  void end_polygon() {
    if (!soup_.materials.empty()) soup_.polygon_materials.push_back(current_);
  }
  // Looks up the materials. One that no library has keeps its name and counts as left out. Throws Error that names the
  // library for one that cannot be read, but not for one that does not exist.
  void read_libraries(const FileErrors& errors);

 private:
  void read_library(const std::filesystem::path& path, const std::filesystem::path& folder);

  PolygonSoup& soup_;
  MaterialTable table_;
  MaterialId current_ = 0;
  std::vector<std::string_view> libraries_;
  std::vector<bool> is_defined_;  // by material
};

}  // namespace occlod
