// Packs the mesh of a node, or its splits, into fewer bytes, of which none are lost.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/memory.h"
#include "hlod/store/hlod_data.h"

namespace occlod::ohlod {

// So many raw bytes for each packed one at most: zeros follow what is packed better. A file that claims more is refused
// before memory is allocated.
inline constexpr std::size_t max_packing = 1024;

struct NodeStreams;

// One at a time; buffers are kept.
class NodePacker {
 public:
  // Throws std::bad_alloc.
  NodePacker();
  ~NodePacker();
  NodePacker(const NodePacker&) = delete;
  NodePacker& operator=(const NodePacker&) = delete;

  // Appends what belongs to node n, which has been required. O(bytes). Throws std::bad_alloc.
  void pack_mesh(const hlod::HlodView& view, hlod::NodeId n, LargeVector<std::byte>& out);
  void pack_splits(const hlod::HlodView& view, hlod::NodeId n, LargeVector<std::byte>& out);

 private:
  struct Context;
  void pack(const NodeStreams& node, std::span<const std::byte> raw, LargeVector<std::byte>& out);

  std::unique_ptr<Context> context_;
  std::vector<std::byte> filtered_, planes_, frame_;
};

// One at a time; buffers are kept.
class NodeUnpacker {
 public:
  // Throws std::bad_alloc.
  NodeUnpacker();
  ~NodeUnpacker();
  NodeUnpacker(const NodeUnpacker&) = delete;
  NodeUnpacker& operator=(const NodeUnpacker&) = delete;

  // The reverse: of node n, whose raw bytes with what aligns the next have the size of `raw`. False when `packed` is
  // damaged. Never writes outside `raw`. O(bytes). Throws std::bad_alloc.
  [[nodiscard]] bool unpack_mesh(const hlod::HlodView& view, hlod::NodeId n, std::span<const std::byte> packed,
                                 std::span<std::byte> raw);
  [[nodiscard]] bool unpack_splits(const hlod::HlodView& view, hlod::NodeId n, std::span<const std::byte> packed,
                                   std::span<std::byte> raw);

 private:
  struct Context;
  [[nodiscard]] bool unpack(const NodeStreams& node, std::span<const std::byte> packed, std::span<std::byte> raw);

  std::unique_ptr<Context> context_;
  std::vector<std::byte> planes_;
};

}  // namespace occlod::ohlod
