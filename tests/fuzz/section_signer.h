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

#include "mesh/section_file.h"

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
    table_.resize(std::min<std::size_t>({header.section_count, room, sections::max_sections}));
    const auto table = std::as_writable_bytes(std::span(table_));
    if (table_.empty()) return;
    std::memcpy(table.data(), file_.data() + sizeof(header), table.size());
    contents_.clear();
    for (const sections::Section& section : table_) contents_.push_back(contents_of(section));
    sign_parts();
    for (std::size_t i = 0; i < table_.size(); ++i)
      if (table_[i].checksum != 0) table_[i].checksum = sections::checksum_of(contents_[i].bytes);
    header.table_checksum = sections::checksum_of(table);
    std::memcpy(file_.data() + sizeof(header), table.data(), table.size());
    std::memcpy(file_.data(), &header, sizeof(header));
  }

  // The elements of the first section of this name, unpacked; nothing where it lies outside the file or cannot be
  // unpacked. What is written to packed elements does not reach the file.
  template <typename T>
  [[nodiscard]] std::span<T> find(std::string_view name) const {
    for (std::size_t i = 0; i < table_.size(); ++i) {
      if (std::string_view(table_[i].name.data(), table_[i].name.size()) != name) continue;
      const std::span<std::byte> bytes = contents_[i].bytes;
      if (table_[i].offset % sections::alignment != 0) return {};
      return {reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T)};
    }
    return {};
  }

 private:
  struct Contents {
    std::vector<std::byte> unpacked;
    std::span<std::byte> bytes;  // of the file or of `unpacked`
  };

  [[nodiscard]] Contents contents_of(const sections::Section& section) const {
    if (section.offset > file_.size() || section.bytes > file_.size() - section.offset) return {};
    const std::span<std::byte> bytes = std::span(file_).subspan(section.offset, section.bytes);
    if (section.codec == sections::Codec::stored) return {{}, bytes};
    if (section.codec != sections::Codec::zstd || section.element_bytes == 0 ||
        section.element_bytes > largest_element || !olod::is_plausible(section.bytes, section.raw_bytes))
      return {};
    Contents contents{std::vector<std::byte>(section.raw_bytes), {}};
    if (olod::unpack(bytes, section.element_bytes, contents.unpacked)) contents.bytes = contents.unpacked;
    return contents;
  }

  static constexpr std::uint32_t largest_element = 4096;  // bytes; readers know no larger ones

  std::vector<std::byte>& file_;
  const sections::FileKind& kind_;
  std::vector<sections::Section> table_;
  std::vector<Contents> contents_;  // of the sections of the table
};

}  // namespace occlod::fuzz
