// Meshes of an HLOD in memory, as a store reads them from a file: with damage and delays on demand.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "hlod/store/hlod_data.h"
#include "hlod/store/mesh_loader.h"
#include "occlod/base.h"
#include "occlod/node_store.h"
#include "papers/simulated_link.h"

namespace occlod::hlod::test {

// What happens to reads; shared with the source, so that a test may change it between frames.
struct ReadFaults {
  std::set<NodeId> unreadable, damaged;           // before the store is opened
  std::function<void(NodeId first)> before = {};  // each read, on the thread that reads
  std::atomic<std::size_t> reads = 0, nodes = 0;  // so far
};

class MemorySource final : public MeshSource {
 public:
  MemorySource(Hlod hlod, std::shared_ptr<ReadFaults> faults) : hlod_(std::move(hlod)), faults_(std::move(faults)) {}

  [[nodiscard]] std::size_t bytes_of(NodeId n) const noexcept override {
    const HlodView& view = hlod_.data();
    const std::size_t bytes = align_mesh(MeshLayout(view.nodes[n], arrays_of(view)).bytes);
    return std::min<std::size_t>(bytes, view.meshes.size() - view.nodes[n].mesh);
  }

  [[nodiscard]] StoredMesh stored(NodeId n) const noexcept override { return {hlod_.node(n).mesh, bytes_of(n)}; }

  void read(NodeId first, std::span<const std::span<std::byte>> meshes) override {
    if (faults_->before) faults_->before(first);
    ++faults_->reads;
    faults_->nodes += meshes.size();
    std::size_t place = hlod_.node(first).mesh;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      if (faults_->unreadable.contains(first + static_cast<NodeId>(i)))
        throw Error({"memory", "node " + std::to_string(first), "cannot be read", ""});
      std::ranges::copy(hlod_.data().meshes.subspan(place, meshes[i].size()), meshes[i].begin());
      place += meshes[i].size();
    }
  }

  [[nodiscard]] MeshBytes unpack(NodeId n, MeshBytes stored) override {
    if (faults_->damaged.contains(n)) throw Error({"memory", "node " + std::to_string(n), "is damaged", ""});
    return stored;
  }

 private:
  Hlod hlod_;
  std::shared_ptr<ReadFaults> faults_;
};

// The same HLOD with a store.
[[nodiscard]] inline Hlod paged(const Hlod& hlod, const TrialCacheOptions& options,
                                const std::shared_ptr<ReadFaults>& faults = std::make_shared<ReadFaults>()) {
  HlodView view = hlod.data();
  view.meshes = {};
  view.within = {};
  view.splits = {};
  const auto owner = std::make_shared<const Hlod>(hlod);
  const auto store =
      std::make_shared<NodeStore>(view, owner, std::make_unique<MemorySource>(hlod, faults), options.cache());
  simulate_link(*store, options);
  return paged_hlod(store);
}

[[nodiscard]] inline std::size_t bytes_of(const Hlod& hlod, std::span<const NodeId> nodes) {
  const MemorySource source(hlod, nullptr);
  std::size_t bytes = 0;
  for (const NodeId n : nodes) bytes += source.bytes_of(n);
  return bytes;
}
[[nodiscard]] inline std::size_t bytes_of(const Hlod& hlod, NodeId n) { return bytes_of(hlod, {&n, 1}); }

}  // namespace occlod::hlod::test
