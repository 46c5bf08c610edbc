// Packed files in memory, and such as lie.
#pragma once

#include <algorithm>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cells/packed_geometry.h"
#include "fuzz/memory_file.h"
#include "mesh/section_file.h"

namespace occlod::test {

// On no disk: thousands of files are opened.
class FileOf : public fuzz::MemoryFile {
 public:
  explicit FileOf(const std::string& bytes)
      : MemoryFile(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()) {}
};

[[nodiscard]] inline std::vector<sections::Section> sections_of(const std::string& bytes) {
  sections::FileHeader header;
  std::memcpy(&header, bytes.data(), sizeof(header));
  std::vector<sections::Section> table(header.section_count);
  std::memcpy(table.data(), bytes.data() + sizeof(header), table.size() * sizeof(sections::Section));
  return table;
}

// A file with some elements of a section changed, and all checksums put right: `lie` gets them, and what it changes
// in section GEOM its frames say, too.
template <typename T>
[[nodiscard]] std::string with_lie(std::string bytes, std::string_view name,
                                   const std::function<void(std::span<T>)>& lie) {
  std::vector<sections::Section> table = sections_of(bytes);
  const auto section = [&](std::string_view of) -> sections::Section& {
    return *std::ranges::find_if(table,
                                 [&](const sections::Section& s) { return std::string_view(s.name.data(), 4) == of; });
  };
  const auto elements = [&]<typename E>(std::string_view of, E) {
    return std::span(reinterpret_cast<E*>(bytes.data() + section(of).offset), section(of).bytes / sizeof(E));
  };
  lie(elements(name, T{}));
  const auto geometry = elements(vlod::geometry_name, std::byte{});
  for (vlod::FrameRow& frame : elements(vlod::frames_name, vlod::FrameRow{}))
    if (frame.offset <= geometry.size() && frame.bytes <= geometry.size() - frame.offset)
      frame.checksum = sections::checksum_of(geometry.subspan(frame.offset, frame.bytes));
  for (sections::Section& s : table)
    if (s.checksum != 0) s.checksum = sections::checksum_of(std::as_bytes(std::span(bytes)).subspan(s.offset, s.bytes));
  sections::FileHeader header;
  std::memcpy(&header, bytes.data(), sizeof(header));
  header.table_checksum = sections::checksum_of(std::as_bytes(std::span(table)));
  std::memcpy(bytes.data(), &header, sizeof(header));
  std::memcpy(bytes.data() + sizeof(header), table.data(), table.size() * sizeof(sections::Section));
  return bytes;
}

}  // namespace occlod::test
