// A file of records, by which work that was interrupted goes on: each has a checksum, which also fixes their order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/platform.h"

namespace occlod::hlod {

// All functions throw Error that names the file.
class JournalRecords {
 public:
  // Precedes each record.
  struct Head {
    std::uint64_t bytes = 0;          // size of the body that follows this head
    std::uint64_t body_checksum = 0;  // XXH3-64 of the body
    std::uint64_t checksum = 0;       // of the fields above, seeded with the previous record's: this fixes the order
  };
  // The end of a record.
  struct Place {
    std::uint64_t offset = 0;
    std::uint64_t checksum = 0;  // of its head; where the first record begins, that of the file's header
  };

  // Opens the file, and creates it if need be. Throws Error when another build uses it.
  explicit JournalRecords(std::filesystem::path path);

  [[nodiscard]] std::uint64_t size() const noexcept { return file_.size(); }
  // Reads the start of the file, at most `header`; returns how many bytes there are.
  [[nodiscard]] std::size_t read_header(std::span<std::byte> header) const;
  // Replaces the whole file by a header, and goes to the first record.
  void restart(std::span<const std::byte> header, std::uint64_t checksum);

  [[nodiscard]] const Place& place() const noexcept { return place_; }
  void go_to(const Place& place) noexcept { place_ = place; }
  // Reads the next record into `body`. Returns false, and stays, where none is whole and undamaged.
  [[nodiscard]] bool take(std::vector<std::byte>& body);
  // Cuts off whatever follows.
  void cut_rest();
  // Appends a record whose body is in `bytes` behind room for its head, at the file's end. It survives the process, but
  // perhaps not a system crash.
  void append(std::vector<std::byte>& bytes);

  [[noreturn]] void refuse(std::string place, std::string problem, std::string remedy) const;

 private:
  void read(std::span<std::byte> bytes, std::uint64_t offset) const;
  void write(std::span<const std::byte> bytes);
  void cut(std::uint64_t size);

  std::filesystem::path path_;
  JournalFile file_;
  Place place_;
};

}  // namespace occlod::hlod
