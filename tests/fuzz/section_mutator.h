// Mutates some sections of a file and leaves the others as they are: blind mutations of whole files seldom get past the
// checks of tables.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh/section_file.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace occlod::fuzz {

class SectionMutator {
 public:
  // The header with the table of sections, and the sections of these names.
  struct Part {
    bool has_header = false;
    std::vector<std::string_view> sections;
  };

  explicit SectionMutator(Part part) : part_(std::move(part)) {}

  // Changes one of the part's ranges in place, one to four times. False where the file has none of them.
  bool mutate(std::span<std::uint8_t> file, unsigned seed) const {
    std::vector<std::span<std::uint8_t>> ranges = ranges_of(file);
    std::erase_if(ranges, [](std::span<std::uint8_t> range) { return range.empty(); });
    if (ranges.empty()) return false;
    for (unsigned turn = 0; turn <= seed % 4; ++turn) {
      const std::span<std::uint8_t> range = ranges[(seed / 4 + turn * 7919) % ranges.size()];
      // A window of the range: mutations that insert or erase then move few elements.
      const std::size_t least = std::min<std::size_t>(range.size(), 4);
      const std::size_t size = least + (seed / 64 + turn * 31) % (std::min<std::size_t>(range.size(), 256) - least + 1);
      const std::size_t begin = (seed / 16384 + turn * 104729) % (range.size() - size + 1);
      std::vector<std::uint8_t> window(range.begin() + static_cast<std::ptrdiff_t>(begin),
                                       range.begin() + static_cast<std::ptrdiff_t>(begin + size));
      const std::size_t kept = LLVMFuzzerMutate(window.data(), size, size);
      std::copy_n(window.begin(), std::min(kept, size), range.begin() + static_cast<std::ptrdiff_t>(begin));
    }
    return true;
  }

 private:
  [[nodiscard]] std::vector<std::span<std::uint8_t>> ranges_of(std::span<std::uint8_t> file) const {
    sections::FileHeader header;
    if (file.size() < sizeof(header)) return {};
    std::memcpy(&header, file.data(), sizeof(header));
    const std::size_t room = (file.size() - sizeof(header)) / sizeof(sections::Section);
    const std::size_t count = std::min<std::size_t>({header.section_count, room, sections::max_sections});
    std::vector<std::span<std::uint8_t>> ranges;
    if (part_.has_header) ranges.push_back(file.first(sizeof(header) + count * sizeof(sections::Section)));
    for (std::size_t i = 0; i < count; ++i) {
      sections::Section section;
      std::memcpy(&section, file.data() + sizeof(header) + i * sizeof(section), sizeof(section));
      const std::string_view name(section.name.data(), section.name.size());
      if (std::ranges::find(part_.sections, name) == part_.sections.end()) continue;
      if (section.offset > file.size() || section.bytes > file.size() - section.offset) continue;
      ranges.push_back(file.subspan(section.offset, section.bytes));
    }
    return ranges;
  }

  Part part_;
};

}  // namespace occlod::fuzz
