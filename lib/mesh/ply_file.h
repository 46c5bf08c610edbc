// PLY files: the header, with elements and their properties in the order of the body, and the values of the body.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/file_input.h"
#include "base/text.h"
#include "mesh/polygon_soup.h"

namespace occlod {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

[[nodiscard]] std::size_t size_of(PlyType type) noexcept;
[[nodiscard]] constexpr bool is_integer(PlyType type) noexcept { return type < PlyType::float32; }

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;    // type of the value, or of each value of a list
  std::optional<PlyType> count_type;  // of a list; always an integer type
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  std::optional<std::endian> binary_order;  // empty for ascii
  std::vector<PlyElement> elements;
  std::size_t body_offset = 0;  // in bytes
  std::uint64_t body_line = 1;
  std::vector<std::string> texture_files;  // from comments "TextureFile NAME"
  std::uint64_t info_lines = 0;            // obj_info
};

// Parses a header. Throws Error for anything that is not a PLY header, or that promises more elements than the file has
// room for. `bytes` is the beginning of a file of `file_bytes` bytes, up to the end of its header or beyond.
[[nodiscard]] PlyHeader parse_ply_header(std::string_view bytes, std::uint64_t file_bytes, const FileErrors& errors);

// The classes below read the values of a body as doubles, which hold every PLY type exactly but 64-bit integers beyond
// 2^53, which no index or count reaches. A record is one instance of an element.

inline constexpr const char* ply_cut_short = "the file is cut short or its header is wrong; export the mesh again";

class AsciiValues {
 public:
  // `input` is at the beginning of the body.
  AsciiValues(InputBytes& input, const PlyHeader& header, const FileErrors& errors)
      : chunks_(input, errors, {}), cursor_({}, errors, {}, header.body_line) {}

  void begin_element(const PlyElement& element) {
    element_ = &element;
    what_ = fmt::format("a value of element {}", in_quotes(element.name));
  }
  void begin_record(std::uint64_t i) {
    while (!cursor_.find_word()) {
      if (chunks_.next(cursor_)) continue;
      fail(fmt::format("the file ends before {} {} of {}", element_->name, i + 1, element_->count), ply_cut_short);
    }
  }
  [[nodiscard]] double next(PlyType) { return cursor_.number(what_.c_str()); }
  // Returns the number of values on the line that the header does not name.
  [[nodiscard]] std::uint64_t end_record() {
    const std::uint64_t more = cursor_.at_line_end() ? 0 : cursor_.words_left();
    cursor_.skip_line();
    return more;
  }
  // Skips what follows the body and says what it is.
  [[nodiscard]] std::pair<std::string_view, std::uint64_t> rest() {
    std::uint64_t lines = 0;
    while (cursor_.find_word() || chunks_.next(cursor_)) {
      if (cursor_.find_word()) ++lines;
      cursor_.skip_line();
    }
    return {"lines after the last element", lines};
  }

  [[nodiscard]] std::uint64_t line() const { return cursor_.line(); }
  [[noreturn]] void fail(std::string problem, std::string remedy) const {
    cursor_.fail(std::move(problem), std::move(remedy));
  }

 private:
  TextChunks chunks_;
  TextCursor cursor_;
  const PlyElement* element_ = nullptr;
  std::string what_;
};

inline constexpr std::size_t ply_triangle_bytes = 13;  // a count of one byte and three indices of 32 bits

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
      fail(fmt::format("the file ends here, within {} {}s", element_->count, element_->name), ply_cut_short);
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
      case PlyType::int64:
        return static_cast<double>(load<std::int64_t>(value, order_));
      case PlyType::uint64:
        return static_cast<double>(load<std::uint64_t>(value, order_));
      case PlyType::float32:
        return load<float>(value, order_);
      case PlyType::float64:
        return load<double>(value, order_);
    }
    return 0.0;
  }
  [[nodiscard]] static std::uint64_t end_record() { return 0; }
  [[nodiscard]] std::pair<std::string_view, std::uint64_t> rest() const {
    return {"bytes after the last element", bytes_left()};
  }

  // Takes up to `most` vertices whose records begin with x, y and z as float32; returns how many. Vertices at the end
  // of the window are left to next().
  template <class Soup>
  std::uint64_t take_float_vertices(std::uint64_t most, std::size_t record_bytes, Soup& soup) {
    const std::uint64_t count = std::min<std::uint64_t>(most, left_.size() / record_bytes);
    const char* at = left_.data();
    for (std::uint64_t i = 0; i < count; ++i, at += record_bytes) {
      soup.add_vertex(load<float>(at, order_), load<float>(at + 4, order_), load<float>(at + 8, order_), 0);
    }
    left_.remove_prefix(count * record_bytes);
    return count;
  }

  // Takes up to `most` triangles whose records are a count of one byte and three indices of 32 bits; returns how many.
  // Stops at the first face that is not a triangle or has an index that next() must refuse, and at the end of the
  // window.
  template <class Soup>
  std::uint64_t take_triangles(std::uint64_t most, Soup& soup) {
    const std::uint64_t count = std::min<std::uint64_t>(most, left_.size() / ply_triangle_bytes);
    const char* at = left_.data();
    std::uint64_t taken = 0;
    for (; taken < count && *at == 3; ++taken, at += ply_triangle_bytes) {
      const Triangle triangle(load<VertexId>(at + 1, order_), load<VertexId>(at + 5, order_),
                              load<VertexId>(at + 9, order_));
      if (std::max({triangle.x, triangle.y, triangle.z}) > largest_int) break;
      soup.add_triangle(triangle);
    }
    left_.remove_prefix(taken * ply_triangle_bytes);
    return taken;
  }

  [[nodiscard]] std::uint64_t bytes_left() const { return input_.size() - input_.offset() - (seen_ - left_.size()); }
  [[nodiscard]] std::uint64_t line() const { return 0; }
  [[noreturn]] void fail(std::string problem, std::string remedy) const {
    const std::uint64_t byte = input_.offset() + (seen_ - left_.size());
    errors_.fail(fmt::format("{} {}, byte {}", element_->name, record_, byte), std::move(problem), std::move(remedy));
  }

 private:
  // The largest index with the same bits as a signed and an unsigned 32-bit integer.
  static constexpr VertexId largest_int = 0x7fffffff;

  std::string_view look_further(std::size_t least) {
    input_.skip(seen_ - left_.size());
    left_ = input_.window(least);
    seen_ = left_.size();
    return left_;
  }

  InputBytes& input_;
  std::string_view left_;  // unread part of the window
  std::size_t seen_ = 0;   // size of the window
  std::endian order_;
  const FileErrors& errors_;
  const PlyElement* element_ = nullptr;
  std::uint64_t record_ = 0;
};

}  // namespace occlod
