// Our own OBJ reader: OpenMesh's reader skips vertex lines that it cannot parse, which shifts the index of every later
// vertex, and its messages name no line.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/file_input.h"
#include "base/memory.h"
#include "base/text.h"
#include "mesh/materials.h"
#include "mesh/mesh_files.h"
#include "mesh/polygon_soup.h"

namespace occlod {
namespace {

// Applies the texture placements of materials: corners of polygons whose material scales or moves its texture get new
// texture coordinates at the end of the list; other corners stay as they are. `placements` is by material, for a soup
// whose polygons have materials; indices of corners have been checked. Throws Error when there are not enough ids for
// the texture coordinates. O(corners); a coordinate is copied once for each run of polygons of one placement that uses
// it.
template <class Storage>
void place_textures(const BasicPolygonSoup<Storage>& soup, std::span<const MapPlacement> placements,
                    CornerAttributes<Storage>& attributes, const FileErrors& errors);

constexpr std::size_t polygons_between_looks = 4096;  // between two calls of make_room()

glm::vec2 placed(const glm::vec2& at, const MapPlacement& by) {
  const glm::dvec2 there = by.scale * glm::dvec2(at) + by.offset;
  return {to_float(there.x), to_float(there.y)};
}

template <class Storage>
void place_textures(const BasicPolygonSoup<Storage>& soup, std::span<const MapPlacement> placements,
                    CornerAttributes<Storage>& attributes, const FileErrors& errors) {
  const MapPlacement as_it_is;
  auto& corners = attributes.corners;
  auto& coordinates = attributes.texture_coordinates;
  if (coordinates.empty() || std::ranges::count(placements, as_it_is) == std::ssize(placements)) return;
  typename Storage::template Array<std::uint32_t> copies(coordinates.size(), 0);  // latest copy, by coordinate
  std::size_t run = coordinates.size();                                           // first copy that is placed by `by`
  const MapPlacement* by = &as_it_is;
  std::size_t corner = 0;
  for (std::size_t polygon = 0; polygon < soup.polygon_count() && corner < corners.size(); ++polygon) {
    if (polygon % polygons_between_looks == 0) make_room();
    const std::size_t first = corner;
    corner += soup.corner_count(polygon);
    const MapPlacement& placement = placements[soup.polygon_materials[polygon]];
    if (placement == as_it_is) continue;
    if (placement != *by) {
      by = &placement;
      run = coordinates.size();
    }
    for (std::size_t i = first; i < std::min(corner, corners.size()); ++i) {
      std::uint32_t& index = corners[i].texture;
      if (index == no_id) continue;
      if (copies[index] < run) {
        if (coordinates.size() >= no_id)
          errors.fail("", "has too many texture coordinates of materials that scale or move them",
                      "split the mesh into parts");
        copies[index] = static_cast<std::uint32_t>(coordinates.size());
        coordinates.push_back(placed(coordinates[index], placement));
      }
      index = copies[index];
    }
  }
}

template void place_textures(const PolygonSoup&, std::span<const MapPlacement>, CornerAttributes<InMemory>&,
                             const FileErrors&);
template void place_textures(const ScratchSoup&, std::span<const MapPlacement>, CornerAttributes<InScratch>&,
                             const FileErrors&);

// Fills the materials and textures of a soup from usemtl lines and from the files that mtllib lines name, in the order
// of their names on usemtl lines. The soup outlives it.
class ObjMaterials {
 public:
  explicit ObjMaterials(SoupTables& soup) : soup_(soup), table_(soup) {}

  // Sets the material of the polygons from here on. Polygons before the first usemtl line get a material without a
  // name: returns true for the first line when there are such polygons.
  [[nodiscard]] bool use(std::string_view name, bool has_polygons, const TextCursor& cursor);
  // Takes the text after mtllib: one name, or several separated by blanks.
  void add_library(std::string_view names) { libraries_.emplace_back(names); }
  // any() is true when polygons have materials; current() is the material of the next polygon.
  [[nodiscard]] bool any() const { return !soup_.materials.empty(); }
  [[nodiscard]] MaterialId current() const { return current_; }
  // Looks up the materials. One that no library has keeps its name and counts as left out. Throws Error that names the
  // library for one that cannot be read, but not for one that does not exist.
  void read_libraries(const FileErrors& errors);
  // Returns the texture placements by material; call it after read_libraries().
  [[nodiscard]] std::span<const MapPlacement> placements() const { return placements_; }

 private:
  void read_library(const std::filesystem::path& path, const std::filesystem::path& folder);

  SoupTables& soup_;
  MaterialTable table_;
  MaterialId current_ = 0;
  std::vector<std::string> libraries_;
  std::vector<bool> is_defined_;          // by material
  std::vector<MapPlacement> placements_;  // by material
};

namespace fs = std::filesystem;

constexpr std::uint64_t max_library_bytes = std::uint64_t{1} << 26;

bool ObjMaterials::use(std::string_view name, bool has_polygons, const TextCursor& cursor) {
  MaterialId unnamed = 0;
  const bool is_first = !any() && has_polygons;
  if (is_first && !table_.find_or_add("", unnamed)) return false;
  if (table_.find_or_add(name, current_)) return is_first;
  cursor.fail(fmt::format("there are more than {} materials", max_materials), "split the mesh into parts");
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
    soup_.left_out.add("undefined materials (usemtl)", !is_defined_[m] && !soup_.materials[m].name.empty());
}

// Reads a library. The first definition of a name counts. Names of textures become relative to the folder of the OBJ
// file.
void ObjMaterials::read_library(const fs::path& path, const fs::path& folder) {
  const FileErrors errors(path);
  std::error_code unknown;
  const std::uintmax_t bytes = fs::file_size(path, unknown);
  if (bytes == 0) return;
  if (bytes > max_library_bytes) errors.fail("", "is too large for a library of materials", "check the mtllib line");
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

// The largest index that faces use into a list, which may come after them in the file.
struct LargestIndex {
  std::uint64_t end = 0;  // the largest index plus one
  std::uint64_t line = 0;

  void add(std::uint32_t index, std::uint64_t at_line) {
    if (index == no_id || index < end) return;
    end = std::uint64_t{index} + 1;
    line = at_line;
  }
};

// A corner of a face. The file's indices count from 1, or back from the newest element with -1; ours count from 0.
struct ObjCorner {
  VertexId vertex;
  AttributeCorner attributes;
};

template <class Storage>
class ObjParser {
 public:
  ObjParser(InputBytes& input, const FileErrors& errors)
      : chunks_(input, errors, obj_syntax), cursor_({}, errors, obj_syntax), errors_(errors), materials_(soup_) {}

  BasicPolygonSoup<Storage> parse() && {
    while (chunks_.next(cursor_)) read_lines();
    soup_.check(errors_, 1);
    check_attributes();
    count_unused_attributes();
    resolve_colors();
    materials_.read_libraries(errors_);
    place_textures(soup_, materials_.placements(), attributes_, errors_);
    if (!attributes_.corners.empty()) split_vertices(soup_, attributes_, errors_);
    soup_.left_out.add("objects (o)", objects_.count());
    soup_.left_out.add("groups (g)", groups_.count());
    return std::move(soup_);
  }

 private:
  template <class T>
  using Array = typename Storage::template Array<T>;

  void read_lines() {
    for (; cursor_.find_word(); cursor_.skip_line()) {
      const std::string_view keyword = cursor_.word();
      if (keyword == "v") read_vertex();
      if (keyword == "vn") read_normal();
      if (keyword == "f") read_face();
      if (keyword == "vt") read_texture_coordinate();
      if (keyword == "usemtl") use_material();
      if (keyword == "mtllib") materials_.add_library(cursor_.rest_of_line());
      if (keyword == "o") objects_.add(cursor_.rest_of_line());
      if (keyword == "g") groups_.add(cursor_.rest_of_line());
    }
  }

  void use_material() {
    if (materials_.use(cursor_.rest_of_line(), soup_.polygon_count() > 0, cursor_))
      soup_.polygon_materials.resize(soup_.polygon_count(), MaterialId{0});
  }

  // Reads "x y z", "x y z w" (w is a weight for curves) or "x y z r g b"; the rest of the line is ignored.
  void read_vertex() {
    const std::uint64_t line = cursor_.line();
    const double x = cursor_.number("x of a vertex");
    const double y = cursor_.number("y of a vertex");
    const double z = cursor_.number("z of a vertex");
    if (!cursor_.at_line_end()) read_vertex_extras();
    soup_.add_vertex(x, y, z, line);
    if (!raw_colors_.empty()) raw_colors_.resize(soup_.positions.size(), no_color);
  }

  void read_vertex_extras() {
    const double first = cursor_.number("the fourth number of a vertex");
    if (cursor_.at_line_end()) return;
    const double second = cursor_.number("the fifth number of a vertex");
    const double third = cursor_.number("the sixth number of a vertex");
    raw_colors_.resize(soup_.positions.size(), no_color);
    raw_colors_.emplace_back(to_float(first), to_float(second), to_float(third));
  }

  void read_normal() {
    const float x = to_float(cursor_.number("x of a normal"));
    const float y = to_float(cursor_.number("y of a normal"));
    const float z = to_float(cursor_.number("z of a normal"));
    attributes_.normals.emplace_back(x, y, z);
  }

  // Reads "u [v [w]]".
  void read_texture_coordinate() {
    const float u = to_float(cursor_.number("u of a texture coordinate"));
    const float v = cursor_.at_line_end() ? 0.0F : to_float(cursor_.number("v of a texture coordinate"));
    attributes_.texture_coordinates.emplace_back(u, v);
  }

  void read_face() {
    const std::uint64_t line = cursor_.line();
    Array<AttributeCorner>& corners = attributes_.corners;
    while (!cursor_.at_line_end()) {
      const auto [vertex, attributes] = parse_corner(cursor_.word());
      soup_.add_corner(vertex);
      ++corner_count_;
      if (attributes == AttributeCorner{}) continue;
      corners.resize(corner_count_ - 1);
      corners.push_back(attributes);
      largest_texture_.add(attributes.texture, line);
      largest_normal_.add(attributes.normal, line);
    }
    soup_.end_polygon(line);
    if (materials_.any()) soup_.polygon_materials.push_back(materials_.current());
  }

  // Reads "v", "v/vt", "v//vn" or "v/vt/vn".
  ObjCorner parse_corner(std::string_view text) {
    const char* at = text.data();
    const char* const end = at + text.size();
    ObjCorner corner{parse_index(at, end, soup_.positions.size(), text), {}};
    if (at == end) return corner;
    if (!skip_slash(at, end)) bad_corner(text);
    if (*at != '/') corner.attributes.texture = parse_index(at, end, attributes_.texture_coordinates.size(), text);
    if (at == end) return corner;
    if (!skip_slash(at, end)) bad_corner(text);
    corner.attributes.normal = parse_index(at, end, attributes_.normals.size(), text);
    if (at != end) bad_corner(text);
    return corner;
  }

  // Skips a slash if something follows it.
  static bool skip_slash(const char*& at, const char* end) {
    if (*at != '/' || end - at < 2) return false;
    ++at;
    return true;
  }

  VertexId parse_index(const char*& at, const char* end, std::size_t count, std::string_view text) {
    const std::int64_t value = parse_integer(at, end, text);
    const std::int64_t index = value > 0 ? value - 1 : value + static_cast<std::int64_t>(count);
    if (value == 0 || index < 0 || index >= static_cast<std::int64_t>(no_id)) {
      cursor_.fail(fmt::format("the face corner {} is out of range; indices count from 1, or from -1 backwards",
                               in_quotes(text)),
                   "export the mesh again");
    }
    return static_cast<VertexId>(index);
  }

  std::int64_t parse_integer(const char*& at, const char* end, std::string_view text) {
    std::int64_t value = 0;
    const std::from_chars_result result = std::from_chars(at, end, value);
    if (result.ec != std::errc{}) bad_corner(text);
    at = result.ptr;
    return value;
  }

  [[noreturn]] void bad_corner(std::string_view text) const {
    cursor_.fail(fmt::format("the face corner {} is not v, v/vt, v//vn or v/vt/vn", in_quotes(text)),
                 "correct the line or export the mesh again");
  }

  void check_attributes() const {
    check_index(largest_texture_, attributes_.texture_coordinates.size(), "texture coordinate");
    check_index(largest_normal_, attributes_.normals.size(), "normal");
  }

  void check_index(const LargestIndex& largest, std::size_t count, const char* what) const {
    if (largest.end <= count) return;
    errors_.fail_at_line(largest.line, fmt::format("a face uses {} {}, but there are {}", what, largest.end, count),
                         "export the mesh again");
  }

  void count_unused_attributes() {
    soup_.left_out.add("unused texture coordinates (vt)",
                       count_unused(attributes_.texture_coordinates.size(), &AttributeCorner::texture));
    soup_.left_out.add("unused normals (vn)", count_unused(attributes_.normals.size(), &AttributeCorner::normal));
  }

  std::uint64_t count_unused(std::size_t count, std::uint32_t AttributeCorner::*index) const {
    std::vector<bool> used(count);
    for (const AttributeCorner& corner : attributes_.corners) {
      if (corner.*index != no_id) used[corner.*index] = true;
    }
    return static_cast<std::uint64_t>(std::ranges::count(used, false));
  }

  // Scales colours: components go up to 1, or up to 255 when any is larger than 1.
  void resolve_colors() {
    if (raw_colors_.empty()) return;
    float largest = 0.0f;
    for (const glm::vec3& c : raw_colors_) largest = std::max({largest, c.x, c.y, c.z});
    const double scale = largest > 1.0f ? 1.0 / 255.0 : 1.0;
    soup_.colors.reserve(raw_colors_.size());
    for (const glm::vec3& c : raw_colors_) {
      const bool given = c != no_color;
      const auto component = [&](float value) { return given ? color_component(scale * value) : std::uint8_t{255}; };
      soup_.colors.emplace_back(component(c.x), component(c.y), component(c.z), std::uint8_t{255});
    }
  }

  static constexpr glm::vec3 no_color{-1.0f};  // marks vertices without a colour in a file that has colours; they
                                               // become white

  TextChunks chunks_;
  TextCursor cursor_;
  const FileErrors& errors_;
  BasicPolygonSoup<Storage> soup_;
  CornerAttributes<Storage> attributes_;  // checked at the end, because a value may follow the face that uses it
  std::size_t corner_count_ = 0;
  LargestIndex largest_texture_, largest_normal_;
  ObjMaterials materials_;
  Array<glm::vec3> raw_colors_;
  DistinctNames objects_, groups_;
};

}  // namespace

template <class Storage>
BasicPolygonSoup<Storage> parse_obj(InputBytes& input, const FileErrors& errors) {
  input.skip(utf8_mark_bytes(input.window(1)));
  if (!is_wide_text(input.window(1))) return ObjParser<Storage>(input, errors).parse();
  std::string converted;
  InputBytes text(as_utf8(input.window(input.size()), converted, errors));
  return ObjParser<Storage>(text, errors).parse();
}

template PolygonSoup parse_obj<InMemory>(InputBytes& input, const FileErrors& errors);
template ScratchSoup parse_obj<InScratch>(InputBytes& input, const FileErrors& errors);

}  // namespace occlod
