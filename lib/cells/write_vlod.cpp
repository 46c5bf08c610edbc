#include "cells/write_vlod.h"

namespace occlod {

using namespace vlod;
using namespace sections;

void write_vlod(const std::filesystem::path& path, const Scene& scene, const CellSubtree& tree) {
  const StoredOptions options = store(scene);
  SectionWriter writer;
  writer.add(options_name, std::span<const StoredOptions>(&options, 1));
  writer.add(regions_name, std::span<const CellBox>(scene.options.regions));
  writer.add(objects_name, std::span<const VlodObject>(scene.objects));
  writer.add(nodes_name, std::span<const CellNode>(tree.nodes));
  writer.add(data_name, std::span<const std::byte>(tree.payloads), Check::parts);
  writer.write(path, file_kind);
}

}  // namespace occlod
