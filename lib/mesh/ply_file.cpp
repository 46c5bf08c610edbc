#include "mesh/ply_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/text.h"

namespace occlod {
namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};

constexpr std::array<TypeName, 18> type_names{{{"char", PlyType::int8},
                                               {"int8", PlyType::int8},
                                               {"uchar", PlyType::uint8},
                                               {"uint8", PlyType::uint8},
                                               {"short", PlyType::int16},
                                               {"int16", PlyType::int16},
                                               {"ushort", PlyType::uint16},
                                               {"uint16", PlyType::uint16},
                                               {"int", PlyType::int32},
                                               {"int32", PlyType::int32},
                                               {"uint", PlyType::uint32},
                                               {"uint32", PlyType::uint32},
                                               {"int64", PlyType::int64},
                                               {"uint64", PlyType::uint64},
                                               {"float", PlyType::float32},
                                               {"float32", PlyType::float32},
                                               {"double", PlyType::float64},
                                               {"float64", PlyType::float64}}};

class HeaderParser {
 public:
  HeaderParser(std::string_view bytes, std::uint64_t file_bytes, const FileErrors& errors)
      : cursor_(bytes, errors, {}), file_bytes_(file_bytes) {}

  PlyHeader parse() && {
    if (next_line() != "ply") cursor_.fail("the file does not begin with 'ply'", "check that it is a PLY file");
    cursor_.skip_line();
    for (;;) {
      const std::string_view keyword = next_line();
      if (keyword == "end_header") break;
      if (keyword == "format")
        read_format();
      else if (keyword == "element")
        read_element();
      else if (keyword == "property")
        read_property();
      else if (keyword == "comment")
        read_comment();
      else if (keyword == "obj_info")
        ++header_.info_lines;
      else {
        cursor_.fail(fmt::format("the header line begins with {}", in_quotes(keyword)), "export the mesh again");
      }
      cursor_.skip_line();
    }
    if (!has_format_) cursor_.fail("the header has no format line", "export the mesh again");
    cursor_.skip_line();
    header_.body_offset = cursor_.offset();
    header_.body_line = cursor_.line();
    for (const PlyElement& element : header_.elements) check_room(element);
    return std::move(header_);
  }

 private:
  std::string_view next_line() {
    if (!cursor_.find_word()) cursor_.fail("the file ends inside the header", "export the mesh again");
    return cursor_.word();
  }

  void read_format() {
    const std::string_view format = cursor_.word();
    if (format == "binary_little_endian")
      header_.binary_order = std::endian::little;
    else if (format == "binary_big_endian")
      header_.binary_order = std::endian::big;
    else if (format != "ascii")
      cursor_.fail(fmt::format("the format {} is unknown", in_quotes(format)), "export the mesh again");
    has_format_ = true;
  }

  void read_comment() {
    if (cursor_.word() != "TextureFile") return;
    const std::string_view name = cursor_.rest_of_line();
    if (!name.empty()) header_.texture_files.emplace_back(name);
  }

  void read_element() {
    PlyElement element;
    element.name = cursor_.word();
    const std::int64_t count = cursor_.integer("the number of elements");
    if (count < 0) cursor_.fail("the number of elements is negative", "export the mesh again");
    element.count = static_cast<std::uint64_t>(count);
    const auto same_name = [&](const PlyElement& other) { return other.name == element.name; };
    if (std::ranges::any_of(header_.elements, same_name)) {
      cursor_.fail(fmt::format("there is a second element {}", in_quotes(element.name)), "export the mesh again");
    }
    header_.elements.push_back(std::move(element));
  }

  void read_property() {
    if (header_.elements.empty()) cursor_.fail("a property comes before the first element", "export the mesh again");
    std::vector<PlyProperty>& properties = header_.elements.back().properties;
    PlyProperty property;
    std::string_view type = cursor_.word();
    if (type == "list") {
      property.count_type = parse_type(cursor_.word());
      if (!is_integer(*property.count_type))
        cursor_.fail("the count of a list is not of an integer type", "export the mesh again");
      type = cursor_.word();
    }
    property.type = parse_type(type);
    property.name = cursor_.rest_of_line();  // names of scalar fields may have blanks
    if (property.name.empty()) cursor_.fail("a property has no name", "export the mesh again");
    const auto same_name = [&](const PlyProperty& other) { return other.name == property.name; };
    if (std::ranges::any_of(properties, same_name)) {
      cursor_.fail(fmt::format("there is a second property {}", in_quotes(property.name)), "export the mesh again");
    }
    properties.push_back(std::move(property));
  }

  PlyType parse_type(std::string_view name) const {
    for (const TypeName& known : type_names) {
      if (known.name == name) return known.type;
    }
    cursor_.fail(fmt::format("the type {} is unknown", in_quotes(name)), "export the mesh again");
  }

  // Throws Error when the file is too short for the element's count. In text a number takes at least a digit and a
  // blank, and an empty list at least its count.
  void check_room(const PlyElement& element) const {
    std::size_t smallest = 0;
    for (const PlyProperty& property : element.properties) {
      smallest += header_.binary_order ? size_of(property.count_type.value_or(property.type)) : 2;
    }
    // The last line may have no line break.
    const std::uint64_t room = file_bytes_ - header_.body_offset + (header_.binary_order ? 0 : 1);
    if (smallest == 0 || element.count <= room / smallest) return;
    cursor_.errors().fail(
        "header",
        fmt::format("{} elements {} do not fit in a file of this size", element.count, in_quotes(element.name)),
        "the file is cut short or its header is wrong; export the mesh again");
  }

  TextCursor cursor_;
  std::uint64_t file_bytes_;
  PlyHeader header_;
  bool has_format_ = false;
};

}  // namespace

std::size_t size_of(PlyType type) noexcept {
  constexpr std::array<std::size_t, 10> sizes{1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

PlyHeader parse_ply_header(std::string_view bytes, std::uint64_t file_bytes, const FileErrors& errors) {
  return HeaderParser(bytes, file_bytes, errors).parse();
}

}  // namespace occlod
