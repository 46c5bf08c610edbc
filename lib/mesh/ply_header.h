// The header of a PLY file: elements with their properties, in the order of the body.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/file_input.h"

namespace occlod {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

[[nodiscard]] std::size_t size_of(PlyType type) noexcept;
[[nodiscard]] constexpr bool is_integer(PlyType type) noexcept { return type < PlyType::float32; }

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;    // of the value, or of each value of a list
  std::optional<PlyType> count_type;  // a list's; always an integer type
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  std::optional<std::endian> binary_order;  // none for ascii
  std::vector<PlyElement> elements;
  std::size_t body_offset = 0;  // in bytes
  std::uint64_t body_line = 1;
  std::vector<std::string> texture_files;  // of comments "TextureFile NAME"
};

// Throws Error for anything that is not a PLY header, or that promises more elements than the file has room for.
// `bytes` is the beginning of a file of `file_bytes` bytes, up to the end of its header or beyond.
[[nodiscard]] PlyHeader parse_ply_header(std::string_view bytes, std::uint64_t file_bytes, const FileErrors& errors);

}  // namespace occlod
