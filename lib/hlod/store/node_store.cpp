#include "occlod/node_store.h"

#include <algorithm>
#include <cassert>
#include <deque>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

#include "hlod/store/mesh_loader.h"
#include "occlod/base.h"

namespace occlod::hlod {
namespace {

using State = NodeCache::State;
using Urgency = NodeCache::Urgency;

// Adjacent meshes are read together up to this many bytes: larger reads are hardly faster, and arrive late.
constexpr std::size_t max_read_bytes = std::size_t{1} << 20U;

struct DeleteUnlessLost {
  void operator()(LoadQueue* loader) const {
    if (!loader->is_lost()) delete loader;
  }
};

}  // namespace

class NodeStore::Impl {
 public:
  Impl(const HlodView& view, std::shared_ptr<const void> owner, std::unique_ptr<MeshSource> source,
       const CacheOptions& options)
      : view_(view), owner_(std::move(owner)), source_(std::move(source)), options_(options), cache_(view_, *source_) {
    check_budget(options.budget_bytes);
    cache_.set_budget(options.budget_bytes);
    read_roots();
    if (options.load != LoadMode::blocking) loader_.reset(source_->make_queue().release());
  }

  [[nodiscard]] const HlodView& view() const noexcept { return view_; }
  [[nodiscard]] const MeshBytes* meshes() const noexcept { return cache_.meshes(); }

  void set_budget(std::size_t bytes) {
    check_budget(bytes);
    if (link_) release(link_->clear());
    if (loader_) {
      release(loader_->withdraw());
      loader_->collect(ended_, static_cast<std::size_t>(-1));  // waits for what is being read
    }
    release(ended_);
    ended_.clear();
    first_lasting_ = 0;
    for (const Arrival& arrival : arrivals_) cache_.release(arrival.node);
    arrivals_.clear();
    cache_.set_budget(bytes);
  }

  void set_link(std::unique_ptr<MeshLink> link) {
    assert(loader_);
    link_ = std::move(link);
    frame_bytes_ = link_->frame_bytes();
  }

  [[nodiscard]] StoreStats stats() const {
    StoreStats stats = stats_;
    stats.budget_bytes = cache_.budget();
    stats.resident_nodes = cache_.resident_nodes();
    stats.resident_bytes = cache_.resident_bytes();
    stats.loading_bytes = cache_.coming_bytes();
    stats.evictions = cache_.evictions();
    return stats;
  }

  [[nodiscard]] std::vector<NodeId> missing() const {
    std::vector<NodeId> nodes;
    std::ranges::transform(priorities_, std::back_inserter(nodes), &Priority::node);
    return nodes;
  }

  [[nodiscard]] std::vector<std::string> take_failures() { return std::exchange(failures_, {}); }

  void begin_frame() {
    cache_.begin_frame();
    is_full_ = false;
    wanted_.clear();
    groups_.clear();
    priorities_.clear();
    soon_.clear();
    if (loader_) collect();
    admit();
  }

  [[nodiscard]] bool may_have(NodeId n) const noexcept {
    const State state = cache_.state(n);
    return state == State::resident || (options_.load == LoadMode::blocking && state == State::absent && !is_full_);
  }

  [[nodiscard]] bool fetch(std::span<const NodeId> nodes) {
    const auto is_resident = [&](NodeId n) { return cache_.state(n) == State::resident; };
    if (std::ranges::all_of(nodes, is_resident)) return true;
    if (options_.load != LoadMode::blocking) return false;
    missing_.clear();
    if (!cache_.find_missing(nodes, missing_)) return false;
    for (const NodeId n : nodes)
      if (is_resident(n)) cache_.need(n);
    if (!cache_.reserve(missing_, Urgency::now)) {
      is_full_ = true;
      return false;
    }
    read_now(read_meshes);
    return std::ranges::all_of(nodes, is_resident);
  }

  void need(NodeId n) noexcept { cache_.need(n); }

  void want(std::span<const NodeId> nodes, double priority) {
    missing_.clear();
    if (!cache_.find_missing(nodes, missing_)) return;  // some are never loaded
    groups_.push_back({wanted_.size(), nodes.size(), 0.0});
    wanted_.insert(wanted_.end(), nodes.begin(), nodes.end());
    for (const NodeId n : nodes) {
      const State state = cache_.state(n);
      if (state != State::absent) cache_.need(n);
      if (state != State::resident) priorities_.push_back({n, priority});
    }
  }

  void prefetch(NodeId n) {
    soon_.push_back(n);
    const State state = cache_.state(n);
    if (state == State::resident || state == State::coming) cache_.keep(n);
  }

  void end_frame() {
    add_up_priorities();
    stats_.missing = priorities_.size();
    if (!loader_) return;
    withdraw();
    plan();
    hand_over();
  }

 private:
  // Names nodes that are wanted together: a part of wanted_.
  struct Group {
    std::size_t first = 0, count = 0;
    double priority = 0.0;
  };
  struct Priority {
    NodeId node = 0;
    double sum = 0.0;
  };
  // Holds what has been read of a node.
  struct Arrival {
    NodeId node = 0;
    MeshBytes mesh;  // null where it failed
    std::string problem;
  };

  void check_budget(std::size_t bytes) const {
    const std::size_t least = cache_.min_budget();
    if (bytes < least)
      throw Error({"cache", "budget_bytes", "is " + std::to_string(bytes) + ", too little for the coarsest picture",
                   "allow at least " + std::to_string(least) + " bytes"});
  }

  void read_roots() {
    missing_.assign(view_.roots.begin(), view_.roots.end());
    const bool has_room = cache_.reserve(missing_, Urgency::now);
    assert(has_room);  // the budget has been checked
    static_cast<void>(has_room);
    read_now(read_or_throw);
  }

  // Reads the missing_ nodes, for which memory is reserved.
  void read_now(void (*read)(MeshSource&, MeshLoad&)) {
    order_ = missing_;
    for (MeshLoad& load : make_loads()) {
      read(*source_, load);
      arrive(load);
    }
    // Parents come before children. None is left waiting, since all ancestors of these nodes come with them or are
    // resident.
    std::sort(arrivals_.begin(), arrivals_.end(), [](const Arrival& a, const Arrival& b) { return a.node < b.node; });
    for (Arrival& arrival : arrivals_) admit(arrival);
    arrivals_.clear();
  }

  void arrive(MeshLoad& load) {
    ++stats_.reads;
    for (std::size_t i = 0; i < load.meshes.size(); ++i)
      arrivals_.push_back(
          {load.first + static_cast<NodeId>(i), std::move(load.meshes[i]), std::move(load.problems[i])});
  }

  void collect() {
    std::size_t count = 0;
    if (link_) {
      loader_->push(link_->pass_frame());
      count = link_->take_due();
      loader_->collect(ended_, count);
    } else {
      loader_->collect(ended_);
      count = ended_.size();
    }
    for (; count > 0; --count) {
      arrive(ended_.front());
      ended_.pop_front();
    }
  }

  // Admits as many arrivals as a frame may, parents first; the others keep waiting.
  void admit() {
    std::size_t bytes = 0;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < arrivals_.size(); ++i) {
      Arrival& arrival = arrivals_[i];
      const std::size_t added = source_->bytes_of(arrival.node);
      const bool has_turn = bytes == 0 || bytes + added <= frame_bytes_;
      if (has_turn && !waits_for_parents(arrival.node)) {
        bytes += admit(arrival) ? added : 0;
      } else {
        if (kept != i) arrivals_[kept] = std::move(arrival);
        ++kept;
      }
    }
    arrivals_.resize(kept);
  }

  [[nodiscard]] bool waits_for_parents(NodeId n) const {
    const Node& node = view_.nodes[n];
    bool waits = false;
    for (const Patch& patch : view_.patches.subspan(node.first_patch, node.patches)) {
      if (patch.parent == no_id) continue;
      const State state = cache_.state(patch.parent);
      if (state == State::absent || state == State::failed) return false;  // it can never be admitted
      waits = waits || state == State::coming;
    }
    return waits;
  }

  // Returns whether the mesh becomes resident.
  bool admit(Arrival& arrival) {
    if (arrival.mesh == nullptr) {
      cache_.fail(arrival.node);
      ++stats_.failed;
      failures_.push_back(std::move(arrival.problem));
      return false;
    }
    if (!cache_.are_parents_resident(arrival.node)) {
      cache_.release(arrival.node);
      return false;
    }
    cache_.put(arrival.node, std::move(arrival.mesh));
    ++stats_.loads;
    stats_.bytes_loaded += source_->stored(arrival.node).bytes;
    return true;
  }

  // Adds up the priorities of each node, and gives each group the largest of its nodes.
  void add_up_priorities() {
    std::sort(priorities_.begin(), priorities_.end(),
              [](const Priority& a, const Priority& b) { return a.node < b.node; });
    std::size_t count = 0;
    for (const Priority& p : priorities_) {
      if (count > 0 && priorities_[count - 1].node == p.node)
        priorities_[count - 1].sum += p.sum;
      else
        priorities_[count++] = p;
    }
    priorities_.resize(count);
    for (Group& group : groups_)
      for (const NodeId n : nodes_of(group)) {
        const auto found = std::lower_bound(priorities_.begin(), priorities_.end(), n,
                                            [](const Priority& p, NodeId id) { return p.node < id; });
        if (found != priorities_.end() && found->node == n) group.priority = std::max(group.priority, found->sum);
      }
    std::stable_sort(groups_.begin(), groups_.end(),
                     [](const Group& a, const Group& b) { return a.priority > b.priority; });
  }

  [[nodiscard]] std::span<const NodeId> nodes_of(const Group& group) const {
    return std::span(wanted_).subspan(group.first, group.count);
  }

  template <typename Loads>
  void release(const Loads& loads) {
    for (const MeshLoad& load : loads)
      for (std::size_t i = 0; i < load.meshes.size(); ++i) cache_.release(load.first + static_cast<NodeId>(i));
  }

  // Takes back the loads that can be, to plan them anew.
  void withdraw() { release(link_ ? link_->withdraw() : loader_->withdraw()); }

  // Plans what to read, in order_: no more than arrives in a few frames, so that more urgent nodes can come first then.
  void plan() {
    order_.clear();
    const std::size_t most = 2 * frame_bytes_;
    bool has_room = plan_lasting();
    for (const Group& group : groups_) {
      if (cache_.coming_bytes() >= most) return;
      has_room = plan(nodes_of(group), Urgency::now) && has_room;
    }
    if (!has_room) return;  // the memory that is left is for wanted nodes
    for (const NodeId n : soon_) {
      if (cache_.coming_bytes() >= frame_bytes_ || !plan({&n, 1}, Urgency::soon)) return;
    }
  }

  bool plan_lasting() {
    for (; first_lasting_ < cache_.lasting_nodes(); ++first_lasting_) {
      const State state = cache_.state(first_lasting_);
      if (state == State::absent || state == State::coming) break;
    }
    for (NodeId n = first_lasting_; n < cache_.lasting_nodes(); ++n)
      if (cache_.coming_bytes() >= frame_bytes_ || !plan({&n, 1}, Urgency::now)) return false;
    return true;
  }

  // Returns false when there is not enough memory; failed nodes need none.
  bool plan(std::span<const NodeId> nodes, Urgency urgency) {
    missing_.clear();
    if (!cache_.find_missing(nodes, missing_) || missing_.empty()) return true;
    if (!cache_.reserve(missing_, urgency)) return false;
    order_.insert(order_.end(), missing_.begin(), missing_.end());
    return true;
  }

  [[nodiscard]] bool are_side_by_side(NodeId a) const {
    const StoredMesh mesh = source_->stored(a);
    return mesh.place + mesh.bytes == source_->stored(a + 1).place;
  }

  // Makes loads of the nodes in order_. Each node is in the load of the first node that it can be read with.
  [[nodiscard]] std::vector<MeshLoad> make_loads() {
    std::vector<NodeId> left = order_;
    std::sort(left.begin(), left.end());
    std::vector<bool> taken(left.size(), false);
    std::vector<MeshLoad> loads;
    for (const NodeId n : order_) {
      const auto place = static_cast<std::size_t>(std::lower_bound(left.begin(), left.end(), n) - left.begin());
      if (taken[place]) continue;
      std::size_t begin = place, end = place + 1, bytes = source_->stored(n).bytes;
      const auto may_join = [&](std::size_t a, std::size_t joined) {  // left[a] and the one after it
        return !taken[joined] && left[a] + 1 == left[a + 1] && are_side_by_side(left[a]) &&
               bytes + source_->stored(left[joined]).bytes <= max_read_bytes;
      };
      while (end < left.size() && may_join(end - 1, end)) bytes += source_->stored(left[end++]).bytes;
      while (begin > 0 && may_join(begin - 1, begin - 1)) bytes += source_->stored(left[--begin]).bytes;
      std::fill(taken.begin() + static_cast<std::ptrdiff_t>(begin), taken.begin() + static_cast<std::ptrdiff_t>(end),
                true);
      loads.push_back({left[begin], bytes, std::vector<MeshBytes>(end - begin), {}});
    }
    return loads;
  }

  void hand_over() {
    std::vector<MeshLoad> loads = make_loads();
    link_ ? link_->push(std::move(loads)) : loader_->push(std::move(loads));
  }

  const HlodView view_;
  std::shared_ptr<const void> owner_;
  std::unique_ptr<MeshSource> source_;
  CacheOptions options_;
  NodeCache cache_;
  std::unique_ptr<MeshLink> link_;  // null: none
  std::size_t frame_bytes_ = max_bytes_in_frame;
  std::vector<NodeId> wanted_;        // in this frame, group by group
  std::vector<Group> groups_;         // in this frame
  std::vector<Priority> priorities_;  // of missing nodes
  std::vector<NodeId> soon_;          // in this frame
  bool is_full_ = false;              // blocking: a fetch found too little memory in this frame
  NodeId first_lasting_ = 0;          // nodes before it are resident or have failed
  std::deque<MeshLoad> ended_;        // read
  std::vector<Arrival> arrivals_;     // still to be admitted
  std::vector<std::string> failures_;
  std::vector<NodeId> missing_, order_;  // scratch memory
  StoreStats stats_;
  std::unique_ptr<LoadQueue, DeleteUnlessLost> loader_;  // destroyed first
};

NodeStore::NodeStore(const HlodView& view, std::shared_ptr<const void> owner, std::unique_ptr<MeshSource> source,
                     const CacheOptions& options)
    : impl_(std::make_unique<Impl>(view, std::move(owner), std::move(source), options)) {}
NodeStore::~NodeStore() = default;

void NodeStore::set_budget(std::size_t bytes) { impl_->set_budget(bytes); }
void NodeStore::set_link(std::unique_ptr<MeshLink> link) { impl_->set_link(std::move(link)); }
StoreStats NodeStore::stats() const { return impl_->stats(); }
std::vector<NodeId> NodeStore::missing() const { return impl_->missing(); }
std::vector<std::string> NodeStore::take_failures() { return impl_->take_failures(); }
void NodeStore::begin_frame() { impl_->begin_frame(); }
bool NodeStore::may_have(NodeId n) const noexcept { return impl_->may_have(n); }
bool NodeStore::fetch(std::span<const NodeId> nodes) { return impl_->fetch(nodes); }
void NodeStore::need(NodeId n) noexcept { impl_->need(n); }
void NodeStore::want(std::span<const NodeId> nodes, double priority) { impl_->want(nodes, priority); }
void NodeStore::prefetch(NodeId n) { impl_->prefetch(n); }
void NodeStore::end_frame() { impl_->end_frame(); }

Hlod paged_hlod(const std::shared_ptr<NodeStore>& store) {
  Hlod hlod(store->impl_->view(), store);
  hlod.store_ = store.get();
  hlod.resident_ = store->impl_->meshes();
  return hlod;
}

}  // namespace occlod::hlod
