#include "hlod/tiles/tileset_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <span>
#include <tuple>

#include "base/atomic_file.h"
#include "base/memory.h"
#include "hlod/tiles/md5.h"
#include "hlod/tiles/zip_writer.h"
#include "occlod/base.h"

namespace occlod::tiles {
namespace {

class FolderFiles final : public TilesetFiles {
 public:
  explicit FolderFiles(const std::filesystem::path& path) : folder_(path) {}

  void write(const std::string& name, std::string_view bytes) override { folder_.write(name, bytes); }

  std::uint64_t commit() override {
    folder_.commit();
    return folder_.bytes();
  }

 private:
  AtomicFolder folder_;
};

// A ZIP file with an index as its last entry, by which readers find a file without the directory: for each file the
// MD5 hash of its name and the offset of its local header, in ascending order of the hash as two numbers.
class ArchiveFiles final : public TilesetFiles {
 public:
  explicit ArchiveFiles(const std::filesystem::path& path)
      : path_(path), file_(path), zip_([this](std::span<const std::byte> bytes) { file_.write(bytes); }) {}

  void write(const std::string& name, std::string_view bytes) override {
    index_.push_back({little_endian_halves(md5(name)), add(name, std::as_bytes(std::span(bytes)))});
  }

  std::uint64_t commit() override {
    std::ranges::sort(index_, {}, [](const IndexEntry& entry) { return std::tie(entry.hash, entry.offset); });
    LargeVector<std::byte> bytes;
    bytes.reserve(sizeof(IndexEntry) * index_.size());
    for (const IndexEntry& entry : index_)
      for (const std::uint64_t number : {entry.hash[0], entry.hash[1], entry.offset})
        for (unsigned i = 0; i < 8; ++i) bytes.push_back(static_cast<std::byte>(number >> (8 * i)));
    add("@3dtilesIndex1@", bytes);
    zip_.finish();
    file_.commit();
    return zip_.size();
  }

 private:
  using Halves = std::array<std::uint64_t, 2>;
  struct IndexEntry {
    Halves hash;
    std::uint64_t offset;
  };

  static Halves little_endian_halves(const std::array<std::uint8_t, 16>& digest) {
    Halves halves{};
    for (std::size_t i = 0; i < digest.size(); ++i) halves[i / 8] |= std::uint64_t{digest[i]} << (8 * (i % 8));
    return halves;
  }

  std::uint64_t add(const std::string& name, std::span<const std::byte> bytes) {
    if (bytes.size() > ZipWriter::max_bytes)
      throw Error({path_.string(), name, "is larger than 4 GB, and a file in an archive may not be",
                   "write a folder: choose a name that does not end in .3tz"});
    return zip_.add(name, bytes);
  }

  std::filesystem::path path_;
  AtomicFile file_;
  ZipWriter zip_;
  LargeVector<IndexEntry> index_;
};

}  // namespace

bool is_archive(const std::filesystem::path& path) {
  return std::ranges::equal(path.extension().string(), std::string_view(".3tz"),
                            [](unsigned char a, char b) { return std::tolower(a) == b; });
}

std::unique_ptr<TilesetFiles> make_tileset_files(const std::filesystem::path& path) {
  if (is_archive(path)) return std::make_unique<ArchiveFiles>(path);
  return std::make_unique<FolderFiles>(path);
}

}  // namespace occlod::tiles
