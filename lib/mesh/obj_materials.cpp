#include "mesh/obj_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <system_error>

#include "mesh/files_beside.h"
#include "base/text_encoding.h"

namespace occlod {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t most_library_bytes = std::uint64_t{1} << 26;

}  // namespace

bool ObjMaterials::use(std::string_view name, bool has_polygons, const TextCursor& cursor) {
  MaterialId unnamed = 0;
  const bool is_first = !any() && has_polygons;
  if (is_first && !table_.find_or_add("", unnamed)) return false;
  if (table_.find_or_add(name, current_)) return is_first;
  cursor.fail(fmt::format("there are more than {} materials", most_materials), "split the mesh into parts");
}

void ObjMaterials::read_libraries(const FileErrors& errors) {
  is_defined_.assign(soup_.materials.size(), false);
  placements_.assign(soup_.materials.size(), {});
  const fs::path folder = fs::path(errors.subject()).parent_path();
  for (const std::string& line : libraries_) {
    for (const std::string& name : library_names(line, folder))
      read_library(folder / name, fs::path(name).parent_path());
  }
  for (std::size_t m = 0; m < soup_.materials.size(); ++m)
    soup_.left_out.materials += !is_defined_[m] && !soup_.materials[m].name.empty();
}

// The first definition of a name counts. Names of textures become relative to the folder of the OBJ file.
void ObjMaterials::read_library(const fs::path& path, const fs::path& folder) {
  const FileErrors errors(path);
  std::error_code unknown;
  const std::uintmax_t bytes = fs::file_size(path, unknown);
  if (bytes == 0) return;
  if (bytes > most_library_bytes) errors.fail("", "is too large for a library of materials", "check the mtllib line");
  InputBytes input(path, errors, {});
  std::string converted;
  for (auto& [material, texture, placement] :
       parse_mtl(as_utf8(input.window(input.size()), converted, errors), errors)) {
    Material* const used = table_.find(material.name);
    if (used == nullptr) continue;
    const auto id = static_cast<std::size_t>(used - soup_.materials.data());
    if (is_defined_[id]) continue;
    is_defined_[id] = true;
    *used = std::move(material);
    if (texture.file.empty()) continue;
    texture.file = (folder / texture.file).generic_string();
    used->texture = table_.texture(std::move(texture));
    placements_[id] = placement;
  }
}

}  // namespace occlod
