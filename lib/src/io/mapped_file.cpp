#include "mapped_file.h"

#include <fmt/format.h>

#include <system_error>

#include "core/platform.h"
#include "occlod/core/error.h"

namespace occlod {
namespace {

// What `use` makes of an open file; Error that names `path` for what the system refuses.
template <typename Use>
auto with_file(const std::filesystem::path& path, const Use& use) try {
  const InputFile file(path.c_str());
  return use(file);
} catch (const std::system_error& error) {
  throw Error({path.string(), "", fmt::format("cannot be opened: {}", error.code().message()),
               "check that the file is there and can be read"});
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path)
    // An empty mapping is an error.
    : bytes_(with_file(
          path, [](const InputFile& file) { return file.size() == 0 ? std::span<const std::byte>() : file.map(); })) {}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) unmap(bytes_);
}

LargeVector<std::byte> read_whole(const std::filesystem::path& path) {
  return with_file(path, [](const InputFile& file) {
    LargeVector<std::byte> bytes(file.size());
    file.read(bytes);
    return bytes;
  });
}

}  // namespace occlod
