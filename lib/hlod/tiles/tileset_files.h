// Takes the files of a tileset: in a folder, or in an archive by the 3D Tiles Archive Format 1.3.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace occlod::tiles {

// Writes beside its path, and leaves what is there as it was until commit().
class TilesetFiles {
 public:
  TilesetFiles() = default;
  virtual ~TilesetFiles() = default;
  TilesetFiles(const TilesetFiles&) = delete;
  TilesetFiles& operator=(const TilesetFiles&) = delete;

  // `name` is relative and new, with '/' between its parts. Throws Error that names the path of the tileset.
  virtual void write(const std::string& name, std::string_view bytes) = 0;
  // Replaces what is there, which write_tileset() has checked. Returns the bytes of the folder's files, or of the
  // archive.
  virtual std::uint64_t commit() = 0;
};

// Returns whether a tileset of this name is an archive: it ends in .3tz.
[[nodiscard]] bool is_archive(const std::filesystem::path& path);

// Throws Error where nothing can be written.
[[nodiscard]] std::unique_ptr<TilesetFiles> make_tileset_files(const std::filesystem::path& path);

}  // namespace occlod::tiles
