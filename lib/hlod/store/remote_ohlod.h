// An .ohlod file far away, whose bytes somebody else fetches, for instance by HTTP: what is known of nodes first, then
// meshes, in the order in which traversal wants them. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "occlod/node_store.h"

namespace occlod::hlod {

// Bytes of a file, `begin` included.
struct ByteRange {
  std::uint64_t begin = 0, end = 0;

  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

// Bytes to fetch for meshes of nodes, or for their images.
struct RemoteRequest {
  std::uint32_t id = 0;
  ByteRange range;
  bool again = false;  // some have come before, damaged: caches may hold them
};

class RemoteBytes;
class RemoteLoads;

class RemoteOhlod {
 public:
  // `name` stands for the file in messages, `bytes` is its size.
  RemoteOhlod(std::string name, std::uint64_t bytes);
  ~RemoteOhlod();
  RemoteOhlod(const RemoteOhlod&) = delete;
  RemoteOhlod& operator=(const RemoteOhlod&) = delete;

  // Takes bytes of the file that open() wants, or others; copies them.
  void put(std::uint64_t offset, std::span<const std::byte> bytes);
  // Opens the file as open_ohlod() does, once what is needed for that has been put. Returns what is missing, ascending:
  // nothing when the file is open. It asks for header and table, then for all tables at once, then for the meshes of
  // roots. Throws Error as open_ohlod() does. With LoadMode::blocking the whole file must have been put.
  [[nodiscard]] std::vector<ByteRange> open(const CacheOptions& cache);
  // Returns the file, once it is open.
  [[nodiscard]] const OhlodFile& file() const noexcept { return *file_; }

  // What follows is for files opened with LoadMode::async. Frames ask for meshes: returns what to fetch next, the most
  // urgent first, if anything. Each request is answered once, by one of the next three, unless it is cancelled.
  [[nodiscard]] std::optional<RemoteRequest> next();
  // Takes the bytes of a request, at any time between frames: meshes come with the next frame, once their images are
  // there too. What is damaged is asked for again, once.
  void arrive(std::uint32_t id, std::span<const std::byte> bytes);
  // Tells that they have not come: they are asked for again if they are still wanted.
  void lose(std::uint32_t id);
  // Tells that they never will: coarser nodes take the place of theirs.
  void fail(std::uint32_t id, const std::string& problem);
  // Returns the requests that frames since the last call have made needless. Answers to them are ignored.
  [[nodiscard]] std::vector<std::uint32_t> take_cancelled();
  // Returns a line on each image that has come damaged since the last call: NodeMesh::image of its node is 0
  // throughout. Those of roots are not asked for again.
  [[nodiscard]] std::vector<std::string> take_dropped_images();

 private:
  std::string name_;
  std::shared_ptr<RemoteBytes> bytes_;
  std::optional<OhlodFile> file_;
  RemoteLoads* loads_ = nullptr;  // of the store of file_
  std::vector<std::string> dropped_images_;
};

}  // namespace occlod::hlod
