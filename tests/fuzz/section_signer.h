// Files of sections whose checksums are put right: damage by chance is found by them, what fuzzing is to find is what a
// hostile file can do.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "io/section_file.h"

namespace occlod::fuzz {

class SectionSigner {
 public:
  // `file` outlives it.
  SectionSigner(std::vector<std::byte>& file, const sections::FileKind& kind) : file_(file), kind_(kind) {}

  // Calls sign_parts() for the digests of parts of sections before the sections themselves are signed.
  template <typename SignParts>
  void sign(const SignParts& sign_parts) {
    sections::FileHeader header;
    if (file_.size() < sizeof(header)) return;
    std::memcpy(&header, file_.data(), sizeof(header));
    header.magic = kind_.magic;
    header.version = kind_.version;
    header.file_bytes = file_.size();
    const std::size_t room = (file_.size() - sizeof(header)) / sizeof(sections::Section);
    table_.resize(std::min<std::size_t>({header.section_count, room, sections::most_sections}));
    const auto table = std::as_writable_bytes(std::span(table_));
    if (table_.empty()) return;
    std::memcpy(table.data(), file_.data() + sizeof(header), table.size());
    sign_parts();
    for (sections::Section& section : table_)
      if (section.checksum != 0) section.checksum = sections::checksum_of(bytes_of(section));
    header.table_checksum = sections::checksum_of(table);
    std::memcpy(file_.data() + sizeof(header), table.data(), table.size());
    std::memcpy(file_.data(), &header, sizeof(header));
  }

  // The elements of the section of this name; nothing where they lie outside the file or are packed.
  template <typename T>
  [[nodiscard]] std::span<T> find(std::string_view name) const {
    for (const sections::Section& section : table_) {
      if (std::string_view(section.name.data(), section.name.size()) != name) continue;
      const std::span<std::byte> bytes = bytes_of(section);
      if (section.offset % sections::alignment != 0) return {};
      return {reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T)};
    }
    return {};
  }

 private:
  // Nothing where they lie outside the file or are packed.
  [[nodiscard]] std::span<std::byte> bytes_of(const sections::Section& section) const {
    if (section.codec != sections::Codec::stored || section.offset > file_.size() ||
        section.bytes > file_.size() - section.offset)
      return {};
    return std::span(file_).subspan(section.offset, section.bytes);
  }

  std::vector<std::byte>& file_;
  const sections::FileKind& kind_;
  std::vector<sections::Section> table_;
};

}  // namespace occlod::fuzz
