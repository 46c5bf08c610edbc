// Our own OFF reader: OpenMesh's reader trusts the counts in the header, continues after a failed extraction and
// depends on the stream's locale, and its messages name no line.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/text.h"
#include "mesh/polygon_soup.h"
#include "mesh/vertex_colors.h"

namespace occlod {
namespace {

// The values on each vertex line after its coordinates: [ST][C][N]OFF, in the order normal, colour, texture.
struct OffFormat {
  bool texture = false;
  bool color = false;
  bool normal = false;
};

class OffParser {
 public:
  OffParser(std::string_view bytes, const FileErrors& errors) : bytes_(bytes), cursor_(bytes, errors, syntax) {}

  PolygonSoup parse() && {
    read_keyword();
    const std::uint64_t vertices = read_count("the number of vertices");
    const std::uint64_t faces = read_count("the number of faces");
    // The shortest lines are "0 0 0" and "3"; the number of edges is optional, often wrong and not used.
    check_room("vertices", vertices, 6);
    check_room("faces", faces, 2);
    cursor_.skip_line();
    soup_.positions.reserve(vertices);
    for (std::uint64_t i = 0; i < vertices; ++i) read_vertex(i, vertices);
    for (std::uint64_t i = 0; i < faces; ++i) read_face(i, faces);
    soup_.check(cursor_.errors());
    colors_.resolve(soup_);
    count_left_out();
    return std::move(soup_);
  }

 private:
  // Reads the keyword, which may be missing; the counts may follow it on the same line, and in many files of ModelNet
  // without a blank ("OFF8 6 0").
  void read_keyword() {
    find_line("the header");
    TextCursor ahead = cursor_;
    const std::string_view keyword = ahead.word();
    if (keyword.find_first_not_of("0123456789") == std::string_view::npos) return;
    std::string_view rest = keyword;
    format_.texture = take_prefix(rest, "ST");
    format_.color = take_prefix(rest, "C");
    format_.normal = take_prefix(rest, "N");
    const bool is_known = take_prefix(rest, "OFF") || take_prefix(rest, "off");
    if (!is_known || rest.find_first_not_of("0123456789") != std::string_view::npos) {
      cursor_.fail(
          fmt::format("the header {} is not OFF, NOFF, COFF, CNOFF or one of these with ST", in_quotes(keyword)),
          "export the mesh as OFF with three coordinates a vertex");
    }
    if (!rest.empty()) {
      const auto place = static_cast<std::size_t>(rest.data() - bytes_.data());
      cursor_ = TextCursor(bytes_.substr(place), cursor_.errors(), syntax, ahead.line());
      return;
    }
    cursor_ = ahead;
    if (ahead.word() == "BINARY") cursor_.fail("binary OFF is not read", "export the mesh as text or as PLY");
  }

  static bool take_prefix(std::string_view& text, std::string_view prefix) {
    if (!text.starts_with(prefix)) return false;
    text.remove_prefix(prefix.size());
    return true;
  }

  void find_line(const char* what) {
    if (!cursor_.find_word()) cursor_.fail(fmt::format("the file ends before {}", what), "export the mesh again");
  }

  // Moves to the line of element `i` of `count`.
  void find_line(const char* what, std::uint64_t i, std::uint64_t count) {
    if (cursor_.find_word()) return;
    cursor_.fail(fmt::format("the file ends before {} {} of {}", what, i + 1, count),
                 "the file is cut short or its header is wrong; export the mesh again");
  }

  std::uint64_t read_count(const char* what) {
    find_line(what);
    const std::int64_t count = cursor_.integer(what);
    if (count < 0) cursor_.fail(fmt::format("{} is negative", what), "export the mesh again");
    return static_cast<std::uint64_t>(count);
  }

  void check_room(const char* what, std::uint64_t count, std::size_t shortest_line) const {
    if (count <= (cursor_.bytes_left() + 1) / shortest_line) return;
    cursor_.fail(fmt::format("{} {} do not fit in a file of this size", count, what),
                 "the file is cut short or its header is wrong; export the mesh again");
  }

  void read_vertex(std::uint64_t i, std::uint64_t count) {
    find_line("vertex", i, count);
    const double x = cursor_.number("x of a vertex");
    const double y = cursor_.number("y of a vertex");
    const double z = cursor_.number("z of a vertex");
    soup_.add_vertex(x, y, z, cursor_.line());
    if (format_.normal) read_normal();
    if (i == 0 && !format_.normal && !format_.texture)
      has_undeclared_color_ = !format_.color && cursor_.words_left() == 4;
    if (format_.color || (has_undeclared_color_ && cursor_.words_left() == 4)) read_color(i);
    if (format_.texture) read_texture_coordinate();
    if (!cursor_.at_line_end()) values_after_vertices_ += cursor_.words_left();
    cursor_.skip_line();
  }

  void read_normal() {
    const float x = to_float(cursor_.number("x of a normal"));
    const float y = to_float(cursor_.number("y of a normal"));
    const float z = to_float(cursor_.number("z of a normal"));
    soup_.normals.emplace_back(x, y, z);
  }

  // Reads a colour of three or four components; only their number tells whether there is alpha.
  void read_color(std::size_t vertex) {
    const std::size_t words = cursor_.words_left(), fewest = format_.texture ? 5 : 3;
    if (words < fewest)
      cursor_.fail("a vertex of a COFF file needs three or four colour numbers", "export the mesh again");
    glm::vec4 color(0.0F, 0.0F, 0.0F, VertexColors<InMemory>::no_alpha);
    for (int i = 0; i < (words == fewest ? 3 : 4); ++i) color[i] = to_float(cursor_.number("a colour"));
    colors_.add(vertex, color);
  }

  void read_texture_coordinate() {
    const float s = to_float(cursor_.number("s of a texture coordinate"));
    const float t = to_float(cursor_.number("t of a texture coordinate"));
    soup_.texture_coordinates.emplace_back(s, t);
  }

  // Reads a face; a colour after its corners is only counted.
  void read_face(std::uint64_t i, std::uint64_t count) {
    find_line("face", i, count);
    const std::int64_t corners = cursor_.integer("the number of corners of a face");
    for (std::int64_t corner = 0; corner < corners; ++corner) {
      const std::int64_t vertex = cursor_.integer("a corner of a face");
      if (vertex < 0 || vertex >= std::int64_t{no_id}) {
        cursor_.fail(fmt::format("a face uses vertex {}, which is out of range", vertex), "export the mesh again");
      }
      soup_.add_corner(static_cast<VertexId>(vertex));
    }
    face_colors_ += cursor_.at_line_end() ? 0U : 1U;
    soup_.end_polygon(cursor_.line());
    cursor_.skip_line();
  }

  void count_left_out() {
    std::uint64_t lines = 0;
    for (; cursor_.find_word(); cursor_.skip_line()) ++lines;
    soup_.left_out.add("face colours", face_colors_);
    soup_.left_out.add("values at the ends of vertex lines", values_after_vertices_);
    soup_.left_out.add("lines after the last face", lines);
  }

  static constexpr TextCursor::Syntax syntax{.hash_comments = true};

  std::string_view bytes_;
  TextCursor cursor_;
  OffFormat format_;
  bool has_undeclared_color_ =
      false;  // red, green, blue and alpha on the first vertex line, which the header does not name
  VertexColors<InMemory> colors_;
  std::uint64_t face_colors_ = 0, values_after_vertices_ = 0;
  PolygonSoup soup_;
};

}  // namespace

PolygonSoup parse_off(std::string_view text, const FileErrors& errors) { return OffParser(text, errors).parse(); }

}  // namespace occlod
