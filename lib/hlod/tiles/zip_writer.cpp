#include "hlod/tiles/zip_writer.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <concepts>

namespace occlod::tiles {
namespace {

using Bytes = LargeVector<std::byte>;

constexpr std::uint16_t plain_version = 10, version_64 = 45;  // needed to read it
constexpr std::uint16_t first_day = 1U << 5U | 1U;            // 1980-01-01
constexpr std::uint16_t id_64 = 1;                            // of the field with numbers of 64 bits
constexpr std::uint16_t in_16_bits = 0xffff;                  // these say that a number is to be found elsewhere
constexpr std::uint32_t in_32_bits = 0xffffffff;

// Appends the number in little-endian order.
template <std::unsigned_integral Number>
void put(Bytes& to, Number number) {
  for (std::size_t i = 0; i < sizeof(Number); ++i) to.push_back(static_cast<std::byte>(number >> (8 * i)));
}

void put(Bytes& to, std::string_view text) {
  for (const char c : text) to.push_back(static_cast<std::byte>(c));
}

// Appends what local headers and the directory say alike of an entry, from the version to the length of its name.
void put_description(Bytes& to, std::uint16_t version, std::string_view name, std::uint32_t size, std::uint32_t crc) {
  put(to, version);
  put(to, std::uint16_t{0});  // flags
  put(to, std::uint16_t{0});  // stored
  put(to, std::uint16_t{0});  // midnight
  put(to, first_day);
  put(to, crc);
  put(to, size);  // compressed
  put(to, size);
  put(to, static_cast<std::uint16_t>(name.size()));
}

// The checksums of a byte with up to seven zeros behind it, for eight bytes at once.
constexpr std::array<std::array<std::uint32_t, 256>, 8> crc_tables = [] {
  std::array<std::array<std::uint32_t, 256>, 8> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xedb88320U : 0U);
    tables[0][byte] = crc;
  }
  for (std::size_t zeros = 1; zeros < 8; ++zeros)
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t crc = tables[zeros - 1][byte];
      tables[zeros][byte] = (crc >> 8U) ^ tables[0][crc & 0xffU];
    }
  return tables;
}();

// CRC-32 of ISO/IEC 3309.
std::uint32_t crc_of(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0xffffffff;
  for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      const std::uint32_t mixed = i < 4 ? crc >> (8 * i) : 0;
      next ^= crc_tables[7 - i][(mixed ^ std::to_integer<std::uint32_t>(bytes[i])) & 0xffU];
    }
    crc = next;
  }
  for (const std::byte byte : bytes)
    crc = (crc >> 8U) ^ crc_tables[0][(crc ^ std::to_integer<std::uint32_t>(byte)) & 0xffU];
  return ~crc;
}

// Section 4.3.7.
Bytes local_header(std::string_view name, std::uint32_t size, std::uint32_t crc) {
  Bytes header;
  put(header, std::uint32_t{0x04034b50});
  put_description(header, plain_version, name, size, crc);
  put(header, std::uint16_t{0});  // length of further fields
  put(header, name);
  return header;
}

// Section 4.3.12.
void put_directory_entry(Bytes& to, std::string_view name, std::uint32_t size, std::uint32_t crc,
                         std::uint64_t offset) {
  const bool is_far = offset >= in_32_bits;
  const std::uint16_t version = is_far ? version_64 : plain_version;
  put(to, std::uint32_t{0x02014b50});
  put(to, version);  // made by
  put_description(to, version, name, size, crc);
  put(to, static_cast<std::uint16_t>(is_far ? 12 : 0));  // length of further fields
  put(to, std::uint16_t{0});                             // length of the comment
  put(to, std::uint16_t{0});                             // disk
  put(to, std::uint16_t{0});                             // internal attributes
  put(to, std::uint32_t{0});                             // external attributes
  put(to, is_far ? in_32_bits : static_cast<std::uint32_t>(offset));
  put(to, name);
  if (!is_far) return;
  put(to, id_64);
  put(to, std::uint16_t{8});
  put(to, offset);
}

// Sections 4.3.14 to 4.3.16.
Bytes end_of(std::uint64_t entries, std::uint64_t directory_bytes, std::uint64_t directory_offset) {
  Bytes end;
  if (entries >= in_16_bits || directory_bytes >= in_32_bits || directory_offset >= in_32_bits) {
    put(end, std::uint32_t{0x06064b50});
    put(end, std::uint64_t{44});  // bytes of this record that follow
    put(end, version_64);         // made by
    put(end, version_64);
    put(end, std::uint32_t{0});  // disk
    put(end, std::uint32_t{0});  // disk of the directory
    put(end, entries);           // on this disk
    put(end, entries);
    put(end, directory_bytes);
    put(end, directory_offset);
    put(end, std::uint32_t{0x07064b50});
    put(end, std::uint32_t{0});  // disk of the record above
    put(end, directory_offset + directory_bytes);
    put(end, std::uint32_t{1});  // disks
  }
  const auto few = static_cast<std::uint16_t>(std::min<std::uint64_t>(entries, in_16_bits));
  put(end, std::uint32_t{0x06054b50});
  put(end, std::uint16_t{0});  // disk
  put(end, std::uint16_t{0});  // disk of the directory
  put(end, few);               // on this disk
  put(end, few);
  put(end, static_cast<std::uint32_t>(std::min<std::uint64_t>(directory_bytes, in_32_bits)));
  put(end, static_cast<std::uint32_t>(std::min<std::uint64_t>(directory_offset, in_32_bits)));
  put(end, std::uint16_t{0});  // length of the comment
  return end;
}

}  // namespace

std::uint64_t ZipWriter::add(std::string_view name, std::span<const std::byte> bytes) {
  assert(bytes.size() <= max_bytes && !name.empty() && name.size() <= max_name);
  const std::uint64_t offset = size_;
  const auto size = static_cast<std::uint32_t>(bytes.size());
  const std::uint32_t crc = crc_of(bytes);
  write(local_header(name, size, crc));
  write(bytes);
  put_directory_entry(directory_, name, size, crc, offset);
  ++entries_;
  return offset;
}

void ZipWriter::finish() {
  const std::uint64_t offset = size_;
  write(directory_);
  write(end_of(entries_, directory_.size(), offset));
}

void ZipWriter::write(std::span<const std::byte> bytes) {
  write_(bytes);
  size_ += bytes.size();
}

}  // namespace occlod::tiles
