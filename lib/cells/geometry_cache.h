// Frames of a packed file that are in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "cells/packed_geometry.h"

namespace occlod::vlod {

// Thread-safe. Its lock is not held while anything is read.
class GeometryCache {
 public:
  using Frames = std::vector<std::shared_ptr<const GeometryFrame>>;

  // Keeps nothing until limit() says how much. `before_read`: called with the bytes that are read next, on the thread
  // that reads; may be empty. `geometry` outlives it.
  GeometryCache(const PackedGeometry& geometry, std::function<void(std::uint64_t bytes)> before_read)
      : geometry_(geometry), before_read_(std::move(before_read)) {}

  [[nodiscard]] const PackedGeometry& geometry() const noexcept { return geometry_; }
  // In the order of the frames, which ascend. Reads those that are not there, neighbours at once, and adds what was
  // read to `bytes_read`. Throws Error as PackedGeometry::read() does. Clears `out`.
  void get(std::span<const std::uint32_t> frames, Frames& out, std::uint64_t& bytes_read);
  // Keeps no more bytes than that from now on; drops what has not been asked for longest.
  void limit(std::size_t bytes);

  [[nodiscard]] std::size_t bytes() const;

 private:
  void find(std::span<const std::uint32_t> frames, Frames& out);
  void read(std::uint32_t first, std::span<std::shared_ptr<const GeometryFrame>> out, std::uint64_t& bytes_read);
  void shrink();

  const PackedGeometry& geometry_;
  std::function<void(std::uint64_t bytes)> before_read_;
  mutable std::mutex mutex_;
  struct Entry {
    std::shared_ptr<const GeometryFrame> frame;
    std::uint64_t asked = 0;  // when: calls of get()
  };
  std::map<std::uint32_t, Entry> entries_;
  std::size_t bytes_ = 0, limit_ = 0;
  std::uint64_t calls_ = 0;
};

}  // namespace occlod::vlod
