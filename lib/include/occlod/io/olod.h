// The .olod file: a hierarchy as versioned, checksummed sections. The layout is described in docs/guide/file_format.md.
#pragma once

#include <cstdint>
#include <filesystem>

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/mesh/mesh_report.h"

namespace occlod {

inline constexpr std::uint32_t olod_version = 2;

enum class OlodCompression {
  none,  // mapped when read: opening takes no time, and only what is used is ever loaded
  zstd,  // half the size; unpacked into memory when read
};

// What a file without compression stands on when it is read.
enum class OlodAccess {
  mapped,  // opening takes no time; pages are loaded as they are used
  copied,  // read into memory as a whole: safe from whatever happens to the file afterwards
};

struct OlodFile {
  Hierarchy hierarchy;
  MeshReport report;  // of the mesh it was built from
  OlodCompression compression = OlodCompression::none;
};

// Throws Error; a file that was there stays as it was when writing fails.
void write_olod(const std::filesystem::path& path, const Hierarchy& hierarchy, const MeshReport& report,
                OlodCompression compression = OlodCompression::none);

// Checks magic, version, sizes, the table of sections and the base mesh. The rest is checked (checksum and structure)
// in blocks of splits when Hierarchy::require is first called for one of them; require_all() checks the whole file.
// Both throw Error that says what failed and where.
//
// A mapped file must stay as it is while the hierarchy lives. It may be removed or replaced by renaming another over
// it, as write_olod does; but when it is cut short, or its disk fails, POSIX systems answer the next use of a page that
// is gone with SIGBUS. Who cannot rule that out catches the signal or asks for a copy.
[[nodiscard]] OlodFile read_olod(const std::filesystem::path& path, OlodAccess access = OlodAccess::mapped);

}  // namespace occlod
