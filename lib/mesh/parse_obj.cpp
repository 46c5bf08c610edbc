// Our own OBJ reader: OpenMesh's reader skips vertex lines that it cannot parse, which shifts the index of every later
// vertex, and its messages name no line.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "base/file_input.h"
#include "base/memory.h"
#include "base/text.h"
#include "mesh/materials.h"
#include "mesh/mesh_files.h"
#include "mesh/polygon_soup.h"
#include "mesh/vertex_colors.h"

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
    const std::vector<std::string> names = library_names(line, folder);
    soup_.left_out.add("missing libraries (mtllib)", names.empty() ? 1 : 0);
    for (const std::string& name : names) read_library(folder / name, fs::path(name).parent_path());
  }
  for (std::size_t m = 0; m < soup_.materials.size(); ++m)
    soup_.left_out.add("undefined materials (usemtl)", !is_defined_[m] && !soup_.materials[m].name.empty());
}

// Places a map at texture coordinates that the placement of the base colour has changed. Returns false where no offset
// and scale do that.
bool place(const MapPlacement& of_map, const MapPlacement& of_color, TextureMap& map) {
  if (of_map == of_color) return true;
  if (of_color.scale.x == 0.0 || of_color.scale.y == 0.0) return false;
  const glm::dvec2 scale = of_map.scale / of_color.scale;
  const glm::dvec2 offset = of_map.offset - scale * of_color.offset;
  map.scale = {to_float(scale.x), to_float(scale.y)};
  map.offset = {to_float(offset.x), to_float(1.0 - scale.y - offset.y)};  // TextureMap has v growing downwards
  return true;
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
  const auto texture_of = [&](MtlMap& map) {
    if (map.texture.file.empty()) return no_texture;
    map.texture.file = (folder / name_in(path.parent_path(), map.texture.file)).generic_string();
    const TextureId id = table_.texture(std::move(map.texture));
    if (id == no_texture)
      errors.fail("", fmt::format("has more than {} textures", no_texture), "split the mesh into parts");
    return id;
  };
  for (auto& [material, color, normals, emission, left_out] :
       parse_mtl(as_utf8(input.window(input.size()), converted, errors), errors)) {
    Material* const used = table_.find(material.name);
    const std::size_t id = used == nullptr ? 0 : static_cast<std::size_t>(used - soup_.materials.data());
    if (used == nullptr || is_defined_[id]) {
      soup_.left_out.add(used == nullptr ? "unused materials (newmtl)" : "materials defined again (newmtl)");
      continue;
    }
    is_defined_[id] = true;
    soup_.left_out.add(left_out);
    material.name = used->name;  // which is UTF-8
    *used = std::move(material);
    used->texture = texture_of(color);
    if (used->texture != no_texture) placements_[id] = color.placement;
    const auto add_map = [&](MtlMap& read, TextureMap& map, const char* keyword) {
      if (read.texture.file.empty()) return;
      if (place(read.placement, placements_[id], map))
        map.texture = texture_of(read);
      else
        soup_.left_out.add(fmt::format("{} beside map_Kd -s 0", keyword));
    };
    add_map(normals, used->surface.normal_map, "norm");
    add_map(emission, used->surface.emissive_map, "map_Ke");
  }
}

// Features of OBJ files: the group (g) of faces, or their object (o) where it has no groups, or both where it has
// several.
class ObjFeatures {
 public:
  // Adds to `names`, which outlives it.
  explicit ObjFeatures(std::vector<std::string>& names) : names_(names) {}

  // Takes an o or g line; `has_polygons` tells whether there are faces before it.
  void begin_object(std::string_view name, bool has_polygons) {
    object_ = readable(name);
    objects_.try_emplace(object_, false);
    begin_group({}, has_polygons);
  }
  void begin_group(std::string_view name, bool has_polygons) {
    group_ = readable(name);
    groups_.try_emplace(group_, false);
    if (!has_lines_ && has_polygons) names_.emplace_back();
    has_lines_ = is_new_ = true;
  }
  // Returns the feature of the next face. Features are numbered by their first faces.
  FeatureId current() {
    if (!is_new_) return current_;
    is_new_ = false;
    objects_[object_] = groups_[group_] = true;
    const auto [found, is_added] = by_name_.try_emplace({object_, group_}, static_cast<FeatureId>(names_.size()));
    if (is_added) names_.push_back(name());
    return current_ = found->second;
  }

  void count_unused(LeftOut& left_out) const {
    const auto unused = [](const std::map<std::string, bool>& names) {
      return std::ranges::count_if(names, [](const auto& entry) { return !entry.second && !entry.first.empty(); });
    };
    left_out.add("unused objects (o)", static_cast<std::uint64_t>(unused(objects_)));
    left_out.add("unused groups (g)", static_cast<std::uint64_t>(unused(groups_)));
  }

 private:
  [[nodiscard]] std::string name() const {
    if (group_.empty() || object_.empty() || group_ == object_) return group_.empty() ? object_ : group_;
    return object_ + "/" + group_;
  }

  std::vector<std::string>& names_;
  std::map<std::pair<std::string, std::string>, FeatureId> by_name_;
  std::map<std::string, bool> objects_, groups_;  // whether faces are in them
  std::string object_, group_;
  FeatureId current_ = 0;
  bool has_lines_ = false;
  bool is_new_ = false;  // the names have changed since current()
};

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
      : chunks_(input, errors, obj_syntax),
        cursor_({}, errors, obj_syntax),
        errors_(errors),
        materials_(soup_),
        features_(soup_.feature_names) {}

  BasicPolygonSoup<Storage> parse() && {
    while (chunks_.next(cursor_)) read_lines();
    soup_.check(errors_, 1);
    check_attributes();
    count_unused_attributes();
    colors_.resolve(soup_);
    materials_.read_libraries(errors_);
    place_textures(soup_, materials_.placements(), attributes_, errors_);
    if (!attributes_.corners.empty()) split_vertices(soup_, attributes_, errors_);
    drop_unnamed_features(soup_);
    count_left_out();
    return std::move(soup_);
  }

 private:
  template <class T>
  using Array = typename Storage::template Array<T>;

  void read_lines() {
    for (; cursor_.find_word(); cursor_.skip_line()) {
      const std::string_view keyword = cursor_.word();
      if (keyword == "v")
        read_vertex();
      else if (keyword == "vn")
        read_normal();
      else if (keyword == "vt")
        read_texture_coordinate();
      else if (keyword == "f" || keyword == "fo")  // fo: as version 2.11 wrote faces
        read_face();
      else if (keyword == "usemtl")
        use_material();
      else if (keyword == "mtllib")
        materials_.add_library(cursor_.rest_of_line());
      else if (keyword == "o")
        features_.begin_object(cursor_.rest_of_line(), soup_.polygon_count() > 0);
      else if (keyword == "g")
        features_.begin_group(cursor_.rest_of_line(), soup_.polygon_count() > 0);
      else
        count_line(keyword);
    }
  }

  void count_line(std::string_view keyword) {
    if (keyword == "l") {
      ++lines_;
    } else if (keyword == "p") {
      ++points_;
    } else if (keyword == "s") {
      const std::string_view group = cursor_.rest_of_line();
      if (group != "off" && group != "0") smoothing_groups_.add(group);
    } else {
      soup_.left_out.add("keyword " + std::string(keyword));
    }
  }

  void count_left_out() {
    LeftOut& left_out = soup_.left_out;
    features_.count_unused(left_out);
    left_out.add("smoothing groups (s)", smoothing_groups_.count());
    left_out.add("lines (l)", lines_);
    left_out.add("points (p)", points_);
    left_out.add("weights of vertices (v)", weights_);
    left_out.add("third texture coordinates (vt)", third_coordinates_);
    left_out.add("values at the ends of lines", more_values_);
    left_out.add("texture indices without vt", corners_without_texture_);
    left_out.add("normal indices without vn", corners_without_normal_);
  }

  void use_material() {
    if (materials_.use(cursor_.rest_of_line(), soup_.polygon_count() > 0, cursor_))
      soup_.polygon_materials.resize(soup_.polygon_count(), MaterialId{0});
  }

  // Reads "x y z", "x y z w" (w is a weight for curves) or "x y z r g b [a]".
  void read_vertex() {
    const std::uint64_t line = cursor_.line();
    const double x = cursor_.number("x of a vertex");
    const double y = cursor_.number("y of a vertex");
    const double z = cursor_.number("z of a vertex");
    if (!cursor_.at_line_end()) read_vertex_extras();
    soup_.add_vertex(x, y, z, line);
  }

  void read_vertex_extras() {
    const double first = cursor_.number("the fourth number of a vertex");
    if (cursor_.at_line_end()) {
      weights_ += first == 1.0 ? 0U : 1U;
      return;
    }
    const double second = cursor_.number("the fifth number of a vertex");
    const double third = cursor_.number("the sixth number of a vertex");
    glm::vec4 color(to_float(first), to_float(second), to_float(third), VertexColors<Storage>::no_alpha);
    if (!cursor_.at_line_end()) color.a = to_float(cursor_.number("the seventh number of a vertex"));
    colors_.add(soup_.positions.size(), color);
    count_more_values();
  }

  void count_more_values() {
    if (!cursor_.at_line_end()) more_values_ += cursor_.words_left();
  }

  void read_normal() {
    const float x = to_float(cursor_.number("x of a normal"));
    const float y = to_float(cursor_.number("y of a normal"));
    const float z = to_float(cursor_.number("z of a normal"));
    attributes_.normals.emplace_back(x, y, z);
    count_more_values();
  }

  // Reads "u [v [w]]"; programs for surfaces write w = 0.
  void read_texture_coordinate() {
    const float u = to_float(cursor_.number("u of a texture coordinate"));
    const float v = cursor_.at_line_end() ? 0.0F : to_float(cursor_.number("v of a texture coordinate"));
    attributes_.texture_coordinates.emplace_back(u, v);
    if (cursor_.at_line_end()) return;
    third_coordinates_ += cursor_.number("w of a texture coordinate") == 0.0 ? 0U : 1U;
    count_more_values();
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
    soup_.give_feature(soup_.polygon_count() - 1, features_.current());
  }

  // Reads "v", "v/vt", "v//vn" or "v/vt/vn"; what is missing after a slash is absent, as in "v/" and "v/vt/".
  ObjCorner parse_corner(std::string_view text) {
    const char* at = text.data();
    const char* const end = at + text.size();
    ObjCorner corner{parse_index(at, end, soup_.positions.size(), text), {}};
    if (skip_slash(at, end, text))
      corner.attributes.texture =
          parse_attribute(at, end, attributes_.texture_coordinates.size(), text, corners_without_texture_);
    if (skip_slash(at, end, text))
      corner.attributes.normal = parse_attribute(at, end, attributes_.normals.size(), text, corners_without_normal_);
    if (at != end) bad_corner(text);
    return corner;
  }

  // Skips a slash; returns false at the end.
  bool skip_slash(const char*& at, const char* end, std::string_view text) const {
    if (at == end) return false;
    if (*at != '/') bad_corner(text);
    ++at;
    return true;
  }

  // Reads an index of an attribute, unless it is missing. Indices that count back from the end of a list that is empty
  // name nothing, and are counted.
  std::uint32_t parse_attribute(const char*& at, const char* end, std::size_t count, std::string_view text,
                                std::uint64_t& without) {
    if (at == end || *at == '/') return no_id;
    if (count > 0 || *at != '-') return parse_index(at, end, count, text);
    static_cast<void>(parse_integer(at, end, text));
    ++without;
    return no_id;
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
    const char* digit = at;
    for (; digit != end && *digit >= '0' && *digit <= '9' && digit - at < 18; ++digit)
      value = 10 * value + (*digit - '0');
    if (digit != at && (digit == end || *digit == '/')) {  // as most are
      at = digit;
      return value;
    }
    const std::from_chars_result result = std::from_chars(at, end, value);
    if (result.ec != std::errc{}) bad_corner(text);
    at = result.ptr;
    return value;
  }

  [[noreturn]] void bad_corner(std::string_view text) const {
    cursor_.fail(fmt::format("the face corner {} is not v, v/vt, v//vn or v/vt/vn", in_quotes(text)),
                 "correct the line or export the mesh again");
  }

  // Some programs write indices of attributes that they do not write: those of a list that the file lacks are dropped.
  void check_attributes() {
    if (attributes_.texture_coordinates.empty())
      corners_without_texture_ += drop_indices(largest_texture_, &AttributeCorner::texture);
    if (attributes_.normals.empty()) corners_without_normal_ += drop_indices(largest_normal_, &AttributeCorner::normal);
    check_index(largest_texture_, attributes_.texture_coordinates.size(), "texture coordinate");
    check_index(largest_normal_, attributes_.normals.size(), "normal");
  }

  // Returns the number of corners that had one.
  std::uint64_t drop_indices(LargestIndex& largest, std::uint32_t AttributeCorner::*index) {
    if (largest.end == 0) return 0;
    largest = {};
    std::uint64_t dropped = 0;
    for (AttributeCorner& corner : attributes_.corners) {
      dropped += corner.*index == no_id ? 0U : 1U;
      corner.*index = no_id;
    }
    return dropped;
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

  TextChunks chunks_;
  TextCursor cursor_;
  const FileErrors& errors_;
  BasicPolygonSoup<Storage> soup_;
  CornerAttributes<Storage> attributes_;  // checked at the end, because a value may follow the face that uses it
  std::size_t corner_count_ = 0;
  LargestIndex largest_texture_, largest_normal_;
  ObjMaterials materials_;
  VertexColors<Storage> colors_;
  ObjFeatures features_;
  DistinctNames smoothing_groups_;
  // Counts of what is left out: lines, and numbers or corners on lines.
  std::uint64_t lines_ = 0, points_ = 0;
  std::uint64_t weights_ = 0, third_coordinates_ = 0, more_values_ = 0;
  std::uint64_t corners_without_texture_ = 0, corners_without_normal_ = 0;
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
