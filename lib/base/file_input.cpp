#include "base/file_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "base/memory.h"
#include "base/platform.h"
#include "occlod/base.h"

namespace occlod {

void require_no_special_file(const std::filesystem::path& path) {
  std::error_code unknown;
  const std::filesystem::file_status status = std::filesystem::status(path, unknown);
  if (std::filesystem::is_other(status) && std::filesystem::exists(status))
    throw Error({path.string(), "", "is not a regular file", "save it to a file first"});
}

namespace {

// Returns use(path); turns the system's refusals into an Error that names the path.
template <typename Use>
auto with_path(const std::filesystem::path& path, const Use& use) try {
  return use(path.c_str());
} catch (const std::system_error& error) {
  require_no_special_file(path);
  throw Error({path.string(), "", fmt::format("cannot be opened: {}", error.code().message()),
               "check that the file is there and can be read"});
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path)
    // Mapping no bytes would be an error.
    : bytes_(with_path(path, [](const char* name) {
        const InputFile file(name);
        return file.size() == 0 ? std::span<const std::byte>() : file.map();
      })) {
  if (!bytes_.empty()) let_leave(bytes_);
}

MappedFile::~MappedFile() {
  if (bytes_.empty()) return;
  keep(bytes_);
  unmap(bytes_);
}

LargeVector<std::byte> read_whole(const std::filesystem::path& path) {
  return with_path(path, [](const char* name) {
    const InputFile file(name);
    LargeVector<std::byte> bytes(file.size());
    file.read(bytes);
    return bytes;
  });
}

std::shared_ptr<const InputFile> open_file(const std::filesystem::path& path) {
  return with_path(path, [](const char* name) { return std::make_shared<const InputFile>(name); });
}

namespace fs = std::filesystem;

void FileErrors::fail(std::string place, std::string problem, std::string remedy) const {
  throw Error({subject_, std::move(place), std::move(problem), std::move(remedy)});
}

void FileErrors::fail_at_line(std::uint64_t line, std::string problem, std::string remedy) const {
  fail(fmt::format("line {}", line), std::move(problem), std::move(remedy));
}

namespace {

constexpr std::size_t block_bytes = std::size_t{1} << 20;

}  // namespace

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string shown = "'";
  for (const char c : text.substr(0, longest)) shown += c >= ' ' && c <= '~' ? c : '?';
  return shown + (text.size() > longest ? "...'" : "'");
}

InputBytes::InputBytes(const fs::path& path, const FileErrors& errors, std::function<void(double)> progress)
    : errors_(&errors), progress_(std::move(progress)) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) errors.fail("", "no such file", "check the path");
  if (fs::is_directory(status)) errors.fail("", "is a folder", "name a mesh file in it");
  if (!fs::is_regular_file(status)) errors.fail("", "is not a regular file", "save the mesh to a file first");
  size_ = fs::file_size(path, error);
  stream_.open(path, std::ios::binary);
  if (error || !stream_) errors.fail("", "cannot be opened", "check its permissions");
  if (size_ == 0) errors.fail("", "is empty", "export the mesh again");
  if (!std::in_range<std::size_t>(size_))
    errors.fail("", "is larger than 4 GiB, which a program of 32 bits cannot address", "read it with one of 64 bits");
}

std::string_view InputBytes::window(std::size_t least) {
  const std::uint64_t left = size_ - offset_;
  if (window_.size() >= least || window_.size() == left) return window_;
  const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(left, std::max(least, block_bytes)));
  if (wanted > capacity_) {
    auto larger = std::make_unique_for_overwrite<char[]>(wanted);
    std::ranges::copy(window_, larger.get());
    buffer_ = std::move(larger);
    capacity_ = wanted;
  } else {
    std::ranges::copy(window_, buffer_.get());  // move the unread bytes to the front
  }
  read_to(wanted);
  return window_;
}

// Reads until the window, which is at the beginning of the buffer, has `bytes` bytes.
void InputBytes::read_to(std::size_t bytes) {
  for (std::size_t have = window_.size(); have < bytes;) {
    make_room();  // the block before may have been parsed into large arrays
    if (progress_) progress_(static_cast<double>(offset_ + have) / static_cast<double>(size_));
    const std::size_t block = std::min(bytes - have, block_bytes);
    stream_.read(buffer_.get() + have, static_cast<std::streamsize>(block));
    const auto got = static_cast<std::size_t>(stream_.gcount());
    have += got;
    if (got != block) errors_->fail(fmt::format("byte {}", offset_ + have), "cannot be read further", "check the disk");
  }
  window_ = {buffer_.get(), bytes};
}

}  // namespace occlod
