// Where a store reads meshes.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <queue>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "occlod/hlod.h"
#include "occlod/node_store.h"

namespace occlod::hlod {

using MeshBytes = std::unique_ptr<std::byte[]>;

// A mesh where it is stored, which may take fewer bytes than in memory.
struct StoredMesh {
  std::uint64_t place = 0;
  std::size_t bytes = 0;
};

// Called by one thread at a time, but for bytes_of() and stored().
class MeshSource {
 public:
  MeshSource() = default;
  MeshSource(const MeshSource&) = delete;
  MeshSource& operator=(const MeshSource&) = delete;
  virtual ~MeshSource() = default;

  // In memory, of the mesh of node n and what aligns the next one; a multiple of mesh_alignment but for the last.
  [[nodiscard]] virtual std::size_t bytes_of(NodeId n) const noexcept = 0;
  // Of node n. Nodes of consecutive ids lie side by side where one ends at the place of the next.
  [[nodiscard]] virtual StoredMesh stored(NodeId n) const noexcept = 0;
  // What is stored of consecutive nodes from `first` on, which lie side by side, each into an array of stored() bytes.
  // Throws Error when it cannot be read.
  virtual void read(NodeId first, std::span<const std::span<std::byte>> meshes) = 0;
  // The mesh of node n, of bytes_of() bytes, from what was read of it. Throws Error when that is damaged.
  [[nodiscard]] virtual MeshBytes unpack(NodeId n, MeshBytes stored) = 0;
};

// Which meshes of an HLOD are there, within a budget: who comes, and who leaves for it. Reads nothing.

class NodeCache {
 public:
  enum class State : std::uint8_t {
    absent,
    coming,    // room is kept for it
    resident,  // it is there
    failed,    // it never comes
  };
  // For what something else may have to leave: prefetched meshes neither make each other leave nor what is needed.
  enum class Urgency { now, soon };

  // Of nothing, within 0 bytes. Both outlive the cache.
  NodeCache(const HlodView& view, const MeshSource& source);

  [[nodiscard]] State state(NodeId n) const noexcept { return entries_[n].state; }
  // By node, null where it is not there.
  [[nodiscard]] const MeshBytes* meshes() const noexcept { return meshes_.data(); }
  [[nodiscard]] std::size_t budget() const noexcept { return budget_; }
  [[nodiscard]] std::size_t resident_bytes() const noexcept { return resident_bytes_; }
  [[nodiscard]] std::size_t resident_nodes() const noexcept { return resident_nodes_; }
  [[nodiscard]] std::size_t coming_bytes() const noexcept { return coming_bytes_; }
  [[nodiscard]] std::uint64_t evictions() const noexcept { return evictions_; }
  // Of the roots.
  [[nodiscard]] std::size_t min_budget() const;
  // Coarsest first; they stay once they are there. Roots on finer levels stay, too.
  [[nodiscard]] NodeId lasting_nodes() const noexcept { return lasting_; }
  [[nodiscard]] bool are_parents_resident(NodeId n) const;

  // At least min_budget(). Nothing is coming. What does not fit any more leaves, needed or not.
  void set_budget(std::size_t bytes);
  void begin_frame() noexcept { ++frame_; }
  // The node, which is not absent, stays for two frames, whoever else is to come.
  void need(NodeId n) noexcept { entries_[n].used = frame_; }
  // Prefetched ones do not make it leave in the next two frames.
  void keep(NodeId n) noexcept;

  // Adds the absent ones of these nodes and of those above them to `missing`, ascending. False if any has failed.
  [[nodiscard]] bool find_missing(std::span<const NodeId> nodes, std::vector<NodeId>& missing) const;
  // Keeps room for nodes that are absent, ascending; those above them are there, coming or among them. Others leave. If
  // that is not enough, nothing comes, and false.
  [[nodiscard]] bool reserve(std::span<const NodeId> nodes, Urgency urgency);
  // A node that was coming does not come, or does. Its parents are there when it does.
  void release(NodeId n);
  void put(NodeId n, MeshBytes mesh);
  void fail(NodeId n);

 private:
  struct Entry {
    std::uint32_t used = 0;      // frame
    std::uint16_t children = 0;  // that are there or coming
    State state = State::absent;
    bool queued : 1 = false;  // in leaves_
    bool is_root : 1 = false;
  };
  // May leave if it has not been used since.
  struct Leaf {
    std::uint32_t used = 0;
    NodeId node = 0;
    // The last to leave is the least: that used last, of those the coarsest.
    friend bool operator<(const Leaf& a, const Leaf& b) { return a.used != b.used ? a.used > b.used : a.node < b.node; }
  };

  template <typename Visit>
  void for_each_parent(NodeId n, const Visit& visit) const;
  [[nodiscard]] bool may_leave(NodeId n) const;
  void add_children(NodeId n, int count);
  void queue_leaf(NodeId n);
  bool evict_one(std::uint32_t last_used);
  void evict(NodeId n);

  const HlodView& view_;
  const MeshSource& source_;
  std::vector<Entry> entries_;
  std::vector<MeshBytes> meshes_;
  std::priority_queue<Leaf> leaves_;
  std::size_t budget_ = 0, resident_bytes_ = 0, coming_bytes_ = 0, resident_nodes_ = 0;
  std::uint64_t evictions_ = 0;
  NodeId lasting_ = 0;
  std::uint32_t frame_ = 8;  // so that there are frames before the first
};

// Reads and checks meshes, on a thread of its own.

// Consecutive nodes whose meshes lie side by side, to be read together.
struct MeshLoad {
  NodeId first = 0;
  std::size_t bytes = 0;              // as they are stored
  std::vector<MeshBytes> meshes;      // of the nodes from `first` on; null before they are read, and where that failed
  std::vector<std::string> problems;  // of each, one line if it failed
};

// Reads on the calling thread. Throws Error for the first that fails.
void read_or_throw(MeshSource& source, MeshLoad& load);
// Likewise, but does not throw.
void read_meshes(MeshSource& source, MeshLoad& load);

class MeshLoader {
 public:
  // The source outlives the loader.
  explicit MeshLoader(MeshSource& source);
  // Waits for the load that has begun.
  ~MeshLoader();
  MeshLoader(const MeshLoader&) = delete;
  MeshLoader& operator=(const MeshLoader&) = delete;

  // After all that were pushed before.
  void push(std::vector<MeshLoad> loads);
  // Those that have not begun, in order.
  [[nodiscard]] std::vector<MeshLoad> withdraw();
  // Appends those that have ended, in order; waits until `out` has so many or none is left.
  void collect(std::deque<MeshLoad>& out, std::size_t least = 0);

 private:
  void run();

  MeshSource& source_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<MeshLoad> waiting_, ended_;
  bool is_reading_ = false, stopped_ = false;
  std::thread thread_;
};

// The most bytes of meshes that come in one frame, if it is more than one mesh.
inline constexpr std::size_t max_bytes_in_frame = std::size_t{4} << 20U;

// What loads pass on their way from a store to its loader: in which frame they come.
class MeshLink {
 public:
  // `frame_bytes`: takes the place of max_bytes_in_frame; > 0.
  explicit MeshLink(std::size_t frame_bytes) : frame_bytes_(frame_bytes) {}
  MeshLink(const MeshLink&) = delete;
  MeshLink& operator=(const MeshLink&) = delete;
  virtual ~MeshLink() = default;

  // To be transferred after all that were pushed before.
  virtual void push(std::vector<MeshLoad> loads) = 0;
  // Those whose transfer has not begun.
  [[nodiscard]] virtual std::vector<MeshLoad> withdraw() = 0;
  // One frame goes by: what has been transferred meanwhile.
  [[nodiscard]] virtual std::vector<MeshLoad> pass_frame() = 0;
  // How many of the loads so transferred, from the first on, come in this frame. Each is counted once.
  [[nodiscard]] virtual std::size_t take_due() = 0;
  // Loads that were transferred are forgotten. Returns all others.
  [[nodiscard]] virtual std::vector<MeshLoad> clear() = 0;

  [[nodiscard]] std::size_t frame_bytes() const noexcept { return frame_bytes_; }

 private:
  std::size_t frame_bytes_;
};

}  // namespace occlod::hlod
