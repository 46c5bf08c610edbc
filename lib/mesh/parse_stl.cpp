// Our own STL reader: OpenMesh's reader drops degenerate facets silently and merges corners through a std::map. Here
// every facet keeps its own three vertices; clean() welds and counts.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
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

// One or more binary files, one after the other.
class BinaryStlParser {
 public:
  BinaryStlParser(std::string_view bytes, const FileErrors& errors) : bytes_(bytes), errors_(errors) {}

  // Reads the facets that the header counts, then those of files that follow as a whole. What remains is counted.
  PolygonSoup parse() && {
    const bool is_whole = (bytes_.size() - stl_prefix_size) % stl_facet_size == 0;
    // Programs that write to a pipe cannot go back to fill in the number, and leave 0.
    const std::size_t first = facets_at(bytes_) == 0 && is_whole ? room(bytes_) : facets_at(bytes_);
    soup_.positions.reserve(3 * first);
    read_file(first);
    while (const std::size_t facets = facets_at(bytes_)) {
      if (facets > room(bytes_)) break;
      read_file(facets);
    }
    soup_.left_out.add("facet normals", soup_.polygon_count());
    soup_.left_out.add("facets with attribute bytes", attributes_);
    soup_.left_out.add("bytes after the last facet", bytes_.size());
    soup_.check(errors_);
    return std::move(soup_);
  }

  // Returns the number of facets that the header promises, 0 where there is no header.
  static std::size_t facets_at(std::string_view bytes) {
    return bytes.size() < stl_prefix_size ? 0
                                          : load<std::uint32_t>(bytes.data() + stl_header_size, std::endian::little);
  }
  static std::size_t room(std::string_view bytes) { return (bytes.size() - stl_prefix_size) / stl_facet_size; }

 private:
  void read_file(std::size_t facets) {
    if (soup_.positions.size() + 3 * facets >= max_vertices)
      errors_.fail("", "has too many facets", "split the mesh into parts");
    // As Materialise Magics writes the colour and the material of all facets.
    for (const std::string_view key : {"COLOR=", "MATERIAL="}) {
      if (bytes_.substr(0, stl_header_size).find(key) != std::string_view::npos)
        soup_.left_out.add(std::string(key) + " of the header");
    }
    bytes_.remove_prefix(stl_prefix_size);
    for (std::size_t facet = 0; facet < facets; ++facet) read_facet(bytes_.data() + facet * stl_facet_size);
    bytes_.remove_prefix(facets * stl_facet_size);
  }

  void read_facet(const char* at) {
    at += 3 * sizeof(float);  // the normal
    for (int corner = 0; corner < 3; ++corner, at += 3 * sizeof(float)) {
      soup_.add_corner(static_cast<VertexId>(soup_.positions.size()));
      soup_.add_vertex(load<float>(at, std::endian::little), load<float>(at + 4, std::endian::little),
                       load<float>(at + 8, std::endian::little), 0);
    }
    soup_.end_polygon(0);
    attributes_ += load<std::uint16_t>(at, std::endian::little) != 0;
  }

  std::string_view bytes_;  // not read yet
  const FileErrors& errors_;
  PolygonSoup soup_;
  std::uint64_t attributes_ = 0;  // facets with attribute bytes, which programs use as they like, often for colours
};

}  // namespace

// Many binary files begin with "solid" as well. They are told from texts by their number of facets, for which they have
// room: as a number, any four characters of a text ask for gigabytes.
PolygonSoup parse_stl(std::string_view bytes, const FileErrors& errors) {
  std::string converted;
  if (bytes.size() < stl_prefix_size) return AsciiStlParser(as_utf8(bytes, converted, errors), errors).parse();
  const std::size_t facets = BinaryStlParser::facets_at(bytes), room = BinaryStlParser::room(bytes);
  const bool is_exact = bytes.size() == stl_prefix_size + facets * stl_facet_size;
  if (is_exact || (facets <= room && !is_wide_text(bytes))) return BinaryStlParser(bytes, errors).parse();
  const std::string_view text = as_utf8(bytes, converted, errors);
  const bool has_zeros = text.substr(0, 2 * stl_prefix_size).find('\0') != std::string_view::npos;
  if (!has_zeros) return AsciiStlParser(text, errors).parse();
  errors.fail("byte 80", fmt::format("promises {} facets, but the file has room for {}", facets, room),
              "the file is cut short or no STL; export the mesh again");
}

}  // namespace occlod
