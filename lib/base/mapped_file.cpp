#include "base/mapped_file.h"

#include <fmt/format.h>

#include <system_error>

#include "base/platform.h"
#include "occlod/core/error.h"

namespace occlod {
namespace {

// What `use` makes of a path; Error that names it for what the system refuses.
template <typename Use>
auto with_path(const std::filesystem::path& path, const Use& use) try {
  return use(path.c_str());
} catch (const std::system_error& error) {
  throw Error({path.string(), "", fmt::format("cannot be opened: {}", error.code().message()),
               "check that the file is there and can be read"});
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path)
    // An empty mapping is an error.
    : bytes_(with_path(path, [](const char* name) {
        const InputFile file(name);
        return file.size() == 0 ? std::span<const std::byte>() : file.map();
      })) {}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) unmap(bytes_);
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

}  // namespace occlod
