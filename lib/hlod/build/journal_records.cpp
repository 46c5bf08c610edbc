#include "hlod/build/journal_records.h"

#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <system_error>
#include <utility>

#include "hlod/build/build_bytes.h"
#include "occlod/base.h"

namespace occlod::hlod {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, std::string place, std::string problem,
                         std::string remedy) {
  throw Error({path.string(), std::move(place), std::move(problem), std::move(remedy)});
}

JournalFile open(const std::filesystem::path& path) try {
  return JournalFile(path.c_str());
} catch (const std::system_error& error) {
  if (error.code() == std::errc::resource_unavailable_try_again)
    refuse(path, "", "another build uses it", "wait until that has ended");
  refuse(path, "", "cannot be opened: " + error.code().message(), "check its permissions");
}

std::uint64_t checksum_of(const JournalRecords::Head& head, std::uint64_t seed) {
  return XXH3_64bits_withSeed(&head, sizeof(head) - sizeof(head.checksum), seed);
}

}  // namespace

JournalRecords::JournalRecords(std::filesystem::path path) : path_(std::move(path)), file_(open(path_)) {}

void JournalRecords::refuse(std::string place, std::string problem, std::string remedy) const {
  hlod::refuse(path_, std::move(place), std::move(problem), std::move(remedy));
}

std::size_t JournalRecords::read_header(std::span<std::byte> header) const {
  const std::size_t size = std::min<std::uint64_t>(file_.size(), header.size());
  read(header.first(size), 0);
  return size;
}

void JournalRecords::restart(std::span<const std::byte> header, std::uint64_t checksum) {
  cut(0);
  write(header);
  place_ = {header.size(), checksum};
}

bool JournalRecords::take(std::vector<std::byte>& body) {
  Head head;
  if (file_.size() - place_.offset < sizeof(head)) return false;
  read(writable_bytes_of(head), place_.offset);
  if (head.checksum != checksum_of(head, place_.checksum)) return false;
  if (file_.size() - place_.offset - sizeof(head) < head.bytes) return false;
  body.resize(head.bytes);
  read(body, place_.offset + sizeof(head));
  if (head.body_checksum != XXH3_64bits(body.data(), body.size())) return false;
  place_ = {place_.offset + sizeof(head) + head.bytes, head.checksum};
  return true;
}

void JournalRecords::cut_rest() {
  if (place_.offset < file_.size()) cut(place_.offset);
}

void JournalRecords::append(std::vector<std::byte>& bytes) {
  Head head;
  head.bytes = bytes.size() - sizeof(head);
  head.body_checksum = XXH3_64bits(bytes.data() + sizeof(head), head.bytes);
  head.checksum = checksum_of(head, place_.checksum);
  std::memcpy(bytes.data(), &head, sizeof(head));
  write(bytes);
  place_ = {place_.offset + bytes.size(), head.checksum};
}

void JournalRecords::read(std::span<std::byte> bytes, std::uint64_t offset) const try {
  file_.read(bytes, offset);
} catch (const std::system_error& error) {
  refuse("", "cannot be read: " + error.code().message(), "remove it to start anew");
}

void JournalRecords::write(std::span<const std::byte> bytes) try {
  file_.append(bytes);
} catch (const std::system_error& error) {
  refuse("", "cannot be written: " + error.code().message(), "check the space on the disk");
}

void JournalRecords::cut(std::uint64_t size) try { file_.cut(size); } catch (const std::system_error& error) {
  refuse("", "cannot be cut short: " + error.code().message(), "remove it to start anew");
}

}  // namespace occlod::hlod
