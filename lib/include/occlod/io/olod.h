// The .olod file: a hierarchy as versioned, checksummed sections. The layout is described in docs/guide/file_format.md.
#pragma once

#include <cstdint>
#include <filesystem>

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/mesh/mesh_report.h"

namespace occlod {

// Of the files that write_olod() writes; read_olod() refuses any other.
inline constexpr std::uint32_t olod_version = 3;

// How the arrays of a file are stored.
enum class OlodCompression {
  none,  // as they are in memory: the file can be mapped, so that only what is used is ever loaded
  zstd,  // about half the size or less; decompressed into memory when read
};

// How a file without compression is read.
enum class OlodAccess {
  mapped,  // opening takes no time; pages are loaded as they are used
  copied,  // read into memory as a whole: independent of what happens to the file afterwards
};

// What a file holds.
struct OlodFile {
  Hierarchy hierarchy;                                  // mapped or in memory
  MeshReport report;                                    // of the mesh that it was built from
  OlodCompression compression = OlodCompression::none;  // of the file
};

// Writes beside `path` and renames, so that a file that was there stays as it was when writing fails. The same
// arguments give the same bytes. Throws Error that names the file. O(bytes).
void write_olod(const std::filesystem::path& path, const Hierarchy& hierarchy, const MeshReport& report,
                OlodCompression compression = OlodCompression::none);

// Checks magic, version, sizes, the table of sections and the base mesh. The rest is checked (checksum and structure)
// block by block when Hierarchy::require() is first called for a split of the block; require_all() checks the whole
// file. Both throw Error that says what failed and where.
//
// A mapped file must stay as it is while the hierarchy lives. It may be removed, or replaced by renaming another file
// over it, as write_olod() does; but when it is truncated, or its disk fails, POSIX systems answer the next access to a
// missing page with SIGBUS. Where that cannot be ruled out, handle the signal or ask for a copy.
[[nodiscard]] OlodFile read_olod(const std::filesystem::path& path, OlodAccess access = OlodAccess::mapped);

}  // namespace occlod
