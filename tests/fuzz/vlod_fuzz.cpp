// View cells in files. Checksums, the key and the scene are put right first: what is to be found here is what a hostile
// file can do. Whatever the bytes, opening the file, finding cells and reading all of them ends with cuts that can be
// drawn, or with an Error.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "cells/packed_geometry.h"
#include "cells/vlod_format.h"
#include "fuzz/memory_file.h"
#include "fuzz/section_signer.h"
#include "fuzz/vlod_scene.h"
#include "occlod/base.h"
#include "occlod/vlod_file.h"

namespace occlod::vlod {
namespace {

const fuzz::VlodScene& scene() {
  static const fuzz::VlodScene it;
  return it;
}

void sign_payloads(const fuzz::SectionSigner& file) {
  const std::span<std::byte> data = file.find<std::byte>(data_name);
  for (CellNode& node : file.find<CellNode>(nodes_name))
    if (node.payload <= data.size() && node.payload_bytes <= data.size() - node.payload)
      node.checksum = sections::checksum_of(data.subspan(node.payload, node.payload_bytes));
}

void sign_frames(const fuzz::SectionSigner& file) {
  const std::span<std::byte> data = file.find<std::byte>(geometry_name);
  for (FrameRow& frame : file.find<FrameRow>(frames_name))
    if (frame.offset <= data.size() && frame.bytes <= data.size() - frame.offset)
      frame.checksum = sections::checksum_of(data.subspan(frame.offset, frame.bytes));
}

// Of packed files and of others: which, is in the header.
const sections::FileKind& kind_of(std::span<const std::byte> bytes) {
  sections::FileHeader header;
  if (bytes.size() >= sizeof(header)) std::memcpy(&header, bytes.data(), sizeof(header));
  const bool is_packed = header.version == packed_vlod_version || header.version == textured_vlod_version;
  return is_packed ? packed_kind : file_kind;
}

void sign_options(const fuzz::SectionSigner& file) {
  const std::span<StoredObject> objects = file.find<StoredObject>(objects_name);
  const std::vector<StoredObject> good = describe(scene().objects());
  if (objects.size() == good.size()) std::copy(good.begin(), good.end(), objects.begin());
  const std::span<StoredOptions> stored = file.find<StoredOptions>(options_name);
  if (stored.empty()) return;
  stored[0].epoch = epoch;
  const Scene read{restore(stored[0], file.find<CellBox>(regions_name)), {objects.begin(), objects.end()}};
  stored[0].key = store(read).key;
}

// All that is below `cell`.
void read_below(const VlodFile& file, CellId cell, std::vector<const CellAdditions*>& above) {
  const CellAdditions additions = file.read(cell, above);
  above.push_back(&additions);
  for (CellId child = cell + 1; child < file.tree().node(cell).end; child = file.tree().node(child).end)
    read_below(file, child, above);
  above.pop_back();
}

void use(const VlodFile& file, bool has_scene) {
  std::vector<const CellAdditions*> above;
  std::vector<CellId> cells;
  const CellTree& tree = file.tree();
  for (CellId n = 0; n < tree.nodes().size() && n < 64; ++n) {
    static_cast<void>(tree.leaf_of(tree.node(n).box.max));
    static_cast<void>(tree.nearest_leaf(tree.node(n).box.min));
    if (!tree.is_leaf(n)) continue;
    tree.neighbours(n, cells);
    if (has_scene) static_cast<void>(read_cell(file, scene().objects(), n));
    if (file.is_packed() && !has_scene) static_cast<void>(read_cell(file, n));
  }
  read_below(file, 0, above);
}

}  // namespace
}  // namespace occlod::vlod

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace occlod;
  std::vector<std::byte> bytes(size);
  if (size > 0) std::memcpy(bytes.data(), data, size);
  fuzz::SectionSigner signer(bytes, vlod::kind_of(bytes));
  signer.sign([&] {
    vlod::sign_payloads(signer);
    vlod::sign_frames(signer);
    vlod::sign_options(signer);
  });
  const fuzz::MemoryFile file(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  for (const bool has_scene : {false, true}) {
    try {
      const auto opened = has_scene ? open_vlod(file.path(), vlod::scene().objects()) : open_vlod(file.path());
      vlod::use(*opened, has_scene);
    } catch (const Error&) {
      continue;  // refused
    }
  }
  return 0;
}
