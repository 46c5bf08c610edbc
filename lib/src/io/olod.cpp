#include "occlod/io/olod.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "occlod/core/error.h"
#include "occlod/hierarchy/validate.h"
#include "occlod/io/atomic_file.h"

namespace occlod {
namespace {

static_assert(std::endian::native == std::endian::little, ".olod files are little-endian and read as they are");

// The carriage returns and the end-of-file byte make a transfer in text mode show at once, as in PNG.
constexpr std::array<char, 8> magic = {'O', 'L', 'O', 'D', '\r', '\n', '\x1a', '\n'};
constexpr std::uint64_t alignment = 64;  // of every section
constexpr std::uint32_t most_sections = 64;
constexpr const char* rebuild = "build it again with 'occlod build'";

struct FileHeader {
  std::array<char, 8> magic{};
  std::uint32_t version = 0;
  std::uint32_t section_count = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t table_checksum = 0;  // XXH3-64 of the section table
};
static_assert(sizeof(FileHeader) == 32);

struct Section {
  std::array<char, 4> name{};
  std::uint32_t element_bytes = 0;
  std::uint64_t offset = 0;  // from the start of the file
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;  // XXH3-64 of the section
};
static_assert(sizeof(Section) == 32);

// Calls visit(name, vector) for every array of a hierarchy: the one list of what a file holds.
template <typename Data, typename Visit>
void for_each_array(Data& data, const Visit& visit) {
  visit("POSI", data.positions);
  visit("NORM", data.normals);
  visit("COLR", data.colors);
  visit("NODE", data.nodes);
  visit("ROOT", data.roots);
  visit("FDEP", data.first_dependency);
  visit("DEPS", data.dependencies);
  visit("FACE", data.faces);
  visit("DIED", data.died);
  visit("REMO", data.removed_faces);
  visit("BOXS", data.boxes);
  visit("CYLS", data.cylinders);
}

constexpr std::string_view report_name = "REPO";

template <typename T>
std::span<const std::byte> bytes_of(const std::vector<T>& v) {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::as_bytes(std::span(v));
}

std::uint64_t align_up(std::uint64_t offset) { return (offset + alignment - 1) / alignment * alignment; }

class Writer {
 public:
  void add(std::string_view name, std::size_t element_bytes, std::span<const std::byte> bytes) {
    Section section;
    std::copy_n(name.begin(), section.name.size(), section.name.begin());
    section.element_bytes = static_cast<std::uint32_t>(element_bytes);
    section.bytes = bytes.size();
    section.checksum = XXH3_64bits(bytes.data(), bytes.size());
    table_.push_back(section);
    contents_.push_back(bytes);
  }

  void write(const std::filesystem::path& path) {
    std::uint64_t offset = sizeof(FileHeader) + table_.size() * sizeof(Section);
    for (Section& section : table_) {
      section.offset = align_up(offset);
      offset = section.offset + section.bytes;
    }
    const FileHeader header{magic, olod_version, static_cast<std::uint32_t>(table_.size()), offset,
                            XXH3_64bits(table_.data(), table_.size() * sizeof(Section))};
    AtomicFile file(path);
    std::uint64_t written = 0;
    const auto put = [&](std::span<const std::byte> bytes) {
      file.write(bytes);
      written += bytes.size();
    };
    put(std::as_bytes(std::span(&header, 1)));
    put(std::as_bytes(std::span(table_)));
    constexpr std::array<std::byte, alignment> padding{};
    for (std::size_t i = 0; i < table_.size(); ++i) {
      put(std::span(padding).first(table_[i].offset - written));
      put(contents_[i]);
    }
    file.commit();
  }

 private:
  std::vector<Section> table_;
  std::vector<std::span<const std::byte>> contents_;
};

class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : path_(path), stream_(path, std::ios::binary) {
    std::error_code error;
    file_bytes_ = std::filesystem::file_size(path, error);
    if (error || !stream_) refuse("", "cannot be opened", "check that the file is there and can be read");
    read_header();
    read_table();
  }

  [[noreturn]] void refuse(const std::string& place, const std::string& problem, const std::string& mend) const {
    throw Error({path_.string(), place, problem, mend});
  }

  template <typename T>
  void read(std::string_view name, std::vector<T>& out) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto found = std::find_if(table_.begin(), table_.end(), [&](const Section& s) { return name_of(s) == name; });
    if (found == table_.end()) refuse("", fmt::format("has no section {}", name), rebuild);
    if (found->element_bytes != sizeof(T) || found->bytes % sizeof(T) != 0)
      refuse(place_of(*found), "has elements of another size", rebuild);
    // Bounded by the file's own size, which was checked.
    out.resize(found->bytes / sizeof(T));
    stream_.seekg(static_cast<std::streamoff>(found->offset));
    stream_.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(found->bytes));
    if (!stream_) refuse(place_of(*found), "cannot be read", "check the disk");
    if (XXH3_64bits(out.data(), found->bytes) != found->checksum)
      refuse(place_of(*found), "is damaged: its checksum is wrong", rebuild);
  }

 private:
  void read_header() {
    FileHeader header;
    stream_.read(reinterpret_cast<char*>(&header), sizeof(header));
    if (!stream_ || header.magic != magic) refuse("byte 0", "is not an .olod file", "make one with 'occlod build'");
    if (header.version != olod_version)
      refuse("byte 8",
             fmt::format("is an .olod file of version {}, this program reads version {}", header.version, olod_version),
             rebuild);
    if (header.file_bytes != file_bytes_)
      refuse(
          "byte 16",
          fmt::format("has {} bytes, but says that it has {}: it was cut or added to", file_bytes_, header.file_bytes),
          rebuild);
    if (header.section_count > most_sections)
      refuse("byte 12", fmt::format("claims {} sections", header.section_count), rebuild);
    table_.resize(header.section_count);
    stream_.read(reinterpret_cast<char*>(table_.data()), static_cast<std::streamsize>(table_.size() * sizeof(Section)));
    if (!stream_) refuse("byte 32", "ends inside its section table", rebuild);
    if (XXH3_64bits(table_.data(), table_.size() * sizeof(Section)) != header.table_checksum)
      refuse("byte 32", "has a damaged section table: its checksum is wrong", rebuild);
  }

  void read_table() const {
    for (const Section& section : table_)
      if (section.offset > file_bytes_ || section.bytes > file_bytes_ - section.offset)
        refuse(place_of(section), "lies outside the file", rebuild);
  }

  static std::string_view name_of(const Section& section) { return {section.name.data(), section.name.size()}; }
  static std::string place_of(const Section& section) {
    return fmt::format("section {} at byte {}", name_of(section), section.offset);
  }

  std::filesystem::path path_;
  std::ifstream stream_;
  std::uint64_t file_bytes_ = 0;
  std::vector<Section> table_;
};

}  // namespace

void write_olod(const std::filesystem::path& path, const Hierarchy& hierarchy, const MeshReport& report) {
  static_assert(std::is_trivially_copyable_v<MeshReport>);
  Writer writer;
  for_each_array(hierarchy.data(), [&](std::string_view name, const auto& array) {
    writer.add(name, sizeof(typename std::decay_t<decltype(array)>::value_type), bytes_of(array));
  });
  writer.add(report_name, sizeof(MeshReport), std::as_bytes(std::span(&report, 1)));
  writer.write(path);
}

OlodFile read_olod(const std::filesystem::path& path) {
  Reader reader(path);
  HierarchyData data;
  for_each_array(data, [&](std::string_view name, auto& array) { reader.read(name, array); });
  std::vector<MeshReport> report;
  reader.read(report_name, report);
  if (report.size() != 1) reader.refuse("section REPO", "does not hold one report", rebuild);
  if (const auto problem = check_structure(data)) reader.refuse("", "holds no hierarchy: " + *problem, rebuild);
  return {Hierarchy(std::move(data)), report[0]};
}

}  // namespace occlod
