// Compresses the mesh of a node, or its splits, without loss.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/memory.h"
#include "hlod/store/hlod_data.h"

namespace occlod::ohlod {

// Limits the raw bytes per packed byte: data that is packed better is padded with zeros. A file that claims more is
// refused before memory is allocated.
inline constexpr std::size_t max_packing = 1024;

struct NodeStreams;

// Packs one node at a time and reuses its buffers.
class NodePacker {
 public:
  // Throws std::bad_alloc.
  NodePacker();
  ~NodePacker();
  NodePacker(const NodePacker&) = delete;
  NodePacker& operator=(const NodePacker&) = delete;

  // Appends the packed mesh or splits of node n, which has been required. O(bytes). Throws std::bad_alloc.
  void pack_mesh(const hlod::HlodView& view, hlod::NodeId n, LargeVector<std::byte>& out);
  void pack_splits(const hlod::HlodView& view, hlod::NodeId n, LargeVector<std::byte>& out);

 private:
  struct Context;
  void pack(const NodeStreams& node, std::span<const std::byte> raw, LargeVector<std::byte>& out);

  std::unique_ptr<Context> context_;
  std::vector<std::byte> filtered_, planes_, frame_;
};

// Unpacks one node at a time and reuses its buffers.
class NodeUnpacker {
 public:
  // Throws std::bad_alloc.
  NodeUnpacker();
  ~NodeUnpacker();
  NodeUnpacker(const NodeUnpacker&) = delete;
  NodeUnpacker& operator=(const NodeUnpacker&) = delete;

  // Unpacks the mesh or splits of node n, of the size of `raw` with padding for the next. Returns false when `packed`
  // is damaged. Never writes outside `raw`. O(bytes). Throws std::bad_alloc.
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
