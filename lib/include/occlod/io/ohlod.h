// The .ohlod file: an HLOD as versioned, checksummed sections. The layout is described in docs/guide/hlod.md.
#pragma once

#include <cstdint>
#include <filesystem>

#include "occlod/hlod/hlod.h"
#include "occlod/hlod/node_store.h"
#include "occlod/io/olod.h"
#include "occlod/mesh/mesh_report.h"

namespace occlod {

// Of the files that write_ohlod() writes of HLODs with texture coordinates, materials or seams. Others are files of
// version 1, byte for byte; read_ohlod() reads both.
inline constexpr std::uint32_t ohlod_version = 2;

// What a file holds.
struct OhlodFile {
  hlod::Hlod hlod;    // mapped or in memory
  MeshReport report;  // of the mesh that it was built from
};

// Writes beside `path` and renames, so that a file that was there stays as it was when writing fails. The same
// arguments give the same bytes. Throws Error that names the file. O(bytes).
void write_ohlod(const std::filesystem::path& path, const hlod::Hlod& hlod, const MeshReport& report);

// Checks magic, version, sizes, and all that is known of nodes without their meshes: O(nodes). The mesh of a node is
// checked (checksum and content) when Hlod::require() is first called for it, its splits when require_within() is;
// require_all() checks the whole file. All throw Error that says what failed and where.
//
// What read_olod() says of mapped files holds here too: a file that is open must not be cut short.
[[nodiscard]] OhlodFile read_ohlod(const std::filesystem::path& path, OlodAccess access = OlodAccess::mapped);

// The same without meshes: these come and go within a budget while the HLOD is traversed, checked as they come (see
// node_store.h, Hlod::store()). Splits within nodes are left out. What is known of nodes without their meshes is
// copied, so that nothing depends on what becomes of the file: a mesh that is damaged or gone never comes, coarser ones
// are drawn in its place, and NodeStore::take_failures() tells. Throws Error as read_ohlod() does, for options out of
// their range, a budget that is too small, and when the coarsest nodes are damaged. O(nodes).
[[nodiscard]] OhlodFile open_ohlod(const std::filesystem::path& path, const hlod::CacheOptions& cache);

}  // namespace occlod
