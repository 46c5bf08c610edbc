// Meshes of nodes that come and go: an HLOD that is larger than memory, drawn within a fixed number of bytes. Traversal
// tells what it needs and what it waits for; a thread reads. open_ohlod() opens them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "occlod/build_hierarchy.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"

namespace occlod::hlod {

// How meshes come.
enum class LoadMode {
  blocking,  // at once, on the thread that traverses, which waits for the disk
  async,     // read by a thread of the store; frames never wait, and take over 4 MB at most, or one mesh
};

// What a store may use, and how it reads.
struct CacheOptions {
  std::size_t budget_bytes = std::size_t{256} << 20U;  // of meshes, those that are being read included: a hard limit
  LoadMode load = LoadMode::async;                     // how meshes come
};

// What a store holds and has done.
struct StoreStats {
  std::size_t budget_bytes = 0;    // CacheOptions::budget_bytes, or that of set_budget()
  std::size_t resident_nodes = 0;  // whose meshes are there
  std::size_t resident_bytes = 0;  // of their meshes
  std::size_t loading_bytes = 0;   // kept free for meshes that come; with resident_bytes at most the budget
  std::size_t missing = 0;         // nodes that traversal waited for in the last frame, without those that failed
  std::size_t failed = 0;          // nodes that never come, since their meshes are damaged or cannot be read
  std::uint64_t loads = 0;         // meshes that came since the store was opened
  std::uint64_t bytes_loaded = 0;  // of them, as they are stored: of a packed file fewer than in memory
  std::uint64_t reads = 0;         // of the file: meshes that lie side by side are read together
  std::uint64_t evictions = 0;     // meshes that left since then
};

class MeshLink;
class MeshSource;

// The meshes that are there are closed upwards: where a node's mesh is there, so are its parents', and those of roots
// always. So coarser nodes can be drawn in place of what is missing. Meshes leave that neither the last two frames nor
// a child that is there needed, the longest unused first, then the finest; those of the coarsest nodes that fit in a
// sixteenth of the budget stay. One thread at a time; meshes change in begin_frame(), fetch(), end_frame() and
// set_budget() only.
class NodeStore {
 public:
  // Stores the meshes of an HLOD without meshes and splits, whose arrays `owner` keeps alive. Reads the meshes of the
  // roots. Throws Error when they cannot be read, for options out of their range, and for a budget that the roots do
  // not fit in, with the least that would do.
  NodeStore(const HlodView& view, std::shared_ptr<const void> owner, std::unique_ptr<MeshSource> source,
            const CacheOptions& options);
  // Waits for a read that has begun.
  ~NodeStore();
  NodeStore(const NodeStore&) = delete;
  NodeStore& operator=(const NodeStore&) = delete;

  // May be called between frames only: what does not fit any more leaves at once. Throws Error as the constructor does.
  void set_budget(std::size_t bytes);
  // Returns what the store holds and has done. O(1).
  [[nodiscard]] StoreStats stats() const;
  // Returns the nodes that StoreStats::missing counts, ascending.
  [[nodiscard]] std::vector<NodeId> missing() const;
  // Returns one line for each node that has failed since the last call.
  [[nodiscard]] std::vector<std::string> take_failures();

  // Slows the file down, for comparisons with papers, before the first frame and with LoadMode::async
  // (bench/papers).
  void set_link(std::unique_ptr<MeshLink> link);

  // What follows is for traversal. Begins a frame: what has been read comes.
  void begin_frame();
  // Tells whether the mesh of node n is there or, with LoadMode::blocking, may be had by fetch().
  [[nodiscard]] bool may_have(NodeId n) const noexcept;
  // Tells whether the meshes of all these nodes are there; with LoadMode::blocking they are read if need be.
  [[nodiscard]] bool fetch(std::span<const NodeId> nodes);
  // Tells that the mesh of node n, which is there, is used in this frame.
  void need(NodeId n) noexcept;
  // Tells that something coarser is drawn in place of these nodes, of which some are missing. They are read together
  // or, where there is no room for all, not at all; those with the largest priority first, of which that of each node
  // is the sum over all calls in a frame.
  void want(std::span<const NodeId> nodes, double priority);
  // Tells that the mesh of node n may be of use soon. It comes after all that is wanted.
  void prefetch(NodeId n);
  // Ends the frame: what is missing is asked for, and room made for it.
  void end_frame();

 private:
  friend Hlod paged_hlod(const std::shared_ptr<NodeStore>& store);
  class Impl;
  std::unique_ptr<Impl> impl_;
};

// Returns the HLOD whose meshes the store holds, and which keeps it alive.
[[nodiscard]] Hlod paged_hlod(const std::shared_ptr<NodeStore>& store);

}  // namespace occlod::hlod

namespace occlod {

// The .ohlod file: an HLOD as versioned, checksummed sections. The layout is described in docs/internals/formats.md.

// Version of files whose nodes have images of their own. Others have version 7 with an origin, else 6 when compressed,
// else 5, or 4 without texture coordinates, materials and seams.
// read_ohlod() reads also versions 1 to 3, in which boxes of nodes do not hold what has vanished: it takes the larger
// boxes around all that is below in their place, so what is drawn is right, but more of it is than of a new file.
inline constexpr std::uint32_t ohlod_version = 8;

// What a file holds.
struct OhlodFile {
  hlod::Hlod hlod;                                      // mapped or in memory
  MeshReport report;                                    // of the mesh that it was built from
  OlodCompression compression = OlodCompression::zstd;  // of the file
  std::uint32_t version = ohlod_version;                // likewise
};

// What a file has of the images that materials name.
enum class OhlodImages {
  named,  // their names, and those that the mesh's file held
  nodes,  // also an image for each node, of what its triangles show, where images can be divided among nodes
};

// How an .ohlod file is written.
struct OhlodOptions {
  // With compression meshes and splits of nodes take about half their bytes, none of them lost, node by node.
  OlodCompression compression = OlodCompression::zstd;
  OhlodImages images = OhlodImages::named;  // what becomes of images
  std::filesystem::path image_folder = {};  // as for write_olod()
  int threads = 0;                          // in [0, 1024]; 0: one for each core. The result does not depend on it
  // Called now and then with the share of images that are made, in [0, 1]. What it throws ends the writing, and leaves
  // what is there.
  std::function<void(double)> images_progress = {};
  // A file that keeps finished images of nodes until it is removed, so that a writing that was killed goes on where it
  // was; empty: none. Error for a file that is no such journal, or that another writing uses.
  std::filesystem::path images_journal = {};
};

// Writes beside `path` and renames, so that a file that was there stays as it was when writing fails. The same
// arguments give the same bytes. Throws Error that names the file. O(bytes).
//
// OhlodImages::nodes finds images in `image_folder` and packs what each node shows of them anew, as
// tiles::write_tileset() does: with the texels of the input on level 0, others with about one for each error; errors of
// nodes are then no less than their texels. Nodes have none where the HLOD has splits within nodes, whose coordinates
// they would need; those that it has are written in any case. O(texels), and 7 bytes for each texel of the input, in
// scratch files while a MemoryLimit lives.
void write_ohlod(const std::filesystem::path& path, const hlod::Hlod& hlod, const MeshReport& report,
                 const OhlodOptions& options = {});

// Reads a file: checks magic, version, sizes, and all that is known of nodes without their meshes: O(nodes). The mesh
// of a node is checked (checksum and content) when Hlod::require() is first called for it, its splits when
// require_within() is; require_all() checks the whole file. All throw Error that says what failed and where. Of a
// compressed file, what has been checked is kept in memory, decompressed: all meshes and splits at most.
//
// What read_olod() says of mapped files holds here too: a file that is open must not be cut short.
[[nodiscard]] OhlodFile read_ohlod(const std::filesystem::path& path, OlodAccess access = OlodAccess::mapped);

// Opens a file without its meshes: these come and go within a budget while the HLOD is traversed, checked as they come
// (see Hlod::store()). Splits within nodes are left out. What is known of nodes without their meshes is copied, so that
// nothing depends on what becomes of the file: a mesh that is damaged or gone never comes, coarser ones are drawn in
// its place, and NodeStore::take_failures() tells. Throws Error as read_ohlod() does, for options out of their range, a
// budget that is too small, and when the coarsest nodes are damaged. O(nodes).
[[nodiscard]] OhlodFile open_ohlod(const std::filesystem::path& path, const hlod::CacheOptions& cache);

}  // namespace occlod
