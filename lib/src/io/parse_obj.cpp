// Our own reader: OpenMesh's skips vertex lines that it cannot parse, which shifts the index of every later
// vertex, and names no line in its messages.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "io/distinct_names.h"
#include "io/polygon_soup.h"
#include "io/text_cursor.h"

namespace occlod {
namespace {

// The file's indices count from 1, or back from the newest element with -1; ours count from 0.
struct ObjCorner {
  VertexId vertex;
  VertexId normal;  // no_id where there is none
};

class ObjParser {
 public:
  ObjParser(std::string_view bytes, const FileErrors& errors)
      : cursor_(bytes, errors, {.hash_comments = true, .backslash_continues = true}), errors_(errors) {}

  PolygonSoup parse() && {
    for (; cursor_.find_word(); cursor_.skip_line()) {
      const std::string_view keyword = cursor_.word();
      if (keyword == "v") read_vertex();
      if (keyword == "vn") read_normal();
      if (keyword == "f") read_face();
      if (keyword == "vt") ++soup_.left_out.texture_coordinates;
      if (keyword == "usemtl") materials_.add(cursor_.rest_of_line());
      if (keyword == "o") objects_.add(cursor_.rest_of_line());
      if (keyword == "g") groups_.add(cursor_.rest_of_line());
    }
    soup_.check(errors_, 1);
    resolve_normals();
    resolve_colors();
    soup_.left_out.materials = materials_.count();
    soup_.left_out.groups = objects_.count() + groups_.count();
    return std::move(soup_);
  }

 private:
  // x y z, x y z w (w only weighs curves) or x y z r g b; what follows is ignored.
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
    normals_.emplace_back(x, y, z);
  }

  void read_face() {
    const std::uint64_t line = cursor_.line();
    while (!cursor_.at_line_end()) {
      const ObjCorner corner = parse_corner(cursor_.word());
      soup_.add_corner(corner.vertex);
      if (corner.normal != no_id) normal_uses_.push_back(corner);
      if (corner.normal != no_id && corner.normal >= highest_normal_) {
        highest_normal_ = corner.normal;
        highest_normal_line_ = line;
      }
    }
    soup_.end_polygon(line);
  }

  // v, v/vt, v//vn or v/vt/vn. Texture coordinates are not used and their range is not checked.
  ObjCorner parse_corner(std::string_view text) {
    const char* at = text.data();
    const char* const end = at + text.size();
    ObjCorner corner{parse_index(at, end, soup_.positions.size(), text), no_id};
    if (at == end) return corner;
    if (!skip_slash(at, end)) bad_corner(text);
    if (at != end && *at != '/') static_cast<void>(parse_integer(at, end, text));
    if (at == end) return corner;
    if (!skip_slash(at, end)) bad_corner(text);
    corner.normal = parse_index(at, end, normals_.size(), text);
    if (at != end) bad_corner(text);
    return corner;
  }

  // Skips a slash that is followed by something.
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

  // The normal of a vertex is the sum over its corners; clean() brings it to unit length.
  void resolve_normals() {
    soup_.left_out.normals = normals_.size();
    if (normal_uses_.empty()) return;
    if (highest_normal_ >= normals_.size()) {
      errors_.fail_at_line(
          highest_normal_line_,
          fmt::format("a face uses normal {}, but there are {}", std::uint64_t{highest_normal_} + 1, normals_.size()),
          "export the mesh again");
    }
    soup_.normals.assign(soup_.positions.size(), glm::vec3(0.0f));
    std::vector<VertexId> first_normal(soup_.positions.size(), no_id);
    std::vector<bool> conflict(soup_.positions.size());
    for (const auto& [vertex, normal] : normal_uses_) {
      soup_.normals[vertex] += normals_[normal];
      if (first_normal[vertex] == no_id) first_normal[vertex] = normal;
      if (normals_[first_normal[vertex]] != normals_[normal]) conflict[vertex] = true;
    }
    for (const bool differs : conflict) soup_.attribute_conflicts += differs;
    std::vector<bool> used(normals_.size());
    for (const ObjCorner& corner : normal_uses_) used[corner.normal] = true;
    soup_.left_out.normals -= static_cast<std::uint64_t>(std::ranges::count(used, true));
  }

  // Components go up to 1, or up to 255 where any is larger than 1.
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

  static constexpr glm::vec3 no_color{-1.0f};  // of vertices in a file where only others have one: white

  TextCursor cursor_;
  const FileErrors& errors_;
  PolygonSoup soup_;
  std::vector<glm::vec3> normals_;
  std::vector<ObjCorner> normal_uses_;  // resolved at the end: a normal may follow the face that uses it
  VertexId highest_normal_ = 0;
  std::uint64_t highest_normal_line_ = 0;
  std::vector<glm::vec3> raw_colors_;
  DistinctNames materials_, objects_, groups_;
};

}  // namespace

PolygonSoup parse_obj(std::string_view text, const FileErrors& errors) { return ObjParser(text, errors).parse(); }

}  // namespace occlod
