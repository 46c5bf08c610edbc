// Our own PLY reader: OpenMesh's reader allocates as many list values as the file claims and reads double as float, and
// its messages name no place.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <string_view>
#include <type_traits>
#include <utility>

#include "base/text.h"
#include "mesh/materials.h"
#include "mesh/mesh_files.h"
#include "mesh/ply_file.h"
#include "mesh/polygon_soup.h"
#include "mesh/vertex_colors.h"

namespace occlod {
namespace {

// The use of a vertex property; coordinates, normals, colours and texture coordinates are each consecutive.
enum Slot : std::size_t {
  slot_x,
  slot_normal = 3,
  slot_red = 6,
  slot_alpha = 9,
  slot_texture,
  slot_count = 12,
  no_slot = slot_count
};

// Names that programs give to properties which are used together, in lower case. The first of each kind of which a file
// has all is used.
struct Names {
  Slot first;
  std::array<std::string_view, 3> names;  // as many as are not empty
};
constexpr std::array<Names, 15> known_names{{
    {slot_x, {"x", "y", "z"}},
    {slot_normal, {"nx", "ny", "nz"}},
    {slot_normal, {"normal_x", "normal_y", "normal_z"}},
    {slot_red, {"red", "green", "blue"}},
    {slot_red, {"r", "g", "b"}},
    {slot_red, {"diffuse_red", "diffuse_green", "diffuse_blue"}},
    {slot_alpha, {"alpha"}},
    {slot_alpha, {"a"}},
    {slot_alpha, {"diffuse_alpha"}},
    {slot_texture, {"u", "v"}},
    {slot_texture, {"s", "t"}},
    {slot_texture, {"texture_u", "texture_v"}},
    {slot_texture, {"texture_s", "texture_t"}},
    {slot_texture, {"s0", "t0"}},
    {slot_texture, {"tx", "ty"}},
}};

// Returns the factor that scales a colour of an integer type to [0, 1].
double color_scale(PlyType type) { return type == PlyType::uint16 ? 1.0 / 65535.0 : 1.0 / 255.0; }

struct VertexLayout {
  explicit VertexLayout(const PlyElement& element) : slots(element.properties.size(), no_slot) {
    for (const Names& names : known_names) use(names, element);
    for (std::size_t i = 0; i < slots.size(); ++i) {
      const PlyType type = element.properties[i].type;
      if (slots[i] < slot_red || slots[i] > slot_alpha) continue;
      has_integer_colors |= is_integer(type) && slots[i] != slot_alpha;
      if (is_integer(type)) color_scales[static_cast<int>(slots[i] - slot_red)] = color_scale(type);
    }
  }
  // True when x, y and z come first, as float32, and no other property is used.
  [[nodiscard]] bool is_float_xyz(const PlyElement& element) const {
    for (std::size_t i = 0; i < 3; ++i) {
      if (slots[i] != slot_x + i || element.properties[i].type != PlyType::float32) return false;
    }
    return std::all_of(slots.begin() + 3, slots.end(), [](Slot slot) { return slot == no_slot; }) &&
           std::ranges::none_of(element.properties, [](const PlyProperty& p) { return p.count_type.has_value(); });
  }
  [[nodiscard]] bool has(std::size_t slot) const { return present[slot]; }

  std::vector<Slot> slots;  // one for each property
  std::array<bool, slot_count> present{};
  bool has_integer_colors = false;  // but for alpha
  glm::dvec4 color_scales{1.0};     // of components of integer types

 private:
  void use(const Names& names, const PlyElement& element) {
    if (present[names.first] || (names.first == slot_alpha && !present[slot_red])) return;
    std::vector<std::size_t> places;
    for (const std::string_view name : names.names) {
      if (name.empty()) break;
      const auto found = std::ranges::find_if(
          element.properties, [&](const PlyProperty& p) { return !p.count_type && equal_ignoring_case(p.name, name); });
      if (found == element.properties.end()) return;
      places.push_back(static_cast<std::size_t>(found - element.properties.begin()));
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
      slots[places[i]] = static_cast<Slot>(names.first + i);
      present[names.first + i] = true;
    }
  }
};

// Returns the place of the list of corners: the one with a usual name or, without one, the only list of integers.
// Returns the number of properties when there is none.
std::size_t corner_list_of(const PlyElement& element) {
  std::size_t found = element.properties.size(), integer_lists = 0;
  for (const std::string_view name : {"vertex_indices", "vertex_index"}) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (property.count_type && property.name == name) return i;
    }
  }
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (!property.count_type || !is_integer(property.type)) continue;
    ++integer_lists;
    found = i;
  }
  return integer_lists == 1 ? found : element.properties.size();
}

template <class Values, class Storage>
class BodyParser {
 public:
  BodyParser(Values values, const FileErrors& errors) : values_(std::move(values)), errors_(errors) {}

  BasicPolygonSoup<Storage> parse(const PlyHeader& header) && {
    const auto vertices = std::ranges::find(header.elements, "vertex", &PlyElement::name);
    if (vertices != header.elements.end()) vertex_count_ = vertices->count;
    add_materials(header);
    for (const PlyElement& element : header.elements) {
      values_.begin_element(element);
      if (element.name == "vertex")
        read_vertices(element);
      else if (element.name == "face")
        read_faces(element);
      else if (element.name == "tristrips")
        read_strips(element);
      else
        skip_element(element);
    }
    soup_.check(errors_);
    soup_.left_out.add("obj_info lines", header.info_lines);
    const auto [what, rest] = values_.rest();
    soup_.left_out.add(what, rest);
    colors_.resolve(soup_);
    soup_.left_out.add(clamped_colors, clamped_colors_);
    if (!soup_.polygon_materials.empty()) soup_.polygon_materials.resize(soup_.polygon_count(), MaterialId{0});
    if (!soup_.polygon_features.empty()) soup_.polygon_features.resize(soup_.polygon_count(), FeatureId{0});
    if (!attributes_.corners.empty()) {
      soup_.left_out.add("texture coordinates of vertices", soup_.texture_coordinates.size());
      split_vertices(soup_, attributes_, errors_);
    }
    return std::move(soup_);
  }

 private:
  // Adds one material for each texture: faces name textures, and the file says nothing else about their look.
  void add_materials(const PlyHeader& header) {
    texture_count_ = header.texture_files.size();
    if (texture_count_ >= max_materials)
      errors_.fail("header", "has more than 65534 comments TextureFile", "split the mesh into parts");
    for (const std::string& name : header.texture_files) {
      Texture& texture = soup_.textures.emplace_back();
      texture.file = name_in(std::filesystem::path(errors_.subject()).parent_path(), name);
      soup_.materials.emplace_back().texture = static_cast<TextureId>(soup_.textures.size() - 1);
    }
  }

  void read_vertices(const PlyElement& element) {
    const VertexLayout layout(element);
    if (!layout.has(slot_x)) errors_.fail("header", "vertices lack x, y or z", "export the mesh with coordinates");
    const bool normals = layout.has(slot_normal);
    const bool colors = layout.has(slot_red);
    const bool texture = layout.has(slot_texture);
    count_properties(element, [&](std::size_t i) { return layout.slots[i] != no_slot; });
    soup_.positions.reserve(element.count);
    std::array<double, slot_count + 1> value{};  // the last entry takes unused properties
    // Opaque where there is no alpha.
    value[slot_alpha] = layout.has_integer_colors ? 1.0 : double{VertexColors<Storage>::no_alpha};
    const bool is_float_xyz = layout.is_float_xyz(element);
    std::uint64_t more = 0;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if constexpr (is_binary) {
        if (is_float_xyz) i += values_.take_float_vertices(element.count - i, record_bytes(element), soup_);
        if (i == element.count) break;
      }
      values_.begin_record(i);
      for (std::size_t p = 0; p < layout.slots.size(); ++p) {
        if (element.properties[p].count_type)
          static_cast<void>(skip_list(element.properties[p]));
        else
          value[layout.slots[p]] = values_.next(element.properties[p].type);
      }
      soup_.add_vertex(value[0], value[1], value[2], values_.line());
      if (normals) soup_.normals.emplace_back(to_float(value[3]), to_float(value[4]), to_float(value[5]));
      if (colors) add_color({value[slot_red], value[slot_red + 1], value[slot_red + 2], value[slot_alpha]}, layout);
      if (texture)
        soup_.texture_coordinates.emplace_back(to_float(value[slot_texture]), to_float(value[slot_texture + 1]));
      more += values_.end_record();
    }
    count_more(element, more);
  }

  static std::size_t record_bytes(const PlyElement& element) {
    std::size_t bytes = 0;
    for (const PlyProperty& property : element.properties) bytes += size_of(property.type);
    return bytes;
  }

  // Integer types say themselves what components go up to.
  void add_color(const glm::dvec4& rgba, const VertexLayout& layout) {
    if (layout.has_integer_colors)
      soup_.colors.push_back(to_color(rgba * layout.color_scales, clamped_colors_));
    else
      colors_.add(soup_.positions.size() - 1, glm::vec4(rgba.r, rgba.g, rgba.b, rgba.a * layout.color_scales.a));
  }

  // Counts the properties of an element of which is_used(place) is false.
  template <class IsUsed>
  void count_properties(const PlyElement& element, const IsUsed& is_used) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      if (!is_used(i))
        soup_.left_out.add(fmt::format("property {} of {}", element.properties[i].name, element.name), element.count);
    }
  }

  void count_more(const PlyElement& element, std::uint64_t values) {
    soup_.left_out.add(fmt::format("values at the ends of {} lines", element.name), values);
  }

  std::size_t expect_corner_list(const PlyElement& element, const char* what) const {
    const std::size_t place = corner_list_of(element);
    if (element.count == 0 || place < element.properties.size()) return place;
    errors_.fail("header", fmt::format("{} have no list 'vertex_indices'", what), "export the mesh with its faces");
  }

  void read_faces(const PlyElement& element) {
    const std::size_t corner_list = expect_corner_list(element, "faces");
    std::size_t texcoord = element.properties.size(), texnumber = texcoord, part = texcoord;  // places
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (property.count_type && property.name == "texcoord" && i != corner_list) texcoord = i;
      if (!property.count_type && property.name == "texnumber" && texture_count_ > 0) texnumber = i;
      if (names_part(property) && part == element.properties.size()) part = i;
    }
    count_properties(element,
                     [&](std::size_t i) { return i == corner_list || i == texcoord || i == texnumber || i == part; });
    const bool has_short_lists = has_short_lists_only(element);
    std::uint64_t more = 0;
    if constexpr (is_binary) {
      if (has_short_lists) soup_.reserve_polygons(std::min(element.count, values_.bytes_left() / ply_triangle_bytes));
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if constexpr (is_binary) {
        if (has_short_lists) i += values_.take_triangles(element.count - i, soup_);
        if (i == element.count) break;
      }
      values_.begin_record(i);
      coordinates_.clear();
      double texture = 0.0, part_number = 0.0;
      const std::size_t first_corner = corner_count_;
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (p == corner_list)
          read_corners(property);
        else if (p == texcoord)
          read_texture_coordinates(property);
        else if (p == texnumber)
          texture = values_.next(property.type);
        else if (p == part)
          part_number = values_.next(property.type);
        else
          skip(property);
      }
      soup_.end_polygon(values_.line());
      add_texture_coordinates(first_corner);
      if (texture_count_ > 0) set_texture(texture);
      if (part < element.properties.size()) set_part(element.properties[part].name, part_number);
      more += values_.end_record();
    }
    count_more(element, more);
  }

  void read_texture_coordinates(const PlyProperty& property) {
    const std::uint64_t count = next_count(property);
    for (std::uint64_t i = 0; i < count; ++i) coordinates_.push_back(to_float(values_.next(property.type)));
  }

  // Adds a pair of texture coordinates for each corner of the current face, if it has them.
  void add_texture_coordinates(std::size_t first_corner) {
    if (coordinates_.empty()) return;
    const std::size_t corners = corner_count_ - first_corner;
    if (coordinates_.size() != 2 * corners) {
      values_.fail(
          fmt::format("the list texcoord has {} numbers for a face of {} corners", coordinates_.size(), corners),
          "export the mesh again");
    }
    attributes_.corners.resize(first_corner);
    for (std::size_t i = 0; i < corners; ++i) {
      attributes_.corners.push_back({static_cast<std::uint32_t>(attributes_.texture_coordinates.size()), no_id});
      attributes_.texture_coordinates.emplace_back(coordinates_[2 * i], coordinates_[2 * i + 1]);
    }
    if (attributes_.texture_coordinates.size() >= no_id)
      values_.fail("there are too many texture coordinates", "split the mesh into parts");
  }

  // Sets the texture number of the current face; a negative number means that it has no texture.
  void set_texture(double number) {
    if (number == 0.0) {
      if (!soup_.polygon_materials.empty()) soup_.polygon_materials.resize(soup_.polygon_count(), MaterialId{0});
      return;
    }
    if (number >= static_cast<double>(texture_count_) || number != std::floor(number)) {
      values_.fail(fmt::format("a face has texture {}, but there are {}, numbered from 0", number, texture_count_),
                   "export the mesh again");
    }
    if (number < 0.0 && soup_.materials.size() == texture_count_) soup_.materials.emplace_back();
    const auto material = static_cast<MaterialId>(number < 0.0 ? texture_count_ : static_cast<std::size_t>(number));
    soup_.polygon_materials.resize(soup_.polygon_count() - 1, MaterialId{0});
    soup_.polygon_materials.push_back(material);
  }

  // True for a property of faces by which programs tell objects apart.
  static bool names_part(const PlyProperty& property) {
    constexpr std::array<std::string_view, 3> names{"object_id", "group_id", "feature_id"};
    return !property.count_type && is_integer(property.type) && std::ranges::find(names, property.name) != names.end();
  }

  // Makes the current face one of the feature that its number names.
  void set_part(const std::string& property, double number) {
    const auto [found, is_new] = parts_.try_emplace(number, static_cast<FeatureId>(soup_.feature_names.size()));
    if (is_new) soup_.feature_names.push_back(fmt::format("{} {}", property, number));
    soup_.give_feature(soup_.polygon_count() - 1, found->second);
  }

  // True when faces are only lists of 32-bit indices with a count of one byte.
  static bool has_short_lists_only(const PlyElement& element) {
    if (element.properties.size() != 1) return false;
    const PlyProperty& property = element.properties[0];
    return property.count_type && size_of(*property.count_type) == 1 && is_integer(property.type) &&
           size_of(property.type) == 4;
  }

  void read_corners(const PlyProperty& property) {
    const std::uint64_t count = next_count(property);
    for (std::uint64_t corner = 0; corner < count; ++corner) {
      const double index = values_.next(property.type);
      if (!(index >= 0.0 && index < double{no_id}) || index != std::floor(index)) {
        values_.fail(fmt::format("a face uses vertex {}, which is out of range", index), "export the mesh again");
      }
      soup_.add_corner(static_cast<VertexId>(index));
    }
    corner_count_ += count;
  }

  void read_strips(const PlyElement& element) {
    const std::size_t corner_list = expect_corner_list(element, "triangle strips");
    count_properties(element, [&](std::size_t i) { return i == corner_list; });
    std::uint64_t more = 0;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      values_.begin_record(i);
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        if (p == corner_list)
          read_strip(element.properties[p]);
        else
          skip(element.properties[p]);
      }
      more += values_.end_record();
    }
    count_more(element, more);
  }

  // Reads triangle strips one after the other, each but the last ended by -1. Every second triangle of a strip is
  // reversed. Triangles that only connect strips repeat a corner and are left for clean() to drop and count.
  void read_strip(const PlyProperty& property) {
    const std::uint64_t count = next_count(property);
    Triangle last(no_id);  // the three latest corners
    std::uint64_t length = 0;
    for (std::uint64_t entry = 0; entry < count; ++entry) {
      const double index = values_.next(property.type);
      if (is_strip_end(index, property.type)) {
        expect_whole_strip(length, entry);
        length = 0;
        continue;
      }
      last = {last.y, last.z, strip_vertex(index, entry)};
      if (++length < 3) continue;
      const bool turned = length % 2 == 0;
      add_strip_triangle(turned ? Triangle(last.x, last.z, last.y) : last);
    }
    expect_whole_strip(length, count);
  }

  void add_strip_triangle(const Triangle& triangle) {
    for (int corner = 0; corner < 3; ++corner) soup_.add_corner(triangle[corner]);
    soup_.end_polygon(values_.line());
    corner_count_ += 3;
  }

  // True for -1, also in a list of unsigned integers, where some programs write it; no vertex has that index.
  static bool is_strip_end(double index, PlyType type) {
    return index == -1.0 || (type == PlyType::uint32 && index == 4294967295.0);
  }

  void expect_whole_strip(std::uint64_t length, std::uint64_t end) const {
    if (length == 0 || length >= 3) return;
    values_.fail(
        fmt::format("the triangle strip that ends before entry {} has {} of at least three vertices", end, length),
        "remove the strip or export the mesh again");
  }

  VertexId strip_vertex(double index, std::uint64_t entry) const {
    if (index >= 0.0 && index < static_cast<double>(vertex_count_) && index == std::floor(index))
      return static_cast<VertexId>(index);
    values_.fail(fmt::format("entry {} of the triangle strips is vertex {}, but there are {} vertices, numbered from 0",
                             entry, index, vertex_count_),
                 "export the mesh again");
  }

  std::uint64_t next_count(const PlyProperty& list) {
    const double count = values_.next(*list.count_type);
    if (!(count >= 0.0 && count <= 4294967295.0) || count != std::floor(count)) {
      values_.fail(fmt::format("the list {} has {} entries", in_quotes(list.name), count), "export the mesh again");
    }
    return static_cast<std::uint64_t>(count);
  }

  void skip_element(const PlyElement& element) {
    soup_.left_out.add("element " + element.name, element.count);
    if (element.properties.empty()) return;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      values_.begin_record(i);
      for (const PlyProperty& property : element.properties) skip(property);
      static_cast<void>(values_.end_record());
    }
  }

  void skip(const PlyProperty& property) {
    if (property.count_type)
      static_cast<void>(skip_list(property));
    else
      static_cast<void>(values_.next(property.type));
  }

  // Skips a list and returns its number of values.
  std::uint64_t skip_list(const PlyProperty& property) {
    const std::uint64_t count = next_count(property);
    for (std::uint64_t i = 0; i < count; ++i) static_cast<void>(values_.next(property.type));
    return count;
  }

  static constexpr bool is_binary = std::is_same_v<Values, BinaryValues>;

  Values values_;
  const FileErrors& errors_;
  std::uint64_t vertex_count_ = 0;  // from the header
  std::size_t texture_count_ = 0;
  std::size_t corner_count_ = 0;       // corners of the polygons so far, if faces may have texture coordinates
  std::vector<float> coordinates_;     // of the current face
  std::map<double, FeatureId> parts_;  // by number
  CornerAttributes<Storage> attributes_;
  VertexColors<Storage> colors_;      // of floating-point types
  std::uint64_t clamped_colors_ = 0;  // of integer types
  BasicPolygonSoup<Storage> soup_;
};

// Returns the beginning of the file with the whole header. Searches for the usual form of the header's last line; for
// other forms it returns the whole file.
std::string_view window_with_header(InputBytes& input) {
  constexpr std::string_view last_line = "\nend_header";
  std::string_view head = input.window(1);
  while (head.size() < input.size()) {
    const std::size_t end = head.find(last_line);
    if (end != std::string_view::npos && head.find('\n', end + last_line.size()) != std::string_view::npos) break;
    head = input.window(2 * head.size());
  }
  return head;
}

template <class Storage>
BasicPolygonSoup<Storage> parse_whole(InputBytes& input, const FileErrors& errors) {
  const PlyHeader header = parse_ply_header(window_with_header(input), input.size(), errors);
  input.skip(header.body_offset);
  if (header.binary_order)
    return BodyParser<BinaryValues, Storage>(BinaryValues(input, header, errors), errors).parse(header);
  return BodyParser<AsciiValues, Storage>(AsciiValues(input, header, errors), errors).parse(header);
}

}  // namespace

template <class Storage>
BasicPolygonSoup<Storage> parse_ply(InputBytes& input, const FileErrors& errors) {
  if (input.window(1).starts_with("ply")) return parse_whole<Storage>(input, errors);
  std::string converted;
  InputBytes text(as_utf8(input.window(input.size()), converted, errors));
  return parse_whole<Storage>(text, errors);
}

template PolygonSoup parse_ply<InMemory>(InputBytes& input, const FileErrors& errors);
template ScratchSoup parse_ply<InScratch>(InputBytes& input, const FileErrors& errors);

}  // namespace occlod
