// Our own STL reader: OpenMesh's reader drops degenerate facets silently and merges corners through a std::map. Here
// every facet keeps its own three vertices; clean() welds and counts.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <string>
#include <utility>

#include "base/text.h"
#include "mesh/polygon_soup.h"

namespace occlod {
namespace {

constexpr std::size_t stl_header_size = 80;
constexpr std::size_t stl_prefix_size = stl_header_size + 4;  // the header and the number of facets
constexpr std::size_t stl_facet_size = 50;                    // normal, three corners, two bytes of attributes

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return lower(x) == lower(y); });
}

class AsciiStlParser {
 public:
  AsciiStlParser(std::string_view bytes, const FileErrors& errors) : cursor_(bytes, errors, {}) {}

  // Reads any number of solids, one after the other.
  PolygonSoup parse() && {
    while (cursor_.find_word()) {
      expect("solid");
      solids_.add(cursor_.rest_of_line());
      cursor_.skip_line();
      while (next_keyword("facet", "endsolid")) read_facet();
      cursor_.skip_line();
    }
    soup_.check(cursor_.errors());
    soup_.left_out.add("facet normals", facets_);
    soup_.left_out.add("solids", solids_.count());
    return std::move(soup_);
  }

 private:
  void read_facet() {
    cursor_.skip_line();  // the normal
    ++facets_;
    const std::uint64_t line = cursor_.line();
    expect("outer");
    expect("loop");
    while (next_keyword("vertex", "endloop")) {
      const double x = cursor_.number("x of a vertex");
      const double y = cursor_.number("y of a vertex");
      const double z = cursor_.number("z of a vertex");
      soup_.add_corner(static_cast<VertexId>(soup_.positions.size()));
      soup_.add_vertex(x, y, z, cursor_.line());
    }
    soup_.end_polygon(line);
    expect("endfacet");
  }

  std::string_view next_word(const char* wanted) {
    if (!cursor_.find_word())
      cursor_.fail(fmt::format("the file ends before {}", in_quotes(wanted)), "export the mesh again");
    return cursor_.word();
  }

  void expect(const char* keyword) {
    const std::string_view word = next_word(keyword);
    if (!equal_ignoring_case(word, keyword)) unexpected(word, fmt::format("'{}'", keyword));
  }

  // Returns true for `keyword`, false for `end`.
  bool next_keyword(const char* keyword, const char* end) {
    const std::string_view word = next_word(end);
    if (equal_ignoring_case(word, keyword)) return true;
    if (!equal_ignoring_case(word, end)) unexpected(word, fmt::format("'{}' or '{}'", keyword, end));
    return false;
  }

  [[noreturn]] void unexpected(std::string_view word, const std::string& wanted) const {
    cursor_.fail(fmt::format("expected {}, but found {}", wanted, in_quotes(word)), "export the mesh again");
  }

  TextCursor cursor_;
  PolygonSoup soup_;
  DistinctNames solids_;
  std::uint64_t facets_ = 0;
};

PolygonSoup parse_binary(std::string_view bytes, std::size_t facets, const FileErrors& errors) {
  PolygonSoup soup;
  if (3 * facets >= max_vertices) errors.fail("", "has too many facets", "split the mesh into parts");
  soup.positions.reserve(3 * facets);
  std::uint64_t attributes = 0;  // facets with attribute bytes, which programs use as they like, often for colours
  for (std::size_t facet = 0; facet < facets; ++facet) {
    const char* at = bytes.data() + stl_prefix_size + facet * stl_facet_size + 3 * sizeof(float);
    for (int corner = 0; corner < 3; ++corner, at += 3 * sizeof(float)) {
      soup.add_corner(static_cast<VertexId>(soup.positions.size()));
      soup.add_vertex(load<float>(at, std::endian::little), load<float>(at + 4, std::endian::little),
                      load<float>(at + 8, std::endian::little), 0);
    }
    soup.end_polygon(0);
    attributes += load<std::uint16_t>(at, std::endian::little) != 0;
  }
  soup.left_out.add("facet normals", facets);
  soup.left_out.add("facet attributes", attributes);
  soup.check(errors);
  return soup;
}

bool begins_with_solid(std::string_view bytes) {
  const std::size_t first = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  return equal_ignoring_case(bytes.substr(first, 5), "solid");
}

}  // namespace

// Recognises binary files by their size, because many binary files begin with "solid" as well.
PolygonSoup parse_stl(std::string_view bytes, const FileErrors& errors) {
  std::string converted;
  if (bytes.size() < stl_prefix_size) return AsciiStlParser(as_utf8(bytes, converted, errors), errors).parse();
  const std::size_t facets = load<std::uint32_t>(bytes.data() + stl_header_size, std::endian::little);
  const std::size_t room = (bytes.size() - stl_prefix_size) / stl_facet_size;
  if (bytes.size() == stl_prefix_size + facets * stl_facet_size) return parse_binary(bytes, facets, errors);
  const std::string_view text = as_utf8(bytes, converted, errors);
  if (begins_with_solid(text)) return AsciiStlParser(text, errors).parse();
  if (facets <= room) return parse_binary(bytes, facets, errors);
  errors.fail("byte 80", fmt::format("promises {} facets, but the file has room for {}", facets, room),
              "the file is cut short or no STL; export the mesh again");
}

}  // namespace occlod
