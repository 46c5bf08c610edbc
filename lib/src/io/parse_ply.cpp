// A reader of our own: OpenMesh's allocates as many list values as the file claims, reads double as float and names no
// place in its messages.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include "io/byte_order.h"
#include "io/ply_header.h"
#include "io/polygon_soup.h"
#include "io/text_cursor.h"

namespace occlod {
namespace {

constexpr const char* cut_short = "the file is cut short or its header is wrong; export the mesh again";

// The two encodings of the body, as numbers: a double holds every PLY type exactly. A record is one instance of an
// element.
class AsciiValues {
 public:
  AsciiValues(std::string_view bytes, const PlyHeader& header, const FileErrors& errors)
      : cursor_(bytes.substr(header.body_offset), errors, {}, header.body_line) {}

  void begin_element(const PlyElement& element) {
    element_ = &element;
    what_ = fmt::format("a value of element {}", in_quotes(element.name));
  }
  void begin_record(std::uint64_t i) {
    if (cursor_.find_word()) return;
    fail(fmt::format("the file ends before {} {} of {}", element_->name, i + 1, element_->count), cut_short);
  }
  [[nodiscard]] double next(PlyType) { return cursor_.number(what_.c_str()); }
  void end_record() {
    if (!cursor_.at_line_end()) fail("the line has more values than the header names", "export the mesh again");
    cursor_.skip_line();
  }

  [[nodiscard]] std::uint64_t line() const { return cursor_.line(); }
  [[noreturn]] void fail(std::string problem, std::string mend) const {
    cursor_.fail(std::move(problem), std::move(mend));
  }

 private:
  TextCursor cursor_;
  const PlyElement* element_ = nullptr;
  std::string what_;
};

constexpr std::size_t triangle_bytes = 13;  // a count of one byte and three indices of 32 bits

class BinaryValues {
 public:
  // `input` is at the beginning of the body.
  BinaryValues(InputBytes& input, const PlyHeader& header, const FileErrors& errors)
      : input_(input), order_(*header.binary_order), errors_(errors) {}

  void begin_element(const PlyElement& element) { element_ = &element; }
  void begin_record(std::uint64_t i) { record_ = i; }
  [[nodiscard]] double next(PlyType type) {
    const std::size_t size = size_of(type);
    if (left_.size() < size && look_further(size).size() < size)
      fail(fmt::format("the file ends here, within {} {}s", element_->count, element_->name), cut_short);
    const char* const value = left_.data();
    left_.remove_prefix(size);
    switch (type) {
      case PlyType::int8:
        return load<std::int8_t>(value, order_);
      case PlyType::uint8:
        return load<std::uint8_t>(value, order_);
      case PlyType::int16:
        return load<std::int16_t>(value, order_);
      case PlyType::uint16:
        return load<std::uint16_t>(value, order_);
      case PlyType::int32:
        return load<std::int32_t>(value, order_);
      case PlyType::uint32:
        return load<std::uint32_t>(value, order_);
      case PlyType::float32:
        return load<float>(value, order_);
      case PlyType::float64:
        return load<double>(value, order_);
    }
    return 0.0;
  }
  void end_record() {}

  // Takes up to `most` vertices whose records begin with x, y and z as float32; returns how many. Some are left where
  // the bytes at hand end, for the careful way.
  std::uint64_t take_float_vertices(std::uint64_t most, std::size_t record_bytes, PolygonSoup& soup) {
    const std::uint64_t count = std::min<std::uint64_t>(most, left_.size() / record_bytes);
    const char* at = left_.data();
    for (std::uint64_t i = 0; i < count; ++i, at += record_bytes) {
      soup.add_vertex(load<float>(at, order_), load<float>(at + 4, order_), load<float>(at + 8, order_), 0);
    }
    left_.remove_prefix(count * record_bytes);
    return count;
  }

  // The same for triangles whose records are a count of one byte and three indices of 32 bits, up to the first face
  // that is no triangle or has an index for the careful way to refuse.
  std::uint64_t take_triangles(std::uint64_t most, PolygonSoup& soup) {
    const std::uint64_t count = std::min<std::uint64_t>(most, left_.size() / triangle_bytes);
    const char* at = left_.data();
    std::uint64_t taken = 0;
    for (; taken < count && *at == 3; ++taken, at += triangle_bytes) {
      const Triangle triangle(load<VertexId>(at + 1, order_), load<VertexId>(at + 5, order_),
                              load<VertexId>(at + 9, order_));
      if (std::max({triangle.x, triangle.y, triangle.z}) > largest_int) break;
      soup.add_triangle(triangle);
    }
    left_.remove_prefix(taken * triangle_bytes);
    return taken;
  }

  [[nodiscard]] std::uint64_t bytes_left() const { return input_.size() - input_.offset() - (seen_ - left_.size()); }
  [[nodiscard]] std::uint64_t line() const { return 0; }
  [[noreturn]] void fail(std::string problem, std::string mend) const {
    const std::uint64_t byte = input_.offset() + (seen_ - left_.size());
    errors_.fail(fmt::format("{} {}, byte {}", element_->name, record_, byte), std::move(problem), std::move(mend));
  }

 private:
  // The largest index that signed and unsigned 32-bit integers write alike.
  static constexpr VertexId largest_int = 0x7fffffff;

  std::string_view look_further(std::size_t least) {
    input_.skip(seen_ - left_.size());
    left_ = input_.window(least);
    seen_ = left_.size();
    return left_;
  }

  InputBytes& input_;
  std::string_view left_;  // of the window
  std::size_t seen_ = 0;   // size of the window
  std::endian order_;
  const FileErrors& errors_;
  const PlyElement* element_ = nullptr;
  std::uint64_t record_ = 0;
};

// Where a vertex property goes; coordinates, normals and colours lie next to each other.
enum Slot : std::size_t { slot_x, slot_normal = 3, slot_red = 6, slot_alpha = 9, slot_count, no_slot = slot_count };

Slot slot_of(std::string_view name) {
  constexpr std::array<std::string_view, slot_count> names{"x",  "y",   "z",     "nx",   "ny",
                                                           "nz", "red", "green", "blue", "alpha"};
  constexpr std::array<std::string_view, 4> short_colors{"r", "g", "b", "a"};
  const auto place = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  const auto color = static_cast<std::size_t>(std::ranges::find(short_colors, name) - short_colors.begin());
  return static_cast<Slot>(color < short_colors.size() ? slot_red + color : place);
}

// What one unit of a colour of this type is worth.
double color_scale(PlyType type) {
  if (!is_integer(type)) return 1.0;
  return type == PlyType::uint16 ? 1.0 / 65535.0 : 1.0 / 255.0;
}

struct VertexLayout {
  explicit VertexLayout(const PlyElement& element) {
    color_scales.fill(1.0);
    for (const PlyProperty& property : element.properties) {
      const Slot slot = property.count_type ? no_slot : slot_of(property.name);
      slots.push_back(slot);
      if (slot == no_slot) continue;
      present[slot] = true;
      if (slot >= slot_red) color_scales[slot - slot_red] = color_scale(property.type);
    }
  }
  // Whether x, y and z come first, as float32, and nothing else is of use.
  [[nodiscard]] bool is_float_xyz(const PlyElement& element) const {
    for (std::size_t i = 0; i < 3; ++i) {
      if (slots[i] != slot_x + i || element.properties[i].type != PlyType::float32) return false;
    }
    return std::all_of(slots.begin() + 3, slots.end(), [](Slot slot) { return slot == no_slot; }) &&
           std::ranges::none_of(element.properties, [](const PlyProperty& p) { return p.count_type.has_value(); });
  }
  [[nodiscard]] bool has(std::size_t first, std::size_t count) const {
    return std::all_of(present.begin() + static_cast<std::ptrdiff_t>(first),
                       present.begin() + static_cast<std::ptrdiff_t>(first + count), [](bool p) { return p; });
  }

  std::vector<Slot> slots;  // of each property
  std::array<bool, slot_count> present{};
  std::array<double, 4> color_scales;
};

template <class Values>
class BodyParser {
 public:
  BodyParser(Values values, const FileErrors& errors) : values_(std::move(values)), errors_(errors) {}

  PolygonSoup parse(const PlyHeader& header) && {
    for (const PlyElement& element : header.elements) {
      values_.begin_element(element);
      if (element.name == "vertex")
        read_vertices(element);
      else if (element.name == "face")
        read_faces(element);
      else
        skip_element(element);
    }
    soup_.check(errors_);
    return std::move(soup_);
  }

 private:
  void read_vertices(const PlyElement& element) {
    const VertexLayout layout(element);
    if (!layout.has(slot_x, 3)) errors_.fail("header", "vertices lack x, y or z", "export the mesh with coordinates");
    const bool normals = layout.has(slot_normal, 3);
    const bool colors = layout.has(slot_red, 3);
    soup_.positions.reserve(element.count);
    std::array<double, slot_count + 1> value{};  // the last takes what is not used
    value[slot_alpha] = 1.0;                     // opaque where there is no alpha
    const bool is_float_xyz = layout.is_float_xyz(element);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if constexpr (is_binary) {
        if (is_float_xyz) i += values_.take_float_vertices(element.count - i, record_bytes(element), soup_);
        if (i == element.count) break;
      }
      values_.begin_record(i);
      for (std::size_t p = 0; p < layout.slots.size(); ++p) {
        if (element.properties[p].count_type)
          skip_list(element.properties[p]);
        else
          value[layout.slots[p]] = values_.next(element.properties[p].type);
      }
      soup_.add_vertex(value[0], value[1], value[2], values_.line());
      if (normals) soup_.normals.emplace_back(to_float(value[3]), to_float(value[4]), to_float(value[5]));
      if (colors) soup_.colors.push_back(color(&value[slot_red], layout));
      values_.end_record();
    }
  }

  static std::size_t record_bytes(const PlyElement& element) {
    std::size_t bytes = 0;
    for (const PlyProperty& property : element.properties) bytes += size_of(property.type);
    return bytes;
  }

  static glm::u8vec4 color(const double* rgba, const VertexLayout& layout) {
    glm::u8vec4 result;
    for (int i = 0; i < 4; ++i) result[i] = color_component(rgba[i] * layout.color_scales[static_cast<std::size_t>(i)]);
    return result;
  }

  void read_faces(const PlyElement& element) {
    const auto is_corner_list = [](const PlyProperty& p) {
      return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
    };
    if (element.count > 0 && std::ranges::none_of(element.properties, is_corner_list)) {
      errors_.fail("header", "faces have no list 'vertex_indices'", "export the mesh with its faces");
    }
    const bool has_short_lists = has_short_lists_only(element);
    if constexpr (is_binary) {
      if (has_short_lists) soup_.reserve_polygons(std::min(element.count, values_.bytes_left() / triangle_bytes));
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if constexpr (is_binary) {
        if (has_short_lists) i += values_.take_triangles(element.count - i, soup_);
        if (i == element.count) break;
      }
      values_.begin_record(i);
      for (const PlyProperty& property : element.properties) {
        if (is_corner_list(property))
          read_corners(property);
        else
          skip(property);
      }
      soup_.end_polygon(values_.line());
      values_.end_record();
    }
  }

  // Whether faces are nothing but lists of 32-bit indices with a count of one byte.
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
  }

  std::uint64_t next_count(const PlyProperty& list) {
    const double count = values_.next(*list.count_type);
    if (!(count >= 0.0 && count <= 4294967295.0) || count != std::floor(count)) {
      values_.fail(fmt::format("the list {} has {} entries", in_quotes(list.name), count), "export the mesh again");
    }
    return static_cast<std::uint64_t>(count);
  }

  void skip_element(const PlyElement& element) {
    if (element.properties.empty()) return;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      values_.begin_record(i);
      for (const PlyProperty& property : element.properties) skip(property);
      values_.end_record();
    }
  }

  void skip(const PlyProperty& property) {
    if (property.count_type)
      skip_list(property);
    else
      static_cast<void>(values_.next(property.type));
  }

  void skip_list(const PlyProperty& property) {
    const std::uint64_t count = next_count(property);
    for (std::uint64_t i = 0; i < count; ++i) static_cast<void>(values_.next(property.type));
  }

  static constexpr bool is_binary = std::is_same_v<Values, BinaryValues>;

  Values values_;
  const FileErrors& errors_;
  PolygonSoup soup_;
};

// The beginning of the file with the whole header. Its last line is looked for as nearly every file has it; for others
// this is the whole file.
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

}  // namespace

PolygonSoup parse_ply(InputBytes& input, const FileErrors& errors) {
  const PlyHeader header = parse_ply_header(window_with_header(input), input.size(), errors);
  if (header.binary_order) {
    input.skip(header.body_offset);
    return BodyParser(BinaryValues(input, header, errors), errors).parse(header);
  }
  return BodyParser(AsciiValues(input.window(input.size()), header, errors), errors).parse(header);
}

}  // namespace occlod
