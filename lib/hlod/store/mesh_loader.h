// Reads the meshes of nodes on another thread, and caches them within a budget.
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

#include "base/threads.h"
#include "occlod/hlod.h"
#include "occlod/node_store.h"

namespace occlod::hlod {

using MeshBytes = std::unique_ptr<std::byte[]>;

// Locates a mesh where it is stored, possibly in fewer bytes than in memory.
struct StoredMesh {
  std::uint64_t place = 0;
  std::size_t bytes = 0;
};

// Locates the image of a node in a file that is far away.
struct StoredImage {
  std::uint64_t place = 0;     // in the file
  std::size_t bytes = 0;       // 0: the node has none
  std::uint64_t checksum = 0;  // XXH3-64 of it
};

class LoadQueue;

// Only one thread at a time may call this, except for bytes_of(), stored() and stored_image().
class MeshSource {
 public:
  MeshSource() = default;
  MeshSource(const MeshSource&) = delete;
  MeshSource& operator=(const MeshSource&) = delete;
  virtual ~MeshSource() = default;

  // Returns the size in memory of the mesh of node n with padding for the next, a multiple of mesh_alignment except for
  // the last mesh.
  [[nodiscard]] virtual std::size_t bytes_of(NodeId n) const noexcept = 0;
  // Returns where the mesh of node n is stored. Consecutive nodes are adjacent if one ends where the next begins.
  [[nodiscard]] virtual StoredMesh stored(NodeId n) const noexcept = 0;
  // Returns where the image of node n is stored, if it has to be fetched beside the mesh before unpack() is called.
  [[nodiscard]] virtual StoredImage stored_image(NodeId /*n*/) const noexcept { return {}; }
  // Reads the stored meshes of consecutive, adjacent nodes from `first` on, each into an array of stored() bytes.
  // Throws Error when they cannot be read.
  virtual void read(NodeId first, std::span<const std::span<std::byte>> meshes) = 0;
  // Returns the mesh of node n, of bytes_of() bytes, from its stored bytes. Throws Error when they are damaged.
  [[nodiscard]] virtual MeshBytes unpack(NodeId n, MeshBytes stored) = 0;
  // Returns whether the coarsest meshes are read before anything wants them, and kept: not where reading is dear.
  [[nodiscard]] virtual bool reads_ahead() const noexcept { return true; }
  // Returns what reads meshes while frames are drawn, and which this source must outlive: a thread, unless a source has
  // another way.
  [[nodiscard]] virtual std::unique_ptr<LoadQueue> make_queue();
};

// Decides which meshes of an HLOD are in memory, within a budget, and which are evicted for others. Reads nothing
// itself.
class NodeCache {
 public:
  enum class State : std::uint8_t {
    absent,
    coming,    // its memory is reserved
    resident,  // it is in memory
    failed,    // it is never loaded
  };
  // Tells what a request may evict. Prefetched meshes evict neither each other nor meshes that are needed.
  enum class Urgency { now, soon };

  // Starts empty, with a budget of 0 bytes. The references must outlive the cache.
  NodeCache(const HlodView& view, const MeshSource& source);

  [[nodiscard]] State state(NodeId n) const noexcept { return entries_[n].state; }
  // Returns the mesh of each node, null where it is not resident.
  [[nodiscard]] const MeshBytes* meshes() const noexcept { return meshes_.data(); }
  [[nodiscard]] std::size_t budget() const noexcept { return budget_; }
  [[nodiscard]] std::size_t resident_bytes() const noexcept { return resident_bytes_; }
  [[nodiscard]] std::size_t resident_nodes() const noexcept { return resident_nodes_; }
  [[nodiscard]] std::size_t coming_bytes() const noexcept { return coming_bytes_; }
  [[nodiscard]] std::uint64_t evictions() const noexcept { return evictions_; }
  // Returns the size of the roots' meshes.
  [[nodiscard]] std::size_t min_budget() const;
  // Returns the number of nodes, coarsest first, that stay once they are resident. Roots on finer levels stay, too.
  [[nodiscard]] NodeId lasting_nodes() const noexcept { return lasting_; }
  [[nodiscard]] bool are_parents_resident(NodeId n) const;

  // Sets the budget, at least min_budget(), when no node is coming. Evicts meshes that no longer fit, needed or not.
  void set_budget(std::size_t bytes);
  void begin_frame() noexcept { ++frame_; }
  // Keeps node n, which is not absent, for two frames, whatever else is loaded.
  void need(NodeId n) noexcept { entries_[n].used = frame_; }
  // Keeps node n for two frames from being evicted by prefetched meshes.
  void keep(NodeId n) noexcept;

  // Appends those of these nodes and of their ancestors that are absent to `missing`, ascending. Returns false if any
  // of them has failed.
  [[nodiscard]] bool find_missing(std::span<const NodeId> nodes, std::vector<NodeId>& missing) const;
  // Reserves memory for absent nodes, ascending, whose parents are resident, coming or among them, and evicts others.
  // Returns false, without reserving any, if that does not free enough memory.
  [[nodiscard]] bool reserve(std::span<const NodeId> nodes, Urgency urgency);
  // release() gives up the reservation of a coming node; put() fulfils it, when its parents are resident; fail() marks
  // the node as failed for ever.
  void release(NodeId n);
  void put(NodeId n, MeshBytes mesh);
  void fail(NodeId n);

 private:
  struct Entry {
    std::uint32_t used = 0;      // frame
    std::uint16_t children = 0;  // number of children that are resident or coming
    State state = State::absent;
    bool queued : 1 = false;  // in leaves_
    bool is_root : 1 = false;
  };
  // Names a node that may be evicted if it has not been used since.
  struct Leaf {
    std::uint32_t used = 0;
    NodeId node = 0;
    // The greatest is evicted first: the one unused for longest, and among equals the finest.
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
  std::uint32_t frame_ = 8;  // so that earlier frames have positive numbers
};

// Holds consecutive nodes whose meshes are adjacent, to be read together.
struct MeshLoad {
  NodeId first = 0;
  std::size_t bytes = 0;              // as stored
  std::vector<MeshBytes> meshes;      // of the nodes from `first` on; null before they are read, and where that failed
  std::vector<std::string> problems;  // per mesh, one line if it failed
};

// Reads on the calling thread. Throws Error for the first mesh that fails.
void read_or_throw(MeshSource& source, MeshLoad& load);
// Reads on the calling thread. Records problems in the load instead of throwing.
void read_meshes(MeshSource& source, MeshLoad& load);

// Takes loads, has them read, and gives them back.
class LoadQueue {
 public:
  LoadQueue() = default;
  LoadQueue(const LoadQueue&) = delete;
  LoadQueue& operator=(const LoadQueue&) = delete;
  // Must not be called when is_lost().
  virtual ~LoadQueue() = default;

  // True where nothing can be read any more: other functions throw Error.
  [[nodiscard]] virtual bool is_lost() const noexcept = 0;
  // Queues loads behind all earlier ones.
  virtual void push(std::vector<MeshLoad> loads) = 0;
  // Returns the loads that can still be taken back, in order, and forgets them.
  [[nodiscard]] virtual std::vector<MeshLoad> withdraw() = 0;
  // Appends the finished loads, in order. Waits until `out` has `least` loads or none is being read here.
  virtual void collect(std::deque<MeshLoad>& out, std::size_t least = 0) = 0;
};

// Reads on a thread of its own.
class MeshLoader final : public LoadQueue {
 public:
  // The source must outlive the loader.
  explicit MeshLoader(MeshSource& source);
  // Waits for the load that is being read.
  ~MeshLoader() override;

  // True in a process that was forked since, which has no thread to read.
  [[nodiscard]] bool is_lost() const noexcept override { return began_.is_in_child(); }

  void push(std::vector<MeshLoad> loads) override;
  // Returns the loads that have not begun.
  [[nodiscard]] std::vector<MeshLoad> withdraw() override;
  void collect(std::deque<MeshLoad>& out, std::size_t least = 0) override;

 private:
  void run();
  void require_thread() const;

  MeshSource& source_;
  ForkMark began_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<MeshLoad> waiting_, ended_;
  bool is_reading_ = false, stopped_ = false;
  std::thread thread_;
};

// Limits the bytes of meshes that arrive in one frame, if it is more than one mesh.
inline constexpr std::size_t max_bytes_in_frame = std::size_t{4} << 20U;

// Models the transfer of loads from a store to its loader: the frame in which each arrives.
class MeshLink {
 public:
  // `frame_bytes`: takes the place of max_bytes_in_frame; > 0.
  explicit MeshLink(std::size_t frame_bytes) : frame_bytes_(frame_bytes) {}
  MeshLink(const MeshLink&) = delete;
  MeshLink& operator=(const MeshLink&) = delete;
  virtual ~MeshLink() = default;

  // Queues loads behind all earlier ones.
  virtual void push(std::vector<MeshLoad> loads) = 0;
  // Returns the loads whose transfer has not begun, and forgets them.
  [[nodiscard]] virtual std::vector<MeshLoad> withdraw() = 0;
  // Advances by one frame. Returns the loads whose transfer ended meanwhile.
  [[nodiscard]] virtual std::vector<MeshLoad> pass_frame() = 0;
  // Returns how many of the transferred loads, from the first on, arrive in this frame. Each is counted once.
  [[nodiscard]] virtual std::size_t take_due() = 0;
  // Forgets all loads. Returns those that were not transferred.
  [[nodiscard]] virtual std::vector<MeshLoad> clear() = 0;

  [[nodiscard]] std::size_t frame_bytes() const noexcept { return frame_bytes_; }

 private:
  std::size_t frame_bytes_;
};

}  // namespace occlod::hlod
