#include "cells/vlod_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

namespace occlod::vlod {

using namespace sections;

namespace {

constexpr std::string_view range_name = "RANG", trees_name = "TREE";

}  // namespace

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
  writer.add(objects_name, std::span<const VlodObject>(scene.objects));
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

}  // namespace occlod::vlod
