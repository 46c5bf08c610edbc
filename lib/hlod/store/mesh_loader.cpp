#include "hlod/store/mesh_loader.h"

#include <algorithm>
#include <cassert>
#include <exception>
#include <iterator>
#include <limits>
#include <utility>

namespace occlod::hlod {
namespace {

constexpr std::size_t lasting_share = 16;  // the coarsest nodes may take this fraction of the budget

}  // namespace

template <typename Visit>
void NodeCache::for_each_parent(NodeId n, const Visit& visit) const {
  const Node& node = view_.nodes[n];
  for (const Patch& patch : view_.patches.subspan(node.first_patch, node.patches))
    if (patch.parent != no_id) visit(patch.parent);
}

NodeCache::NodeCache(const HlodView& view, const MeshSource& source)
    : view_(view), source_(source), entries_(view.nodes.size()), meshes_(view.nodes.size()) {
  for (const NodeId root : view.roots) entries_[root].is_root = true;
}

std::size_t NodeCache::min_budget() const {
  std::size_t bytes = 0;
  for (const NodeId root : view_.roots) bytes += source_.bytes_of(root);
  return bytes;
}

bool NodeCache::are_parents_resident(NodeId n) const {
  bool all = true;
  for_each_parent(n, [&](NodeId parent) { all = all && state(parent) == State::resident; });
  return all;
}

void NodeCache::set_budget(std::size_t bytes) {
  assert(bytes >= min_budget() && coming_bytes_ == 0);
  budget_ = bytes;
  const std::size_t most = std::min(budget_ / lasting_share, budget_ - min_budget());
  const NodeId before = std::exchange(lasting_, 0);
  for (std::size_t sum = 0; source_.reads_ahead() && lasting_ < entries_.size(); ++lasting_) {
    sum += source_.bytes_of(lasting_);
    if (sum > most) break;
  }
  for (NodeId n = lasting_; n < before; ++n) queue_leaf(n);
  while (resident_bytes_ > budget_) {
    const bool evicted = evict_one(std::numeric_limits<std::uint32_t>::max());
    assert(evicted);  // everything but the roots may be evicted
    static_cast<void>(evicted);
  }
}

void NodeCache::keep(NodeId n) noexcept { entries_[n].used = std::max(entries_[n].used, frame_ - 2); }

bool NodeCache::find_missing(std::span<const NodeId> nodes, std::vector<NodeId>& missing) const {
  const auto first = static_cast<std::ptrdiff_t>(missing.size());
  bool may_come = true;
  const auto add = [&](NodeId n) {
    may_come = may_come && state(n) != State::failed;
    if (state(n) == State::absent && std::find(missing.begin() + first, missing.end(), n) == missing.end())
      missing.push_back(n);
  };
  std::ranges::for_each(nodes, add);
  for (auto i = static_cast<std::size_t>(first); i < missing.size() && may_come; ++i) for_each_parent(missing[i], add);
  std::sort(missing.begin() + first, missing.end());
  return may_come;
}

bool NodeCache::reserve(std::span<const NodeId> nodes, Urgency urgency) {
  std::size_t bytes = 0;
  for (const NodeId n : nodes) {
    assert(state(n) == State::absent);
    entries_[n].state = State::coming;
    entries_[n].used = urgency == Urgency::now ? frame_ : frame_ - 2;
    add_children(n, 1);  // so that their parents stay
    bytes += source_.bytes_of(n);
  }
  coming_bytes_ += bytes;
  // The nodes that the last two frames needed stay. Prefetched nodes do not evict what keep() protects either.
  const std::uint32_t last_used = frame_ - (urgency == Urgency::now ? 2 : 4);
  while (resident_bytes_ + coming_bytes_ > budget_) {
    if (evict_one(last_used)) continue;
    for (const NodeId n : nodes) release(n);
    return false;
  }
  return true;
}

void NodeCache::release(NodeId n) {
  assert(state(n) == State::coming);
  entries_[n].state = State::absent;
  coming_bytes_ -= source_.bytes_of(n);
  add_children(n, -1);
}

void NodeCache::put(NodeId n, MeshBytes mesh) {
  assert(state(n) == State::coming && are_parents_resident(n));
  entries_[n].state = State::resident;
  meshes_[n] = std::move(mesh);
  coming_bytes_ -= source_.bytes_of(n);
  resident_bytes_ += source_.bytes_of(n);
  ++resident_nodes_;
  queue_leaf(n);
}

void NodeCache::fail(NodeId n) {
  release(n);
  entries_[n].state = State::failed;
}

bool NodeCache::may_leave(NodeId n) const {
  const Entry& entry = entries_[n];
  return entry.state == State::resident && entry.children == 0 && n >= lasting_ && !entry.is_root;
}

void NodeCache::add_children(NodeId n, int count) {
  for_each_parent(n, [&](NodeId parent) {
    entries_[parent].children = static_cast<std::uint16_t>(entries_[parent].children + count);
    queue_leaf(parent);
  });
}

void NodeCache::queue_leaf(NodeId n) {
  if (!may_leave(n) || entries_[n].queued) return;
  entries_[n].queued = true;
  leaves_.push({entries_[n].used, n});
}

// Evicts the next node, unless it has been used since frame `last_used`. Returns whether it did. Outdated entries of
// the queue are renewed when they come first.
bool NodeCache::evict_one(std::uint32_t last_used) {
  while (!leaves_.empty()) {
    const Leaf leaf = leaves_.top();
    const bool is_true = may_leave(leaf.node) && entries_[leaf.node].used == leaf.used;
    if (is_true && leaf.used > last_used) return false;
    leaves_.pop();
    entries_[leaf.node].queued = false;
    if (is_true) {
      evict(leaf.node);
      return true;
    }
    queue_leaf(leaf.node);
  }
  return false;
}

void NodeCache::evict(NodeId n) {
  entries_[n].state = State::absent;
  meshes_[n].reset();
  resident_bytes_ -= source_.bytes_of(n);
  --resident_nodes_;
  ++evictions_;
  add_children(n, -1);
}

namespace {

// Reads the stored meshes of the nodes [begin, end) of the load. Throws Error.
void read_part(MeshSource& source, MeshLoad& load, std::size_t begin, std::size_t end) {
  std::vector<std::span<std::byte>> parts;
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t bytes = source.stored(load.first + static_cast<NodeId>(i)).bytes;
    load.meshes[i] = std::make_unique_for_overwrite<std::byte[]>(bytes);
    parts.emplace_back(load.meshes[i].get(), bytes);
  }
  source.read(load.first + static_cast<NodeId>(begin), parts);
}

// Unpacks mesh i of the load. Throws Error.
void unpack(MeshSource& source, MeshLoad& load, std::size_t i) {
  load.meshes[i] = source.unpack(load.first + static_cast<NodeId>(i), std::move(load.meshes[i]));
}

}  // namespace

void read_or_throw(MeshSource& source, MeshLoad& load) {
  load.problems.resize(load.meshes.size());
  read_part(source, load, 0, load.meshes.size());
  for (std::size_t i = 0; i < load.meshes.size(); ++i) unpack(source, load, i);
}

void read_meshes(MeshSource& source, MeshLoad& load) {
  load.problems.resize(load.meshes.size());
  bool is_read = true;
  try {
    read_part(source, load, 0, load.meshes.size());
  } catch (const std::exception&) {
    is_read = false;  // they are read one by one, to find the damaged one
  }
  for (std::size_t i = 0; i < load.meshes.size(); ++i) try {
      if (!is_read) read_part(source, load, i, i + 1);
      unpack(source, load, i);
    } catch (const std::exception& error) {
      load.meshes[i].reset();
      load.problems[i] = error.what();
    }
}

std::unique_ptr<LoadQueue> MeshSource::make_queue() { return std::make_unique<MeshLoader>(*this); }

MeshLoader::MeshLoader(MeshSource& source) : source_(source), thread_([this] { run(); }) {}

MeshLoader::~MeshLoader() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void MeshLoader::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return stopped_ || !waiting_.empty(); });
    if (stopped_) return;
    MeshLoad load = std::move(waiting_.front());
    waiting_.pop_front();
    is_reading_ = true;
    lock.unlock();
    read_meshes(source_, load);
    lock.lock();
    is_reading_ = false;
    ended_.push_back(std::move(load));
    changed_.notify_all();
  }
}

void MeshLoader::require_thread() const {
  if (is_lost())
    throw Error({"HLOD", "", "was opened before this process was forked, and its thread is not here",
                 "open it again in this process"});
}

void MeshLoader::push(std::vector<MeshLoad> loads) {
  require_thread();
  {
    const std::lock_guard lock(mutex_);
    std::ranges::move(loads, std::back_inserter(waiting_));
  }
  changed_.notify_all();
}

std::vector<MeshLoad> MeshLoader::withdraw() {
  require_thread();
  const std::lock_guard lock(mutex_);
  std::vector<MeshLoad> loads;
  std::ranges::move(waiting_, std::back_inserter(loads));
  waiting_.clear();
  return loads;
}

void MeshLoader::collect(std::deque<MeshLoad>& out, std::size_t least) {
  require_thread();
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return out.size() + ended_.size() >= least || (waiting_.empty() && !is_reading_); });
  std::ranges::move(ended_, std::back_inserter(out));
  ended_.clear();
}

}  // namespace occlod::hlod
