// Which meshes of an HLOD are there, within a budget: who comes, and who leaves for it. Reads nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <queue>
#include <span>
#include <vector>

#include "hlod/build/mesh_source.h"
#include "occlod/hlod/hlod.h"

namespace occlod::hlod {

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
  [[nodiscard]] std::size_t least_budget() const;
  // Coarsest first; they stay once they are there. Roots on finer levels stay, too.
  [[nodiscard]] NodeId lasting_nodes() const noexcept { return lasting_; }
  [[nodiscard]] bool are_parents_resident(NodeId n) const;

  // At least least_budget(). Nothing is coming. What does not fit any more leaves, needed or not.
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

}  // namespace occlod::hlod
