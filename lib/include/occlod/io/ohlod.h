// The .ohlod file: an HLOD as versioned, checksummed sections. The layout is described in docs/guide/hlod.md.
#pragma once

#include <cstdint>
#include <filesystem>

#include "occlod/hlod/hlod.h"
#include "occlod/hlod/node_store.h"
#include "occlod/io/olod.h"
#include "occlod/mesh/mesh_report.h"

namespace occlod {

// Of compressed files. Others are of version 2, or 1 without texture coordinates, materials and seams; read_ohlod()
// reads them all.
inline constexpr std::uint32_t ohlod_version = 3;

// What a file holds.
struct OhlodFile {
  hlod::Hlod hlod;                                      // mapped or in memory
  MeshReport report;                                    // of the mesh that it was built from
  OlodCompression compression = OlodCompression::zstd;  // of the file
  std::uint32_t version = ohlod_version;                // likewise
};

// Writes beside `path` and renames, so that a file that was there stays as it was when writing fails. The same
// arguments give the same bytes. With compression meshes and splits of nodes take about half their bytes, none of them
// lost, node by node. Throws Error that names the file. O(bytes).
void write_ohlod(const std::filesystem::path& path, const hlod::Hlod& hlod, const MeshReport& report,
                 OlodCompression compression = OlodCompression::zstd);

// Checks magic, version, sizes, and all that is known of nodes without their meshes: O(nodes). The mesh of a node is
// checked (checksum and content) when Hlod::require() is first called for it, its splits when require_within() is;
// require_all() checks the whole file. All throw Error that says what failed and where. Of a compressed file, what has
// been checked is kept in memory, decompressed: all meshes and splits at most.
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
