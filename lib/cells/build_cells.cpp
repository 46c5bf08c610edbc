#include "occlod/build_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "base/option_checker.h"
#include "base/threads.h"
#include "cells/cell_divider.h"
#include "cells/vlod_format.h"
#include "cells/vlod_payload.h"
#include "occlod/base.h"

namespace occlod {
namespace {

// Writes .vlod files.

using namespace vlod;
using namespace sections;

// Writes a finished tree. Throws Error that names the file.
void write_vlod(const std::filesystem::path& path, const Scene& scene, const CellSubtree& tree) {
  const StoredOptions options = store(scene);
  SectionWriter writer;
  writer.add(options_name, std::span<const StoredOptions>(&options, 1));
  writer.add(regions_name, std::span<const CellBox>(scene.options.regions));
  writer.add(objects_name, std::span<const StoredObject>(scene.objects));
  writer.add(nodes_name, std::span<const CellNode>(tree.nodes));
  writer.add(data_name, std::span<const std::byte>(tree.payloads), Check::parts);
  writer.write(path, file_kind);
}

// Stores finished trees of root cells in a tenth of the memory until they are joined.

// Numbers of elements of the sets of a tree.
struct SetCounts {
  std::uint64_t splits = 0, candidates = 0, hidden = 0, used = 0, drawn = 0;
};

// Holds the encoded sets of a tree: what all leaves share, and what some have.
struct PackedSets {
  std::vector<std::byte> shared, used;
  SetCounts counts;
};

struct PackedTree {
  CellSubtree tree;  // without its sets
  PackedSets sets;
};

using vlod::Additions;
using vlod::Expected;
using vlod::max_ids_per_byte;

[[nodiscard]] PackedTree pack(CellSubtree tree) {
  CellSets sets = std::exchange(tree.sets, {});
  const SetCounts counts{sets.splits.size(), sets.candidates.size(), sets.hidden.size(), sets.used.size(),
                         sets.drawn.size()};
  const Additions shared{std::move(sets.splits), std::move(sets.candidates), std::move(sets.hidden)};
  const Additions used{std::move(sets.used), {}, std::move(sets.drawn)};
  return {std::move(tree), {encode(shared, {}, max_ids_per_byte), encode(used, {}, max_ids_per_byte), counts}};
}

// Decodes the same bytes from a file. Returns nothing, and describes the problem in `problem`, when they do not contain
// exactly this many elements.
[[nodiscard]] std::optional<CellSets> unpack(std::span<const std::byte> shared, std::span<const std::byte> used,
                                             const SetCounts& counts, const vlod::GlobalIds& ids,
                                             std::string& problem) {
  const auto decoded = [&](std::span<const std::byte> bytes, std::uint64_t splits, std::uint64_t candidates,
                           std::uint64_t faces) -> std::optional<Additions> {
    problem = "claims more than it can hold";
    if (std::max({splits, candidates, faces}) > bytes.size() * max_ids_per_byte) return {};
    Expected expected{.split_count = ids.split_count(), .owner_count = ids.owner_count()};
    expected.splits = static_cast<std::size_t>(splits);
    expected.candidates = static_cast<std::size_t>(candidates);
    expected.hidden = static_cast<std::size_t>(faces);
    return decode(bytes, expected, {}, problem);
  };
  auto first = decoded(shared, counts.splits, counts.candidates, counts.hidden);
  if (!first) return {};
  auto second = decoded(used, counts.used, 0, counts.drawn);
  if (!second) return {};
  return CellSets{std::move(first->splits), std::move(second->splits), std::move(first->candidates),
                  std::move(first->hidden), std::move(second->hidden)};
}

[[nodiscard]] CellSubtree unpack(PackedTree packed, const vlod::GlobalIds& ids) {
  std::string problem;
  auto sets = unpack(packed.sets.shared, packed.sets.used, packed.sets.counts, ids, problem);
  assert(sets.has_value());  // pack() has made these bytes
  packed.tree.sets = std::move(*sets);
  return std::move(packed.tree);
}

}  // namespace

}  // namespace occlod

namespace occlod::vlod {
namespace {

// Reads and writes .vpart files: the trees of a run of root cells, to be merged into a .vlod file.

inline constexpr sections::FileKind part_kind{{'V', 'P', 'R', 'T', '\r', '\n', '\x1a', '\n'},
                                              vlod_version,
                                              ".vpart",
                                              "make one with 'occlod cells build --work'",
                                              "remove it, and build again"};

// Locates the tree of a root cell in the file.
struct PartTree {
  std::uint64_t first_node = 0, nodes = 0;        // in section CELL
  std::uint64_t payloads = 0, payload_bytes = 0;  // in section DATA
  std::uint64_t sets = 0;                         // in section DATA: what all leaves share, then what some have
  std::uint64_t shared_bytes = 0, used_bytes = 0;
  SetCounts counts;
};
static_assert(sizeof(PartTree) == 96);

class PartReader {
 public:
  // Opens the file and checks everything except the contents of sets. Throws Error.
  explicit PartReader(const std::filesystem::path& path);

  [[nodiscard]] const Scene& scene() const noexcept { return scene_; }
  [[nodiscard]] const Key& key() const noexcept { return key_; }
  [[nodiscard]] const CellRange& range() const noexcept { return range_; }
  // Returns the tree of a root cell of the range. Throws Error.
  [[nodiscard]] CellSubtree tree(std::uint32_t root) const;

 private:
  sections::SectionReader reader_;
  Scene scene_;
  Key key_{};
  CellRange range_;
  std::span<const PartTree> trees_;
  std::span<const CellNode> nodes_;
  std::span<const std::byte> data_;
};

using namespace sections;

constexpr std::string_view range_name = "RANG", trees_name = "TREE";

// Writes the trees of the root cells of the range. Throws Error that names the file.
void write_part(const std::filesystem::path& path, const Scene& scene, const CellRange& range,
                std::span<const PackedTree> trees) {
  std::vector<PartTree> table;
  std::vector<CellNode> nodes;
  std::vector<std::byte> data;
  const auto append = [&](std::span<const std::byte> bytes) { data.insert(data.end(), bytes.begin(), bytes.end()); };
  for (const PackedTree& packed : trees) {
    const auto& [tree, sets] = packed;
    table.push_back({nodes.size(), tree.nodes.size(), data.size(), tree.payloads.size(),
                     data.size() + tree.payloads.size(), sets.shared.size(), sets.used.size(), sets.counts});
    nodes.insert(nodes.end(), tree.nodes.begin(), tree.nodes.end());
    append(tree.payloads);
    append(sets.shared);
    append(sets.used);
  }
  const StoredOptions options = store(scene);
  SectionWriter writer;
  writer.add(options_name, std::span<const StoredOptions>(&options, 1));
  writer.add(regions_name, std::span<const CellBox>(scene.options.regions));
  writer.add(objects_name, std::span<const StoredObject>(scene.objects));
  writer.add(range_name, std::span<const CellRange>(&range, 1));
  writer.add(trees_name, std::span<const PartTree>(table));
  writer.add(nodes_name, std::span<const CellNode>(nodes));
  writer.add(data_name, std::span<const std::byte>(data));
  writer.write(path, part_kind);
}

PartReader::PartReader(const std::filesystem::path& path) : reader_(path, part_kind, true) {
  scene_ = read_options(reader_, path.string(), key_);
  range_ = reader_.read_one<CellRange>(range_name, "range");
  trees_ = reader_.read<PartTree>(trees_name);
  nodes_ = reader_.read<CellNode>(nodes_name);
  data_ = reader_.read<std::byte>(data_name);
  if (trees_.empty() || trees_.size() != range_.count ||
      range_.count > std::numeric_limits<std::uint32_t>::max() - range_.first)
    reader_.refuse("section TREE", "does not have a tree for every root cell");
}

CellSubtree PartReader::tree(std::uint32_t root) const {
  const PartTree& it = trees_[root - range_.first];
  const std::string place = fmt::format("root cell {}", root);
  const auto within = [](std::uint64_t first, std::uint64_t count, std::size_t size) {
    return first <= size && count <= size - first;
  };
  if (!within(it.first_node, it.nodes, nodes_.size()) || !within(it.payloads, it.payload_bytes, data_.size()) ||
      !within(it.sets, it.shared_bytes, data_.size()) ||
      !within(it.sets + it.shared_bytes, it.used_bytes, data_.size()))
    reader_.refuse(place, "lies outside the file");
  CellSubtree tree;
  tree.nodes.assign(nodes_.begin() + static_cast<std::ptrdiff_t>(it.first_node),
                    nodes_.begin() + static_cast<std::ptrdiff_t>(it.first_node + it.nodes));
  const CellTree checked(tree.nodes, place);
  for (const CellNode& node : tree.nodes)
    if (!within(node.payload, node.payload_bytes, it.payload_bytes)) reader_.refuse(place, "adds what is not there");
  const auto payloads = data_.subspan(it.payloads, it.payload_bytes);
  tree.payloads.assign(payloads.begin(), payloads.end());

  std::string problem;
  auto sets = unpack(data_.subspan(it.sets, it.shared_bytes), data_.subspan(it.sets + it.shared_bytes, it.used_bytes),
                     it.counts, GlobalIds(scene_.objects, place), problem);
  if (!sets) reader_.refuse(place, problem);
  tree.sets = std::move(*sets);
  return tree;
}

}  // namespace

}  // namespace occlod::vlod

namespace occlod {
namespace {

// Reports the progress of all threads together.
class SharedProgress {
 public:
  SharedProgress(const std::function<bool(double)>& progress, std::size_t roots)
      : progress_(progress), roots_(static_cast<double>(roots)) {}

  // Reports that this share of a root cell is done. Throws Error when the build is cancelled.
  void advance(double share) {
    if (failure_set_) throw Error({"cells", "", "the build has ended", ""});
    const double done = done_.fetch_add(share / roots_) + share / roots_;
    if (!progress_ || std::this_thread::get_id() != caller_) return;
    if (!progress_(std::min(done, 1.0))) throw Error({"cells", "", "the build was cancelled", ""});
  }
  // Stops the work of all threads; the first failure is kept.
  void fail(std::exception_ptr failure) {
    const std::scoped_lock lock(mutex_);
    if (!failure_) failure_ = std::move(failure);
    failure_set_ = true;
  }
  [[nodiscard]] std::exception_ptr failure() const { return failure_; }

 private:
  const std::function<bool(double)>& progress_;
  double roots_;
  std::thread::id caller_ = std::this_thread::get_id();
  std::atomic<double> done_ = 0.0;
  std::atomic<bool> failure_set_ = false;
  std::mutex mutex_;
  std::exception_ptr failure_;
};

std::span<const RefineObject> checked(std::span<const RefineObject> objects, const CellTreeOptions& options) {
  vlod::check(options, "cell options");
  for (const RefineObject& object : objects)
    if (object.hierarchy == nullptr)
      throw Error({"cells", "", "an object has no hierarchy", "build one with build_hierarchy()"});
  return objects;
}

}  // namespace

class CellBuild::Impl {
 public:
  Impl(std::span<const RefineObject> objects, const CellTreeOptions& options)
      : objects_(objects.begin(), objects.end()),
        scene_{.options = options, .objects = vlod::describe(checked(objects, options))},
        ids_(scene_.objects, "cells"),
        key_(vlod::store(scene_).key),
        roots_(root_cells(options)) {}

  [[nodiscard]] std::vector<PackedTree> divide(const CellRange& range, int threads,
                                               const std::function<bool(double)>& progress);

  [[nodiscard]] const vlod::Scene& scene() const noexcept { return scene_; }
  [[nodiscard]] const vlod::GlobalIds& ids() const noexcept { return ids_; }
  [[nodiscard]] const vlod::Key& key() const noexcept { return key_; }
  [[nodiscard]] std::span<const RootCell> roots() const noexcept { return roots_; }
  [[nodiscard]] std::size_t cuts() const noexcept { return cuts_; }

 private:
  std::vector<RefineObject> objects_;
  vlod::Scene scene_;
  vlod::GlobalIds ids_;
  vlod::Key key_;
  std::vector<RootCell> roots_;
  std::optional<CellOccluders> occluders_;  // set once something is built
  std::atomic<std::size_t> cuts_ = 0;
};

std::vector<PackedTree> CellBuild::Impl::divide(const CellRange& range, int threads,
                                                const std::function<bool(double)>& progress) {
  OptionChecker("cell options").in_range("threads", threads, 0, 1024);
  if (progress && !progress(0.0)) throw Error({"cells", "", "the build was cancelled", ""});
  const CellTreeOptions& options = scene_.options;
  const bool hides = options.cell.occlusion == CellOcclusion::hull;
  if (hides && !occluders_) occluders_.emplace(objects_, options.occluder_motion.value_or(options.smallest_cell / 4.0));
  std::vector<PackedTree> trees(range.count);
  SharedProgress shared(progress, range.count);
  const auto divide = [&](CellDivider& divider, std::size_t i) {
    const std::size_t before = divider.cuts();
    CellSubtree tree = divider.divide(roots_[range.first + i].box, [&](double share) { shared.advance(share); });
    set_levels(tree);
    trees[i] = pack(std::move(tree));
    cuts_ += divider.cuts() - before;
  };
  const auto divide_or_fail = [&](CellDivider& divider, std::size_t i) {
    try {
      divide(divider, i);
    } catch (...) {
      shared.fail(std::current_exception());
      throw;
    }
  };
  try {
    for_each_task(
        range.count, thread_count(threads),
        [&] { return CellDivider(objects_, hides ? &*occluders_ : nullptr, options, ids_); }, divide_or_fail, [] {});
  } catch (...) {
    if (const std::exception_ptr first = shared.failure()) std::rethrow_exception(first);
    throw;
  }
  if (progress && !progress(1.0)) throw Error({"cells", "", "the build was cancelled", ""});
  return trees;
}

CellBuild::CellBuild(std::span<const RefineObject> objects, const CellTreeOptions& options)
    : impl_(std::make_unique<Impl>(objects, options)) {}
CellBuild::~CellBuild() = default;

std::uint32_t CellBuild::root_cell_count() const noexcept { return static_cast<std::uint32_t>(impl_->roots().size()); }
std::size_t CellBuild::cuts() const noexcept { return impl_->cuts(); }

CellRange CellBuild::shard(std::uint32_t i, std::uint32_t n) const {
  const std::uint64_t count = root_cell_count(), first = count * i / n, end = count * (i + 1) / n;
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end - first)};
}

std::string CellBuild::part_name(const CellRange& range) const {
  return fmt::format("{:016x}-{:08}-{:08}.vpart", impl_->key()[0], range.first, range.count);
}

bool CellBuild::has_part(const std::filesystem::path& part, const CellRange& range) const try {
  const vlod::PartReader reader(part);
  return reader.key() == impl_->key() && reader.range() == range;
} catch (const Error&) {
  return false;  // missing or damaged: it will be rebuilt
}

void CellBuild::write_part(const std::filesystem::path& part, const CellRange& range, int threads,
                           const std::function<bool(double)>& progress) {
  if (range.count == 0 || range.count > root_cell_count() || range.first > root_cell_count() - range.count)
    throw Error({"cells", "",
                 fmt::format("there are {} root cells, not {} from {} on", root_cell_count(), range.count, range.first),
                 "ask for a range of them"});
  vlod::write_part(part, impl_->scene(), range, impl_->divide(range, threads, progress));
}

void CellBuild::write(const std::filesystem::path& path, int threads, const std::function<bool(double)>& progress) {
  std::vector<PackedTree> trees = impl_->divide({0, root_cell_count()}, threads, progress);
  CellSubtree tree =
      join_roots(impl_->roots(), [&](std::size_t i) { return unpack(std::exchange(trees[i], {}), impl_->ids()); });
  finish(tree);
  write_vlod(path, impl_->scene(), tree);
}

namespace {

using vlod::PartReader;

// Holds the parts of one build; root cells must be requested in ascending order.
class Parts {
 public:
  explicit Parts(std::span<const std::filesystem::path> paths) {
    for (const std::filesystem::path& path : paths) {
      readers_.push_back(std::make_unique<PartReader>(path));
      if (readers_.back()->key() != readers_.front()->key())
        throw Error({path.string(), "",
                     fmt::format("is of another scene or of other options than {}", paths.front().string()),
                     "merge the parts of one build"});
    }
    std::ranges::sort(readers_, {}, [](const auto& reader) { return reader->range().first; });
  }

  [[nodiscard]] const vlod::Scene& scene() const { return readers_.front()->scene(); }

  // Throws Error that lists which of the first `count` root cells are in no part.
  void expect(std::size_t count, const std::filesystem::path& folder) const {
    std::uint64_t end = 0;
    const auto expect_at = [&](std::uint64_t next) {
      if (next > end)
        throw Error({folder.string(), "", fmt::format("lacks the root cells {} to {}", end, next - 1),
                     "build them with 'occlod cells build --work', or the shard that has them"});
    };
    for (const auto& reader : readers_) {
      expect_at(reader->range().first);
      end = std::max<std::uint64_t>(end, std::uint64_t{reader->range().first} + reader->range().count);
    }
    expect_at(count);
    if (end > count)
      throw Error({folder.string(), "", "has more root cells than its regions", "remove it and build again"});
  }

  [[nodiscard]] CellSubtree take(std::uint32_t root) {
    const auto has_it = [root](const auto& reader) {
      return root >= reader->range().first && root - reader->range().first < reader->range().count;
    };
    return (*std::ranges::find_if(readers_, has_it))->tree(root);
  }

 private:
  std::vector<std::unique_ptr<PartReader>> readers_;
};

}  // namespace

std::vector<std::filesystem::path> cell_parts_in(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> parts;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".vpart") parts.push_back(it->path());
  if (error)
    throw Error(
        {folder.string(), "", fmt::format("cannot be read: {}", error.message()), "name the folder of the parts"});
  std::ranges::sort(parts);
  return parts;
}

void merge_cells(std::span<const std::filesystem::path> parts, const std::filesystem::path& path) {
  if (parts.empty()) throw Error({path.string(), "", "there are no parts to merge", "name some"});
  Parts all(parts);
  const std::vector<RootCell> roots = root_cells(all.scene().options);
  all.expect(roots.size(), parts.front().parent_path());
  CellSubtree tree = join_roots(roots, [&](std::size_t i) { return all.take(static_cast<std::uint32_t>(i)); });
  finish(tree);
  write_vlod(path, all.scene(), tree);
}

}  // namespace occlod
