#include "occlod/viewcells/build_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "base/option_checker.h"
#include "splits/parallel.h"
#include "occlod/core/error.h"
#include "cells/cell_divider.h"
#include "cells/cell_forest.h"
#include "cells/vlod_part.h"
#include "cells/write_vlod.h"

namespace occlod {
namespace {

// One for all threads.
class SharedProgress {
 public:
  SharedProgress(const CellBuildRun& run, std::size_t roots) : run_(run), roots_(static_cast<double>(roots)) {}

  // A share of a root cell is done. Throws Error when the build is cancelled.
  void advance(double share) {
    if (failure_set_) throw Error({"cells", "", "the build has ended", ""});
    const double done = done_.fetch_add(share / roots_) + share / roots_;
    if (!run_.progress || std::this_thread::get_id() != caller_) return;
    if (!run_.progress(std::min(done, 1.0))) throw Error({"cells", "", "the build was cancelled", ""});
  }
  // Ends the work of all threads; the first failure counts.
  void fail(std::exception_ptr failure) {
    const std::scoped_lock lock(mutex_);
    if (!failure_) failure_ = std::move(failure);
    failure_set_ = true;
  }
  [[nodiscard]] std::exception_ptr failure() const { return failure_; }

 private:
  const CellBuildRun& run_;
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
        scene_{options, vlod::describe(checked(objects, options))},
        ids_(scene_.objects, "cells"),
        key_(vlod::store(scene_).key),
        roots_(root_cells(options)) {}

  [[nodiscard]] std::vector<PackedTree> divide(const CellRange& range, const CellBuildRun& run);

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
  std::optional<CellOccluders> occluders_;  // once something is built
  std::atomic<std::size_t> cuts_ = 0;
};

std::vector<PackedTree> CellBuild::Impl::divide(const CellRange& range, const CellBuildRun& run) {
  OptionChecker("cell options").in_range("threads", run.threads, 0, 1024);
  if (run.progress && !run.progress(0.0)) throw Error({"cells", "", "the build was cancelled", ""});
  const CellTreeOptions& options = scene_.options;
  const bool hides = options.cell.occlusion == CellOcclusion::hull;
  if (hides && !occluders_) occluders_.emplace(objects_, options.occluder_motion.value_or(options.smallest_cell / 4.0));
  std::vector<PackedTree> trees(range.count);
  SharedProgress progress(run, range.count);
  const auto divide = [&](CellDivider& divider, std::size_t i) {
    const std::size_t before = divider.cuts();
    CellSubtree tree = divider.divide(roots_[range.first + i].box, [&](double share) { progress.advance(share); });
    set_levels(tree);
    trees[i] = pack(std::move(tree));
    cuts_ += divider.cuts() - before;
  };
  const auto divide_or_fail = [&](CellDivider& divider, std::size_t i) {
    try {
      divide(divider, i);
    } catch (...) {
      progress.fail(std::current_exception());
      throw;
    }
  };
  try {
    for_each_task(
        range.count, thread_count(run.threads),
        [&] { return CellDivider(objects_, hides ? &*occluders_ : nullptr, options, ids_); }, divide_or_fail, [] {});
  } catch (...) {
    if (const std::exception_ptr first = progress.failure()) std::rethrow_exception(first);
    throw;
  }
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
  return false;  // missing or damaged: it will be written again
}

void CellBuild::write_part(const std::filesystem::path& part, const CellRange& range, const CellBuildRun& run) {
  if (range.count == 0 || range.count > root_cell_count() || range.first > root_cell_count() - range.count)
    throw Error({"cells", "",
                 fmt::format("there are {} root cells, not {} from {} on", root_cell_count(), range.count, range.first),
                 "ask for a range of them"});
  vlod::write_part(part, impl_->scene(), range, impl_->divide(range, run));
}

void CellBuild::write(const std::filesystem::path& path, const CellBuildRun& run) {
  std::vector<PackedTree> trees = impl_->divide({0, root_cell_count()}, run);
  CellSubtree tree =
      join_roots(impl_->roots(), [&](std::size_t i) { return unpack(std::exchange(trees[i], {}), impl_->ids()); });
  finish(tree);
  write_vlod(path, impl_->scene(), tree);
}

}  // namespace occlod
