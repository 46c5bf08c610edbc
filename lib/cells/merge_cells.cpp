#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <system_error>

#include "occlod/core/error.h"
#include "occlod/viewcells/build_cells.h"
#include "cells/cell_forest.h"
#include "cells/vlod_part.h"
#include "cells/write_vlod.h"

namespace occlod {
namespace {

using vlod::PartReader;

// The parts of one build, which are asked for root cells in ascending order.
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

  // Throws Error that says which of the first `count` root cells are in no part.
  void expect(std::size_t count, const std::filesystem::path& folder) const {
    std::uint64_t end = 0;
    const auto expect_at = [&](std::uint64_t next) {
      if (next > end)
        throw Error({folder.string(), "", fmt::format("lacks the root cells {} to {}", end, next - 1),
                     "build them with 'occlod cells build --work --resume', or the shard that has them"});
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
