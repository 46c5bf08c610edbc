#include "hlod/store/ohlod.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "base/memory.h"
#include "base/platform.h"
#include "base/threads.h"
#include "hlod/store/features.h"
#include "hlod/store/hlod_data.h"
#include "hlod/store/mesh_loader.h"
#include "hlod/store/node_codec.h"
#include "hlod/texture/own_images.h"
#include "mesh/section_file.h"
#include "occlod/base.h"
#include "occlod/hlod.h"
#include "occlod/node_store.h"

namespace occlod::ohlod {
namespace {

std::uint64_t digest_of(std::span<const std::byte> all, std::uint64_t place, std::size_t bytes) {
  return sections::checksum_of(all.subspan(place, std::min(hlod::align_mesh(bytes), all.size() - place)));
}

}  // namespace

std::uint64_t digest_of_mesh(const hlod::HlodView& view, hlod::NodeId n) {
  const hlod::Node& node = view.nodes[n];
  return digest_of(view.meshes, node.mesh, hlod::MeshLayout(node, hlod::arrays_of(view)).bytes);
}

std::uint64_t digest_of_splits(const hlod::HlodView& view, hlod::NodeId n) {
  const hlod::NodeWithin& within = view.within[n];
  return digest_of(view.splits, within.place, hlod::SplitsLayout(within, hlod::arrays_of(view)).bytes);
}

}  // namespace occlod::ohlod

namespace occlod {
namespace {

using namespace ohlod;
using namespace sections;

// Tables of packed files are packed, too, for those who read them from afar. What fits into a request is not.
template <typename Array>
Codec codec_of_tables(bool is_packed, const Array& array) {
  constexpr std::size_t least_bytes = 1U << 12U;
  return is_packed && std::span(array).size_bytes() >= least_bytes ? Codec::zstd : Codec::stored;
}

// Writes the parts of nodes and their checksums, node by node.
class NodeSections {
 public:
  NodeSections(SectionWriter& writer, std::string_view digests_name, unsigned threads)
      : writer_(writer), digests_name_(digests_name), threads_(threads) {}

  // Adds them unpacked. `digest_of(n)` returns the checksum of node n.
  template <typename Digest>
  void add(std::string_view name, std::span<const std::byte> all, std::size_t nodes, const Digest& digest_of) {
    writer_.add(name, all, Check::parts);
    for (hlod::NodeId n = 0; n < nodes; ++n) {
      make_room();
      digests_.push_back(digest_of(n));
    }
    add_digests();
  }

  // Adds them packed. `pack(packer, n, bytes)` appends the part of node n.
  template <typename Pack>
  void add_packed(std::string_view name, std::string_view places_name, std::size_t nodes, const Pack& pack) {
    std::vector<LargeVector<std::byte>> packed(std::min(nodes, nodes_at_once));
    for (std::size_t first = 0; first < nodes; first += nodes_at_once) {
      const std::size_t count = std::min(nodes_at_once, nodes - first);
      for_each_task(
          count, threads_, [] { return std::make_unique<NodePacker>(); },
          [&](const std::unique_ptr<NodePacker>& packer, std::size_t i) {
            packed[i].clear();
            pack(*packer, static_cast<hlod::NodeId>(first + i), packed[i]);
          },
          [] {});
      for (std::size_t i = 0; i < count; ++i) append(packed[i]);
    }
    writer_.add(name, std::span<const std::byte>(packed_), Check::parts);
    writer_.add(places_name, std::span<const std::uint64_t>(places_), Check::whole, codec_of_tables(true, places_));
    add_digests();
  }

 private:
  static constexpr std::size_t nodes_at_once = 256;  // in memory before they are joined

  void append(std::span<const std::byte> node) {
    make_room();
    digests_.push_back(checksum_of(node));
    packed_.insert(packed_.end(), node.begin(), node.end());
    places_.push_back(packed_.size());
  }
  void add_digests() { writer_.add(digests_name_, std::span<const std::uint64_t>(digests_)); }

  SectionWriter& writer_;
  std::string_view digests_name_;
  unsigned threads_;
  LargeVector<std::byte> packed_;
  std::vector<std::uint64_t> places_{0}, digests_;
};

Summary summary_of(const hlod::HlodView& view) {
  return {view.box,
          view.input_triangle_count,
          static_cast<std::uint32_t>(view.grouping),
          static_cast<std::uint32_t>(view.borders),
          view.node_triangles,
          view.has_normals ? 1U : 0U,
          view.has_colors ? 1U : 0U,
          wedge_flags(view)};
}

}  // namespace

void write_ohlod(const std::filesystem::path& path, const hlod::Hlod& hlod, const MeshReport& report,
                 const OhlodOptions& options) {
  const unsigned threads = thread_count(options.threads);
  hlod.require_all();
  hlod::HlodView view = hlod.data();
  hlod::OwnImages own;
  if (options.images == OhlodImages::nodes && view.node_images.empty() && view.within.empty())
    own = make_own_images(hlod, options.image_folder, options.images_journal, threads, options.images_progress);
  if (!own.table.empty()) {
    view.nodes = own.nodes;
    view.node_images = own.table;
    view.images = own.bytes;
    view.image_materials = own.materials;
  }
  const std::size_t nodes = view.nodes.size();
  const bool is_packed = options.compression == OlodCompression::zstd;
  SectionWriter writer;
  const auto add_tables = [&](std::string_view name, const auto& array, bool has_parts) {
    if (!has_parts) writer.add(name, array, Check::whole, codec_of_tables(is_packed, array));
  };
  for_each_array(view, add_tables);
  NodeSections meshes(writer, digests_name, threads);
  if (is_packed)
    meshes.add_packed(packed_meshes_name, mesh_places_name, nodes,
                      [&](NodePacker& packer, hlod::NodeId n, auto& to) { packer.pack_mesh(view, n, to); });
  else
    meshes.add(meshes_name, view.meshes, nodes, [&](hlod::NodeId n) { return digest_of_mesh(view, n); });
  const Summary summary = summary_of(view);
  writer.add(summary_name, std::span<const Summary>(&summary, 1));
  if (view.lattice_step > 0.0F) writer.add(lattice_name, std::span<const float>(&view.lattice_step, 1));
  writer.add_report(report);
  NodeSections splits(writer, splits_digests_name, threads);
  if (!view.within.empty()) {
    for_each_within_array(view, add_tables);
    if (is_packed)
      splits.add_packed(packed_splits_name, splits_places_name, nodes,
                        [&](NodePacker& packer, hlod::NodeId n, auto& to) { packer.pack_splits(view, n, to); });
    else
      splits.add(splits_name, view.splits, nodes, [&](hlod::NodeId n) { return digest_of_splits(view, n); });
  }
  if (!view.node_images.empty()) {
    writer.add(node_images_name, view.node_images);
    writer.add(image_materials_name, view.image_materials);
    writer.add(images_name, view.images, Check::parts);
  }
  MaterialSections materials;
  if (needs_wedges(view) || view.up != UpAxis::z) materials.add(view, writer, {options.image_folder, folder_of(path)});
  hlod::FeatureSections features;
  features.add(view.features, writer);
  FileKind kind = file_kind;
  kind.version = is_packed ? packed_version : needs_wedges(view) ? wedges_version : plain_version;
  if (writer.add_origin(view.origin)) kind.version = origin_version;
  if (!view.node_images.empty()) kind.version = ohlod_version;
  writer.write(path, kind);
}

namespace {

using namespace ohlod;
using namespace sections;

// Holds what an HLOD in a file keeps alive.
struct Owner {
  std::shared_ptr<SectionReader> reader;
  Materials materials;
  UninitializedVector<std::byte> meshes, splits;  // in a packed file: those of each node, once checked
  std::vector<hlod::Node> nodes;                  // of an old file, with boxes that hold everything
  std::vector<std::string> feature_names;
};

void take(const Summary& summary, const SectionReader& reader, hlod::HlodView& view) {
  if (summary.has_normals > 1 || summary.has_colors > 1 || summary.wedges > all_wedge_flags)
    reader.refuse("", "does not say whether it has attributes");
  view.box = summary.box;
  view.input_triangle_count = summary.input_triangle_count;
  view.grouping = static_cast<hlod::Grouping>(summary.grouping);
  view.borders = static_cast<hlod::Borders>(summary.borders);
  view.node_triangles = summary.node_triangles;
  view.has_normals = summary.has_normals != 0;
  view.has_colors = summary.has_colors != 0;
  view.has_texture_coordinates = (summary.wedges & has_texture_coordinates) != 0;
  view.has_materials = (summary.wedges & has_materials) != 0;
  view.has_seams = (summary.wedges & has_seams) != 0;
}

// Reads the arrays without parts, as the visitor of for_each_array().
struct TableReader {
  SectionReader& reader;

  template <typename T>
  void operator()(std::string_view name, std::span<const T>& array, bool has_parts) const {
    if (!has_parts) array = reader.read<T>(name);
  }
};

// Holds everything but meshes and the arrays of refinement within nodes.
struct Tables {
  hlod::HlodView view;
  std::shared_ptr<Owner> owner;  // of what the view refers to
  MeshReport report;
  OlodCompression compression = OlodCompression::none;
};

// Reads the tables; if `is_far` only what drawing needs, without images of materials and features. Throws Error.
Tables read_tables(const std::shared_ptr<SectionReader>& reader, bool is_far = false) {
  Tables tables;
  hlod::HlodView& view = tables.view;
  for_each_array(view, TableReader{*reader});
  take(reader->read_one<Summary>(summary_name, "summary"), *reader, view);
  if (reader->has(lattice_name)) view.lattice_step = reader->read_one<float>(lattice_name, "lattice step");
  view.origin = reader->read_origin();
  tables.owner = std::make_shared<Owner>(Owner{reader, read_materials(*reader, !is_far), {}, {}, {}, {}});
  if (reader->header().version <= last_narrow_version) {
    tables.owner->nodes.assign(view.nodes.begin(), view.nodes.end());
    for (hlod::Node& node : tables.owner->nodes) node.box = node.lod_box;
    view.nodes = tables.owner->nodes;
  }
  view.materials = tables.owner->materials.materials;
  view.textures = tables.owner->materials.textures;
  view.texture_origin = tables.owner->materials.origin;
  view.up = tables.owner->materials.up;
  if (!is_far) view.features = hlod::read_features(*reader, tables.owner->feature_names);
  tables.report = reader->read_report();
  if (reader->has(packed_meshes_name)) tables.compression = OlodCompression::zstd;
  if (reader->has(node_images_name)) {
    view.node_images = reader->read<hlod::NodeImage>(node_images_name);
    view.image_materials = reader->read<std::uint8_t>(image_materials_name);
    const std::uint64_t end = reader->bytes_of(images_name);
    for (const hlod::NodeImage& image : view.node_images)
      if (image.place > end || image.bytes > end - image.place)
        reader->refuse("section NIMG", "has an image outside of section IMGS");
  }
  return tables;
}

// Checks the nodes, without meshes and splits, and returns the digests of meshes. `mesh_bytes` is the size of all
// meshes. Throws Error.
std::span<const std::uint64_t> check_nodes(SectionReader& reader, const hlod::HlodView& view,
                                           std::uint64_t mesh_bytes) {
  if (const auto problem = check_structure(view, mesh_bytes))
    reader.refuse("", "does not hold a valid HLOD: " + *problem);
  const auto digests = reader.read<std::uint64_t>(digests_name);
  if (digests.size() != view.nodes.size()) reader.refuse("section BLOK", "does not have a checksum for every node");
  return digests;
}

// Locates the unpacked bytes that belong to one node.
struct Extent {
  std::uint64_t place = 0, bytes = 0;
};

// Returns the extent of a mesh with padding for the next.
Extent mesh_extent(const hlod::HlodView& view, hlod::NodeId n) {
  return {view.nodes[n].mesh, hlod::padded_mesh_bytes(view, n)};
}

Extent splits_extent(const hlod::HlodView& view, hlod::NodeId n) {
  const hlod::NodeWithin& within = view.within[n];
  return {within.place, hlod::align_mesh(hlod::SplitsLayout(within, arrays_of(view)).bytes)};
}

// Tells where a packed file has the mesh or the splits of each node.
struct PackedNodes {
  std::span<const std::uint64_t> places;  // per node, in its section; then the end
  std::uint64_t unpacked_bytes = 0;       // of all nodes

  [[nodiscard]] std::size_t bytes_of(hlod::NodeId n) const noexcept { return places[n + 1] - places[n]; }
};

// Reads the places of packed nodes. `extent_of(n)` returns the unpacked extent. Throws Error unless places and extents
// both follow each other without gaps, and the packed bytes can unpack to that many. O(nodes).
template <typename ExtentOf>
PackedNodes read_packed(SectionReader& reader, std::string_view bytes_name, std::string_view places_name,
                        std::size_t nodes, const ExtentOf& extent_of) {
  PackedNodes packed{reader.read<std::uint64_t>(places_name)};
  const auto& places = packed.places;
  const auto refuse = [&](const std::string& problem) {
    reader.refuse(fmt::format("section {}", places_name), problem);
  };
  if (places.size() != nodes + 1 || places.front() != 0 || places.back() != reader.bytes_of(bytes_name) ||
      !std::ranges::is_sorted(places))
    refuse(fmt::format("does not divide section {} between nodes", bytes_name));
  for (hlod::NodeId n = 0; n < nodes; ++n) {
    const Extent extent = extent_of(n);
    if (extent.place != packed.unpacked_bytes) refuse(fmt::format("node {} does not follow the one before", n));
    if (extent.bytes > max_packing * packed.bytes_of(n)) refuse(fmt::format("node {} has too few bytes", n));
    packed.unpacked_bytes += extent.bytes;
  }
  return packed;
}

// Unpacks the meshes or splits of nodes in a packed file on request, once each.
class Unpacking {
 public:
  Unpacking(std::span<const std::byte> bytes, const PackedNodes& packed, std::span<std::byte> unpacked)
      : bytes_(bytes), packed_(packed), unpacked_(unpacked), done_(packed.places.size() - 1) {}

  // Any number of threads may call this. `unpack(unpacker, packed, raw)` returns false when the bytes are damaged.
  template <typename Unpack>
  [[nodiscard]] bool unpack(hlod::NodeId n, const Extent& extent, std::uint64_t digest, const Unpack& unpack) {
    static thread_local NodeUnpacker unpacker;
    const std::lock_guard lock(mutexes_[n % mutexes_.size()]);
    if (done_[n] != 0) return true;
    const std::span<const std::byte> packed = bytes_.subspan(packed_.places[n], packed_.bytes_of(n));
    if (checksum_of(packed) != digest || !unpack(unpacker, packed, unpacked_.subspan(extent.place, extent.bytes)))
      return false;
    done_[n] = 1;
    return true;
  }

 private:
  std::span<const std::byte> bytes_;
  PackedNodes packed_;
  std::span<std::byte> unpacked_;
  std::vector<std::uint8_t> done_;  // per node
  std::array<std::mutex, 16> mutexes_;
};

// Holds one digest per node.
struct Digests {
  std::span<const std::uint64_t> meshes, splits;
};

class FileGuard final : public hlod::NodeGuard {
 public:
  FileGuard(std::shared_ptr<const Owner> owner, const hlod::HlodView& view, const Digests& digests)
      : NodeGuard(view.nodes.size(), view.within.size()), owner_(std::move(owner)), view_(view), digests_(digests) {}

  // They are null unless the file is packed.
  std::unique_ptr<Unpacking> meshes, splits;

 private:
  void check_node(hlod::NodeId n) override {
    if (const std::size_t bytes = image_bytes_of(view_, n);
        bytes > 0 &&
        checksum_of(view_.images.subspan(view_.node_images[n].place, bytes)) != view_.node_images[n].checksum)
      owner_->reader->refuse(fmt::format("image of node {}", n), "is damaged: its checksum is wrong");
    const auto unpack = [&](NodeUnpacker& unpacker, auto packed, auto raw) {
      return unpacker.unpack_mesh(view_, n, packed, raw);
    };
    const bool is_whole = meshes ? meshes->unpack(n, mesh_extent(view_, n), digests_.meshes[n], unpack)
                                 : digest_of_mesh(view_, n) == digests_.meshes[n];
    if (!is_whole) owner_->reader->refuse(fmt::format("node {}", n), "is damaged: its checksum is wrong");
    if (const auto problem = check_mesh(view_, n))
      owner_->reader->refuse(fmt::format("node {}", n), "has no valid mesh: " + *problem);
  }

  void check_splits(hlod::NodeId n) override {
    const auto unpack = [&](NodeUnpacker& unpacker, auto packed, auto raw) {
      return unpacker.unpack_splits(view_, n, packed, raw);
    };
    const bool is_whole = splits ? splits->unpack(n, splits_extent(view_, n), digests_.splits[n], unpack)
                                 : digest_of_splits(view_, n) == digests_.splits[n];
    if (!is_whole) owner_->reader->refuse(fmt::format("splits of node {}", n), "are damaged: their checksum is wrong");
    if (const auto problem = hlod::check_within(view_, n))
      owner_->reader->refuse(fmt::format("splits of node {}", n), "are not valid: " + *problem);
  }

  std::shared_ptr<const Owner> owner_;
  hlod::HlodView view_;
  Digests digests_;
};

// Makes room for the unpacked bytes.
template <typename ExtentOf>
std::unique_ptr<Unpacking> unpack_into(UninitializedVector<std::byte>& unpacked, SectionReader& reader,
                                       std::string_view bytes_name, std::string_view places_name, std::size_t nodes,
                                       const ExtentOf& extent_of) {
  const PackedNodes packed = read_packed(reader, bytes_name, places_name, nodes, extent_of);
  unpacked.resize(packed.unpacked_bytes);
  return std::make_unique<Unpacking>(reader.read<std::byte>(bytes_name, Check::parts), packed, unpacked);
}

// Reads meshes from an open file.
class FileMeshes final : public hlod::MeshSource {
 public:
  FileMeshes(std::shared_ptr<const ByteSource> file, FarAway far, std::shared_ptr<const SectionReader> reader,
             const hlod::HlodView& view, std::span<const std::uint64_t> digests, std::optional<PackedNodes> packed)
      : file_(std::move(file)),
        far_(std::move(far)),
        reader_(std::move(reader)),
        view_(view),
        digests_(digests),
        packed_(packed),
        place_(reader_->offset_of(packed_ ? packed_meshes_name : meshes_name)),
        images_place_(view.node_images.empty() ? 0 : reader_->offset_of(images_name)),
        bytes_(packed_ ? packed_->unpacked_bytes : reader_->bytes_of(meshes_name)) {}

  [[nodiscard]] std::size_t bytes_of(hlod::NodeId n) const noexcept override {
    const std::size_t image = image_bytes_of(view_, n);
    return image > 0 ? mesh_extent(view_, n).bytes + image : mesh_bytes_of(n);
  }

  [[nodiscard]] hlod::StoredMesh stored(hlod::NodeId n) const noexcept override {
    if (packed_) return {packed_->places[n], packed_->bytes_of(n)};
    return {view_.nodes[n].mesh, mesh_bytes_of(n)};
  }

  [[nodiscard]] hlod::StoredImage stored_image(hlod::NodeId n) const noexcept override {
    if (!far_.make_queue || image_bytes_of(view_, n) == 0) return {};
    const hlod::NodeImage& image = view_.node_images[n];
    return {images_place_ + image.place, image.bytes, image.checksum};
  }

  void read(hlod::NodeId first, std::span<const std::span<std::byte>> meshes) override {
    try {
      file_->read(meshes, place_ + stored(first).place);
    } catch (const std::system_error& error) {
      reader_->refuse(fmt::format("node {}", first), fmt::format("cannot be read: {}", error.code().message()),
                      "check that the file is whole");
    }
  }

  [[nodiscard]] hlod::MeshBytes unpack(hlod::NodeId n, hlod::MeshBytes stored_mesh) override {
    const std::span<const std::byte> bytes(stored_mesh.get(), stored(n).bytes);
    bool is_whole = checksum_of(bytes) == digests_[n];
    hlod::MeshBytes mesh = std::move(stored_mesh);
    const std::size_t all = bytes_of(n);
    if (is_whole && (packed_ || all > bytes.size())) {
      auto whole = std::make_unique_for_overwrite<std::byte[]>(all);
      const std::span<std::byte> raw(whole.get(), mesh_bytes_of(n));
      if (packed_)
        is_whole = unpacker_.unpack_mesh(view_, n, bytes, raw);
      else
        std::ranges::copy(bytes, raw.begin());
      mesh = std::move(whole);
    }
    if (!is_whole) reader_->refuse(fmt::format("node {}", n), "is damaged: its checksum is wrong");
    const std::size_t image_bytes = image_bytes_of(view_, n);
    if (image_bytes > 0) read_image(n, {mesh.get() + (all - image_bytes), image_bytes});
    if (const auto problem = check_mesh(view_, n, mesh_at(view_, n, mesh.get(), mesh.get() + (all - image_bytes))))
      reader_->refuse(fmt::format("node {}", n), "has no valid mesh: " + *problem);
    return mesh;
  }

  [[nodiscard]] bool reads_ahead() const noexcept override { return far_.make_queue == nullptr; }

  [[nodiscard]] std::unique_ptr<hlod::LoadQueue> make_queue() override {
    return far_.make_queue ? far_.make_queue(*this) : MeshSource::make_queue();
  }

 private:
  // Returns the size of the mesh in memory without the image. The last one has no padding.
  [[nodiscard]] std::size_t mesh_bytes_of(hlod::NodeId n) const noexcept {
    const Extent extent = mesh_extent(view_, n);
    return std::min(extent.bytes, bytes_ - extent.place);
  }

  void read_image(hlod::NodeId n, std::span<std::byte> image) {
    const std::string place = fmt::format("image of node {}", n);
    try {
      file_->read({&image, 1}, images_place_ + view_.node_images[n].place);
    } catch (const std::system_error& error) {
      reader_->refuse(place, fmt::format("cannot be read: {}", error.code().message()), "check that the file is whole");
    }
    if (checksum_of(image) == view_.node_images[n].checksum) return;
    try {
      reader_->refuse(place, "is damaged: its checksum is wrong");
    } catch (const Error& error) {
      if (!far_.drop_image) throw;
      std::ranges::fill(image, std::byte{0});
      far_.drop_image(error.what());
    }
  }

  std::shared_ptr<const ByteSource> file_;
  FarAway far_;
  std::shared_ptr<const SectionReader> reader_;
  hlod::HlodView view_;
  std::span<const std::uint64_t> digests_;
  std::optional<PackedNodes> packed_;
  std::uint64_t place_;         // in the file
  std::uint64_t images_place_;  // likewise; 0 without images
  std::uint64_t bytes_;         // in memory, of all meshes
  NodeUnpacker unpacker_;
};

}  // namespace

OhlodFile read_ohlod(const std::filesystem::path& path, OlodAccess access) {
  const auto reader = std::make_shared<SectionReader>(path, file_kind, access == OlodAccess::mapped);
  Tables tables = read_tables(reader);
  hlod::HlodView& view = tables.view;
  const bool is_packed = tables.compression == OlodCompression::zstd, has_splits = reader->has(splits_digests_name);
  std::unique_ptr<Unpacking> meshes, splits;
  Digests digests;
  Owner& owner = *tables.owner;
  if (is_packed) {
    meshes = unpack_into(owner.meshes, *reader, packed_meshes_name, mesh_places_name, view.nodes.size(),
                         [&](hlod::NodeId n) { return mesh_extent(view, n); });
    view.meshes = owner.meshes;
  } else {
    view.meshes = reader->read<std::byte>(meshes_name, Check::parts);
  }
  if (has_splits) {
    for_each_within_array(view, TableReader{*reader});
    digests.splits = reader->read<std::uint64_t>(splits_digests_name);
    if (is_packed) {
      splits = unpack_into(owner.splits, *reader, packed_splits_name, splits_places_name, view.within.size(),
                           [&](hlod::NodeId n) { return splits_extent(view, n); });
      view.splits = owner.splits;
    } else {
      view.splits = reader->read<std::byte>(splits_name, Check::parts);
    }
  }
  if (!view.node_images.empty()) view.images = reader->read<std::byte>(images_name, Check::parts);
  digests.meshes = check_nodes(*reader, view, view.meshes.size());
  if (digests.splits.size() != view.within.size())
    reader->refuse("section WBLK", "does not have a checksum for every node");
  const auto guard = std::make_shared<FileGuard>(tables.owner, view, digests);
  guard->meshes = std::move(meshes);
  guard->splits = std::move(splits);
  return {guarded_hlod(view, tables.owner, guard), tables.report, tables.compression, reader->header().version};
}

OhlodFile open_ohlod(const std::filesystem::path& path, const hlod::CacheOptions& cache) {
  return ohlod::open_ohlod(byte_source_of(open_file(path)), path, cache);
}

OhlodFile ohlod::open_ohlod(std::shared_ptr<const ByteSource> file, const std::filesystem::path& name,
                            const hlod::CacheOptions& cache, FarAway far) {
  const auto reader = std::make_shared<SectionReader>(file, name, file_kind);
  const auto [view, owner, report, compression] = read_tables(reader, far.make_queue != nullptr);
  std::optional<PackedNodes> packed;
  if (compression == OlodCompression::zstd)
    packed = read_packed(*reader, packed_meshes_name, mesh_places_name, view.nodes.size(),
                         [&view = view](hlod::NodeId n) { return mesh_extent(view, n); });
  const auto digests = check_nodes(*reader, view, packed ? packed->unpacked_bytes : reader->bytes_of(meshes_name));
  auto source = std::make_unique<FileMeshes>(std::move(file), std::move(far), reader, view, digests, packed);
  return {paged_hlod(std::make_shared<hlod::NodeStore>(view, owner, std::move(source), cache)), report, compression,
          reader->header().version};
}

}  // namespace occlod
