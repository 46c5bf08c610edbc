// The .olod file: a hierarchy as versioned, checksummed sections. The layout is described in docs/file_format.md.
#pragma once

#include <cstdint>
#include <filesystem>

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/mesh/mesh_report.h"

namespace occlod {

inline constexpr std::uint32_t olod_version = 1;

struct OlodFile {
  Hierarchy hierarchy;
  MeshReport report;  // of the mesh it was built from
};

// Throws Error; a file that was there stays as it was when writing fails.
void write_olod(const std::filesystem::path& path, const Hierarchy& hierarchy, const MeshReport& report);

// Checks magic, version, sizes, checksums and structure before anything is used. Throws Error that says which of them
// failed and where.
[[nodiscard]] OlodFile read_olod(const std::filesystem::path& path);

}  // namespace occlod
