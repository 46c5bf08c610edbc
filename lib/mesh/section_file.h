// Files of named, checksummed sections, the common layout of .olod and .ohlod files, with compression and materials.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/byte_source.h"
#include "base/file_input.h"
#include "base/memory.h"
#include "mesh/image_files.h"
#include "occlod/mesh.h"

namespace occlod::olod {

// Writes the first bytes of all elements, then their second bytes and so on: neighbouring elements are similar byte by
// byte, so this compresses better. Bytes at the end that make no whole element stay at the end. The spans have the same
// size.
void separate(std::span<const std::byte> elements, std::size_t element_bytes, std::span<std::byte> planes);
// Undoes separate().
void join(std::span<const std::byte> planes, std::size_t element_bytes, std::span<std::byte> elements);

// Compresses to zstd frames of up to packed_run raw bytes each, whose elements are separated.
[[nodiscard]] std::vector<std::byte> pack(std::span<const std::byte> raw, std::size_t element_bytes);

// Undoes pack(); returns false when `packed` is damaged or does not hold exactly `raw.size()` bytes. Never writes
// outside `raw`.
[[nodiscard]] bool unpack(std::span<const std::byte> packed, std::size_t element_bytes, std::span<std::byte> raw);

// True when a section may decompress to this many bytes. Nothing in our files compresses better than that, so a section
// that claims more is refused before memory is allocated.
[[nodiscard]] constexpr bool is_plausible(std::uint64_t packed_bytes, std::uint64_t raw_bytes) {
  return raw_bytes / 64 <= packed_bytes;
}

}  // namespace occlod::olod

namespace occlod::sections {

static_assert(std::endian::native == std::endian::little, "these files are little-endian and read as they are");

// One file format. `name` is its extension; `make` and `rebuild` are for messages.
struct FileKind {
  std::array<char, 8> magic;
  std::uint32_t version;
  const char* name;
  const char* make;                  // says where to get such a file
  const char* rebuild;               // says what to do about a damaged file
  std::uint32_t oldest_version = 0;  // oldest version that can still be read; 0: only `version`
};

inline constexpr std::uint64_t alignment = 64;  // of every section
inline constexpr std::uint32_t max_sections = 64;

struct FileHeader {
  std::array<char, 8> magic{};
  std::uint32_t version = 0;
  std::uint32_t section_count = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t table_checksum = 0;  // XXH3-64 of the section table
};
static_assert(sizeof(FileHeader) == 32);

enum class Codec : std::uint32_t { stored = 0, zstd = 1 };

struct Section {
  std::array<char, 4> name{};
  std::uint32_t element_bytes = 0;
  std::uint64_t offset = 0;     // from the start of the file
  std::uint64_t bytes = 0;      // size in the file
  std::uint64_t raw_bytes = 0;  // unpacked size; equal to `bytes` when stored
  std::uint64_t checksum = 0;   // XXH3-64 of the unpacked section; 0 for sections whose parts have their own checksums
  Codec codec = Codec::stored;
  std::uint32_t reserved = 0;
};
static_assert(sizeof(Section) == 48);

// Returns the XXH3-64 checksum.
[[nodiscard]] std::uint64_t checksum_of(std::span<const std::byte> bytes);

// Who checks the checksum of a section.
enum class Check {
  whole,  // the reader, as a whole
  parts,  // the caller, part by part
};

// Collects sections, whose memory must stay valid, and then writes them.
class SectionWriter {
 public:
  template <typename T>
  void add(std::string_view name, std::span<const T> values, Check check = Check::whole, Codec codec = Codec::stored) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= alignment);
    add_bytes(name, std::as_bytes(values), sizeof(T), check, codec);
  }
  // Adds a report in one or two sections, which read_report() reads.
  void add_report(const MeshReport& report);
  // Adds the origin of positions in a section that read_origin() reads, unless it is 0. Returns whether it did.
  bool add_origin(const glm::dvec3& origin);
  // Writes the file through an AtomicFile. Throws Error that names `path`.
  void write(const std::filesystem::path& path, const FileKind& kind);

 private:
  void add_bytes(std::string_view name, std::span<const std::byte> bytes, std::uint32_t element_bytes, Check check,
                 Codec codec);
  void add_copy(std::string_view name, std::span<const std::byte> bytes, std::size_t element_bytes);

  std::vector<Section> table_;
  std::vector<std::span<const std::byte>> contents_;
  std::vector<std::vector<std::byte>> packed_;
  std::vector<std::vector<std::byte>> own_;  // copies of sections without another owner
};

// Reads a file and owns its mapping or copy and the sections that had to be decompressed.
class SectionReader {
 public:
  // Checks the header and the table. Throws Error.
  SectionReader(const std::filesystem::path& path, const FileKind& kind, bool is_mapped);
  // Reads an open file and copies sections when they are read; `path` names it in messages. Checks the header and the
  // table. Throws Error.
  SectionReader(std::shared_ptr<const ByteSource> file, const std::filesystem::path& path, const FileKind& kind);

  [[noreturn]] void refuse(const std::string& place, const std::string& problem, const std::string& remedy) const;
  // Throws Error with the remedy to build the file again.
  [[noreturn]] void refuse(const std::string& place, const std::string& problem) const;

  // Returns the elements of a section, in the mapping or decompressed. Throws Error when the section is missing,
  // damaged or has elements of another size.
  template <typename T>
  [[nodiscard]] std::span<const T> read(std::string_view name, Check check = Check::whole) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= alignment);
    const std::span<const std::byte> bytes = read_bytes(name, sizeof(T), check);
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  // Returns the only element of a section. `what` names it in messages.
  template <typename T>
  [[nodiscard]] T read_one(std::string_view name, const char* what) {
    const std::span<const T> values = read<T>(name);
    if (values.size() != 1) refuse("", std::string("does not hold one ") + what);
    return values[0];
  }
  // Returns the position in the file of a section that is not compressed. Throws Error when it is missing or
  // compressed.
  [[nodiscard]] std::uint64_t offset_of(std::string_view name) const { return stored_section(name).offset; }
  // Returns the size in bytes of a section that is not compressed. Throws Error when it is missing or compressed.
  [[nodiscard]] std::uint64_t bytes_of(std::string_view name) const { return stored_section(name).bytes; }
  // Returns the header at the start of the file.
  [[nodiscard]] const FileHeader& header() const noexcept { return header_; }
  // True when there is a section of this name.
  [[nodiscard]] bool has(std::string_view name) const { return find(name) != table_.end(); }
  [[nodiscard]] MeshReport read_report();
  // Returns the origin of positions; 0 when the file has none.
  [[nodiscard]] glm::dvec3 read_origin();

  [[nodiscard]] bool is_compressed() const noexcept { return !unpacked_.empty(); }

 private:
  void read_header();
  void check_table() const;
  [[nodiscard]] std::vector<Section>::const_iterator find(std::string_view name) const;
  [[nodiscard]] std::span<const std::byte> read_bytes(std::string_view name, std::uint32_t element_bytes, Check check);
  [[nodiscard]] const Section& stored_section(std::string_view name) const;
  [[nodiscard]] std::span<const std::byte> stored(const Section& section);
  [[nodiscard]] std::span<const std::byte> bytes_at(std::uint64_t offset, std::size_t bytes);
  [[nodiscard]] std::span<const std::byte> unpacked(const Section& section);

  std::string path_;
  FileKind kind_;
  std::optional<MappedFile> file_;  // the mapping, unless the file was copied or is read in parts
  LargeVector<std::byte> copy_;
  std::span<const std::byte> bytes_;
  std::shared_ptr<const ByteSource> open_file_;        // the file that is read in parts
  std::vector<UninitializedVector<std::byte>> parts_;  // parts read so far
  std::uint64_t size_ = 0;                             // of the file
  FileHeader header_;
  std::vector<Section> table_;
  std::vector<std::vector<std::byte>> unpacked_;
};

struct Materials {
  std::vector<Material> materials;
  std::vector<Texture> textures;
  TextureOrigin origin = TextureOrigin::bottom_left;
  UpAxis up = UpAxis::z;
};

// Returns the JSON text of what differs from an empty Surface.
[[nodiscard]] std::string text_of(const Surface& surface);

// Writes materials as JSON text, which has only what is not usual of surfaces, and the bytes of embedded images, one
// after the other. Must stay valid while a SectionWriter uses it.
class MaterialSections {
 public:
  // `view` is a HierarchyView or an HlodView.
  template <typename View>
  void add(const View& view, SectionWriter& writer, const ImageFolders& folders) {
    pack({{view.materials.begin(), view.materials.end()},
          {view.textures.begin(), view.textures.end()},
          view.texture_origin,
          view.up},
         folders);
    add_to(writer);
  }

 private:
  void pack(Materials all, const ImageFolders& folders);
  void add_to(SectionWriter& writer) const;

  std::string text_;
  std::vector<std::uint8_t> images_;
};

// Returns the defaults when the file has no material sections. Refuses anything that MaterialSections does not write.
// Without images those that the file holds are not read: their textures have no bytes.
[[nodiscard]] Materials read_materials(SectionReader& reader, bool with_images = true);

}  // namespace occlod::sections
