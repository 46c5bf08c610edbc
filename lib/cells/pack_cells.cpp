#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "cells/cell_mesh.h"
#include "cells/packed_geometry.h"
#include "cells/packed_numbers.h"
#include "cells/vlod_format.h"
#include "cells/vlod_payload.h"
#include "mesh/section_file.h"
#include "occlod/base.h"
#include "occlod/build_cells.h"
#include "occlod/hierarchy.h"
#include "splits/olod.h"
#include "splits/star.h"
#include "splits/star_record.h"
#include "splits/structure.h"

namespace occlod::vlod {
namespace {

// Renumbers the stars and vertices of a hierarchy for a packed file.

// Describes one mesh of a packed file: which splits it has, in the order of the file.
class PackedStars {
 public:
  // `splits` are splits of the hierarchy, which must outlive this object; each comes after those on which it depends,
  // all of which are included.
  PackedStars(const Hierarchy& hierarchy, std::vector<SplitId> splits);

  [[nodiscard]] MeshRow row() const;
  [[nodiscard]] std::span<const SplitId> splits() const noexcept { return splits_; }
  [[nodiscard]] const Hierarchy& hierarchy() const noexcept { return hierarchy_; }
  // Returns the number of a split; no_id if it is not included.
  [[nodiscard]] SplitId number_of(SplitId split) const noexcept { return split == no_id ? no_id : numbers_[split]; }

  // Appends split `number` of the file to the frame.
  void append(SplitId number, GeometryFrame& frame) const;

  // Calls visit(wedge) for each wedge of a vertex that the file has: its first one, and those of the others that some
  // face of the file uses. They are numbered in this order.
  template <typename Visit>
  void for_each_wedge(VertexId v, const Visit& visit) const {
    visit(v);
    const WedgeRange extra = extra_wedges_of(hierarchy_.data(), v);
    for (WedgeId w = extra.first; w < extra.first + extra.count; ++w)
      if (number_of_wedge(w) != no_id) visit(w);
  }
  // Returns, for each corner of a face, the number of its wedge.
  [[nodiscard]] Triangle corners(const Triangle& wedges) const noexcept {
    return {number_of_wedge(wedges.x), number_of_wedge(wedges.y), number_of_wedge(wedges.z)};
  }

 private:
  void number_wedges();
  void append_corners(SplitId split, std::uint32_t extra, GeometryFrame& frame) const;
  [[nodiscard]] std::uint32_t number_of_wedge(WedgeId wedge) const noexcept {
    return wedge < hierarchy_.vertex_count() ? 0 : wedge_numbers_[wedge - hierarchy_.vertex_count()];
  }
  [[nodiscard]] VertexId vertex(VertexId v) const noexcept;
  [[nodiscard]] Triangle triangle(const Triangle& t) const noexcept { return {vertex(t.x), vertex(t.y), vertex(t.z)}; }

  const Hierarchy& hierarchy_;
  std::vector<SplitId> splits_, numbers_;     // each maps the other's numbering
  std::vector<std::uint32_t> wedge_numbers_;  // of extra wedges: from 1 on, or no_id where no face of the file uses it
};

PackedStars::PackedStars(const Hierarchy& hierarchy, std::vector<SplitId> splits)
    : hierarchy_(hierarchy), splits_(std::move(splits)), numbers_(hierarchy.split_count(), no_id) {
  for (SplitId number = 0; number < splits_.size(); ++number) numbers_[splits_[number]] = number;
  number_wedges();
}

void PackedStars::number_wedges() {
  const std::span<const VertexId> extra = hierarchy_.data().extra_wedges;
  wedge_numbers_.assign(extra.size(), no_id);
  const auto use = [&](const Triangle& wedges) {
    for (int k = 0; k < 3; ++k)
      if (wedges[k] >= hierarchy_.vertex_count()) wedge_numbers_[wedges[k] - hierarchy_.vertex_count()] = 0;
  };
  for (const Triangle& wedges : hierarchy_.data().base_corners) use(wedges);
  if (extra.empty()) return;
  for (const SplitId split : splits_) {
    const SplitCorners corners = corners_of_star(hierarchy_, split);
    for (std::uint32_t slot = 0; slot < star_of(hierarchy_, split).inserted_count(); ++slot)
      use(corners.inserted(slot));
  }
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < extra.size(); ++i) {
    if (i > 0 && extra[i] != extra[i - 1]) last = 0;
    if (wedge_numbers_[i] != no_id) wedge_numbers_[i] = ++last;
  }
}

MeshRow PackedStars::row() const {
  const HierarchyView& data = hierarchy_.data();
  const auto bit_of = [](const auto& values, std::uint32_t bit) { return values.empty() ? 0 : bit; };
  return {static_cast<std::uint32_t>(hierarchy_.base_vertex_count()),
          static_cast<std::uint32_t>(hierarchy_.base_triangle_count()), static_cast<std::uint32_t>(splits_.size()),
          bit_of(data.normals, has_normals) | bit_of(data.colors, has_colors) |
              bit_of(data.texture_coordinates, has_coordinates) | bit_of(data.wedge_materials, has_materials) |
              bit_of(data.extra_wedges, has_seams)};
}

VertexId PackedStars::vertex(VertexId v) const noexcept {
  const auto base = static_cast<VertexId>(hierarchy_.base_vertex_count());
  return v < base ? v : base + numbers_[v - base];
}

void PackedStars::append(SplitId number, GeometryFrame& frame) const {
  const SplitId split = splits_[number];
  const SplitStar star = star_of(hierarchy_, split);
  std::vector<Triangle> inserted;
  std::vector<RemovedFace> removed;
  std::vector<SplitId> dependencies;
  star.for_each_inserted([&](const Triangle& t) { inserted.push_back(triangle(t)); });
  star.for_each_removed([&](const FaceRef& face, const Triangle& t) {
    removed.push_back({{number_of(face.split), face.slot}, triangle(t)});
  });
  for (const SplitId needed : star.dependencies()) dependencies.push_back(number_of(needed));
  std::ranges::sort(dependencies);
  const StarShape fan = star.ring().size() == inserted.size() ? StarShape::closed_fan : StarShape::open_fan;
  frame.stars.push_back(static_cast<std::uint32_t>(frame.words.size()));
  append_star({vertex(star.parent_vertex()), star.is_fan() ? fan : StarShape::other, inserted, removed, dependencies},
              frame.words);
  const HierarchyView& data = hierarchy_.data();
  const VertexId v = hierarchy_.vertex_of(split);
  frame.positions.push_back(data.positions[v]);
  std::uint32_t extra = 0;
  for_each_wedge(v, [&](WedgeId w) {
    extra += w == v ? 0 : 1;
    if (!data.normals.empty()) frame.normals.push_back(data.normals[w]);
    if (!data.colors.empty()) frame.colors.push_back(data.colors[w]);
    if (!data.texture_coordinates.empty()) frame.coordinates.push_back(data.texture_coordinates[w]);
    if (!data.wedge_materials.empty()) frame.materials.push_back(data.wedge_materials[w]);
  });
  append_corners(split, extra, frame);
}

void PackedStars::append_corners(SplitId split, std::uint32_t extra, GeometryFrame& frame) const {
  const SplitCorners corners = corners_of_star(hierarchy_, split);
  if (!corners.are_first())
    for (std::uint32_t slot = 0; slot < star_of(hierarchy_, split).inserted_count(); ++slot) {
      const Triangle numbers = this->corners(corners.inserted(slot));
      frame.corners.insert(frame.corners.end(), {numbers.x, numbers.y, numbers.z});
    }
  if (frame.extra_wedges.empty()) frame.extra_wedges = frame.corner_starts = {0};
  frame.extra_wedges.push_back(frame.extra_wedges.back() + extra);
  frame.corner_starts.push_back(static_cast<std::uint32_t>(frame.corners.size()));
}

}  // namespace

}  // namespace occlod::vlod

namespace occlod {

using namespace vlod;

namespace {

// Limits the number of splits in a frame. A frame ends where splits begin that another node adds first, unless the
// frame would be small.
constexpr std::uint32_t min_in_frame = 128, max_in_frame = 512;
constexpr double read_share = 0.4;  // estimated share of the time

class Packing {
 public:
  Packing(const VlodFile& file, std::span<const RefineObject> objects, const std::function<bool(double)>& progress,
          int level)
      : file_(file),
        progress_(progress),
        level_(level),
        mesh_of_(meshes_of(file.objects())),
        ids_(file.objects(), "the objects") {
    if (!file.has_objects() || objects.size() != file.object_count())
      throw Error({"pack_cells()", "", "has not the objects that the file was opened with", "open the file with them"});
    for (std::uint32_t i = 0; i < objects.size(); ++i) {
      if (mesh_of_[i] != hierarchies_.size()) continue;
      hierarchies_.push_back(objects[i].hierarchy);
      first_split_.push_back(first_split_.back() + static_cast<std::uint32_t>(objects[i].hierarchy->split_count()));
    }
    read_nodes(objects);
    number_splits();
    encode_nodes();
    make_frames();
    add_base_meshes();
  }

  void write(const std::filesystem::path& path) const;

 private:
  void read_nodes(std::span<const RefineObject> objects);
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> added_splits() const;
  void number_splits();
  void encode_nodes();
  void make_frames();
  void add_frame(std::span<const std::uint32_t> splits);
  void add_base_meshes();
  void add_base_mesh(const PackedStars& stars);
  void add_materials(const HierarchyView& data);
  [[nodiscard]] bool has_looks() const {
    return std::ranges::any_of(hierarchies_, [](const Hierarchy* h) { return olod::has_looks(h->data()); });
  }

  void tell(double share) const {
    if (progress_ && !progress_(share)) throw Error({"packing", "", "was cancelled", "start it again"});
  }
  [[nodiscard]] std::uint32_t mesh_with(std::uint32_t split) const {
    return static_cast<std::uint32_t>(std::ranges::upper_bound(first_split_, split) - first_split_.begin() - 1);
  }

  const VlodFile& file_;
  const std::function<bool(double)>& progress_;
  int level_;
  std::vector<std::uint32_t> mesh_of_;  // per object
  GlobalIds ids_;
  std::vector<const Hierarchy*> hierarchies_;     // per mesh
  std::vector<std::uint32_t> first_split_ = {0};  // per mesh, in global numbering; then the total
  std::vector<CellAdditions> additions_;          // per node
  std::vector<CellId> adders_;        // per split in global numbering: the first node that adds it, or no_id
  std::vector<std::uint32_t> order_;  // splits in global numbering, in the order of the file
  std::vector<PackedStars> stars_;    // per mesh
  // Data that is written.
  std::vector<CellNode> nodes_;
  std::vector<std::byte> payloads_, geometry_;
  std::vector<MeshRow> meshes_;
  std::vector<FrameRow> frames_;
  std::vector<PieceRow> pieces_;
  std::vector<std::uint32_t> permutation_;
  std::vector<glm::vec3> base_positions_, base_normals_;
  std::vector<glm::u8vec4> base_colors_;
  std::vector<glm::vec2> base_coordinates_;
  std::vector<MaterialId> base_materials_;
  std::vector<std::uint32_t> base_wedges_;
  std::vector<Triangle> base_faces_, base_corners_;
  std::vector<LookRow> looks_;
  struct {
    std::vector<Material> materials;
    std::vector<Texture> textures;
    TextureOrigin texture_origin = TextureOrigin::bottom_left;  // each mesh stores its own
    UpAxis up = UpAxis::z;                                      // which nobody asks for
  } surface_;                                                   // of all meshes
};

void Packing::read_nodes(std::span<const RefineObject> objects) {
  CellMeshMaker maker(file_, objects);
  const CellTree& tree = file_.tree();
  nodes_.assign(tree.nodes().begin(), tree.nodes().end());
  additions_.reserve(nodes_.size());
  std::vector<CellId> path;
  std::vector<const CellAdditions*> above;
  for (CellId n = 0; n < nodes_.size(); ++n) {
    tell(read_share * n / static_cast<double>(nodes_.size()));
    tree.path_to(n, path);
    above.clear();
    for (const CellId node : path)
      if (node != n) above.push_back(&additions_[node]);
    additions_.push_back(file_.read(n, above));
    if (tree.is_leaf(n)) continue;
    above.push_back(&additions_.back());
    nodes_[n].error_px =
        std::nextafter(static_cast<float>(maker.error_px(n, above)), std::numeric_limits<float>::infinity());
  }
}

// Returns, by node and then object, the ids of splits in the global numbering of all meshes.
std::vector<std::vector<std::uint32_t>> Packing::added_splits() const {
  std::vector<std::vector<std::uint32_t>> added;
  for (const CellAdditions& node : additions_)
    for (const ObjectAdditions& object : node.objects) {
      std::vector<std::uint32_t>& splits = added.emplace_back(object.splits);
      for (std::uint32_t& split : splits) split += first_split_[mesh_of_[object.object]];
    }
  return added;
}

// Objects of one mesh share one numbering. places_by_nodes() sees each pair of a node and an object as a node. Its
// guarantee still holds, because a split on which another depends is applied to each object to which the other is
// applied.
void Packing::number_splits() {
  const std::uint32_t count = first_split_.back();
  adders_.assign(count, no_id);
  for (CellId n = static_cast<CellId>(additions_.size()); n-- > 0;)
    for (const ObjectAdditions& object : additions_[n].objects)
      for (const SplitId split : object.splits) adders_[first_split_[mesh_of_[object.object]] + split] = n;
  const std::vector<std::uint32_t> places = places_by_nodes(added_splits(), count);
  order_.resize(count - static_cast<std::size_t>(std::ranges::count(adders_, no_id)));  // unused splits come last
  for (std::uint32_t split = 0; split < count; ++split)
    if (adders_[split] != no_id) order_[places[split]] = split;
  std::vector<std::vector<SplitId>> of_mesh(hierarchies_.size());
  for (const std::uint32_t split : order_) of_mesh[mesh_with(split)].push_back(split - first_split_[mesh_with(split)]);
  for (std::size_t m = 0; m < hierarchies_.size(); ++m) {
    const std::vector<std::uint32_t> differences = differences_of(of_mesh[m]);
    permutation_.insert(permutation_.end(), differences.begin(), differences.end());
    meshes_.push_back(stars_.emplace_back(*hierarchies_[m], std::move(of_mesh[m])).row());
  }
}

void Packing::encode_nodes() {
  for (CellId n = 0; n < nodes_.size(); ++n) {
    Additions additions;
    for (const ObjectAdditions& object : additions_[n].objects) {
      const PackedStars& stars = stars_[mesh_of_[object.object]];
      for (const SplitId split : object.splits)
        additions.splits.push_back(ids_.split(object.object, stars.number_of(split)));
      for (const FaceRef& face : object.hidden) {
        const SplitId split = stars.number_of(face.split);
        if (split == no_id && face.split != no_id) continue;  // not used by any cell
        additions.hidden.push_back(ids_.owner(object.object, split) << 32U | face.slot);
      }
    }
    std::ranges::sort(additions.splits);
    std::ranges::sort(additions.hidden);
    const std::vector<std::byte> bytes = encode(additions, {}, max_packed_ids_per_byte);
    if (bytes.size() > max_payload_bytes)
      throw Error({"cells", fmt::format("cell {}", n), "adds more than 16 MiB", "allow a larger tolerance"});
    CellNode& node = nodes_[n];
    node.payload = payloads_.size();
    node.payload_bytes = static_cast<std::uint32_t>(bytes.size());
    node.checksum = sections::checksum_of(bytes);
    node.hidden_faces = static_cast<std::uint32_t>(additions.hidden.size());
    node.candidates = 0;
    payloads_.insert(payloads_.end(), bytes.begin(), bytes.end());
  }
}

void Packing::make_frames() {
  const std::span<const std::uint32_t> order(order_);
  for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
    tell(read_share + (1.0 - read_share) * static_cast<double>(first) / static_cast<double>(order.size()));
    const auto is_full = [&] {
      const std::size_t count = end - first;
      return count == max_in_frame || (count >= min_in_frame && adders_[order[end]] != adders_[order[end - 1]]);
    };
    while (end < order.size() && !is_full()) ++end;
    add_frame(order.subspan(first, end - first));
  }
}

void Packing::add_frame(std::span<const std::uint32_t> splits) {
  // Splits of one mesh are consecutive in its own numbering, whatever lies between them here.
  const std::size_t first_piece = pieces_.size();
  for (const std::uint32_t split : splits) {
    const std::uint32_t mesh = mesh_with(split);
    const auto own = std::span(pieces_).subspan(first_piece);
    const auto found = std::ranges::find(own, mesh, &PieceRow::mesh);
    if (found != own.end())
      ++found->count;
    else
      pieces_.push_back({mesh, stars_[mesh].number_of(split - first_split_[mesh]), 1});
  }
  const auto pieces = std::span(pieces_).subspan(first_piece);
  GeometryFrame frame;
  for (const PieceRow& piece : pieces)
    for (std::uint32_t i = 0; i < piece.count; ++i) stars_[piece.mesh].append(piece.first + i, frame);
  const EncodedFrame encoded = encode_frame(frame, pieces, meshes_, level_);
  if (encoded.raw_bytes > max_frame_bytes)
    throw Error({"cells", "", "have splits with millions of faces", "repair the mesh with 'occlod repair'"});
  frames_.push_back({geometry_.size(), sections::checksum_of(encoded.bytes),
                     static_cast<std::uint32_t>(encoded.bytes.size()), encoded.raw_bytes,
                     static_cast<std::uint32_t>(first_piece), static_cast<std::uint32_t>(pieces.size())});
  geometry_.insert(geometry_.end(), encoded.bytes.begin(), encoded.bytes.end());
}

void Packing::add_base_meshes() {
  for (const PackedStars& stars : stars_) {
    add_base_mesh(stars);
    if (has_looks()) add_materials(stars.hierarchy().data());
  }
}

void Packing::add_base_mesh(const PackedStars& stars) {
  const HierarchyView& data = stars.hierarchy().data();
  for (VertexId v = 0; v < stars.hierarchy().base_vertex_count(); ++v) {
    base_positions_.push_back(data.positions[v]);
    std::uint32_t extra = 0;
    stars.for_each_wedge(v, [&](WedgeId w) {
      extra += w == v ? 0 : 1;
      if (!data.normals.empty()) base_normals_.push_back(data.normals[w]);
      if (!data.colors.empty()) base_colors_.push_back(data.colors[w]);
      if (!data.texture_coordinates.empty()) base_coordinates_.push_back(data.texture_coordinates[w]);
      if (!data.wedge_materials.empty()) base_materials_.push_back(data.wedge_materials[w]);
    });
    if (stars.hierarchy().has_seams()) base_wedges_.push_back(extra);
  }
  base_faces_.insert(base_faces_.end(), data.base_faces.begin(), data.base_faces.end());
  for (const Triangle& wedges : data.base_corners) base_corners_.push_back(stars.corners(wedges));
}

void Packing::add_materials(const HierarchyView& data) {
  looks_.push_back({static_cast<std::uint32_t>(data.materials.size()), static_cast<std::uint32_t>(data.textures.size()),
                    static_cast<std::uint32_t>(data.texture_origin), 0});
  surface_.materials.insert(surface_.materials.end(), data.materials.begin(), data.materials.end());
  surface_.textures.insert(surface_.textures.end(), data.textures.begin(), data.textures.end());
}

void Packing::write(const std::filesystem::path& path) const {
  using namespace sections;
  const Scene scene{file_.options(), {file_.objects().begin(), file_.objects().end()}};
  const StoredOptions options = store(scene);
  const Codec codec = level_ == 0 ? Codec::stored : Codec::zstd;
  SectionWriter writer;
  MaterialSections materials;
  writer.add(options_name, std::span<const StoredOptions>(&options, 1));
  writer.add(regions_name, std::span<const CellBox>(scene.options.regions));
  writer.add(objects_name, std::span<const StoredObject>(scene.objects));
  writer.add(nodes_name, std::span<const CellNode>(nodes_));
  writer.add(meshes_name, std::span<const MeshRow>(meshes_));
  writer.add(base_positions_name, std::span<const glm::vec3>(base_positions_), Check::whole, codec);
  writer.add(base_normals_name, std::span<const glm::vec3>(base_normals_), Check::whole, codec);
  writer.add(base_colors_name, std::span<const glm::u8vec4>(base_colors_), Check::whole, codec);
  writer.add(base_faces_name, std::span<const Triangle>(base_faces_), Check::whole, codec);
  if (has_looks()) {
    writer.add(base_coordinates_name, std::span<const glm::vec2>(base_coordinates_), Check::whole, codec);
    writer.add(base_materials_name, std::span<const MaterialId>(base_materials_), Check::whole, codec);
    writer.add(base_wedges_name, std::span<const std::uint32_t>(base_wedges_), Check::whole, codec);
    writer.add(base_corners_name, std::span<const Triangle>(base_corners_), Check::whole, codec);
    writer.add(looks_name, std::span<const LookRow>(looks_));
    materials.add(surface_, writer, {});
  }
  writer.add(frames_name, std::span<const FrameRow>(frames_));
  writer.add(pieces_name, std::span<const PieceRow>(pieces_));
  writer.add(permutation_name, std::span<const std::uint32_t>(permutation_), Check::whole, codec);
  writer.add(data_name, std::span<const std::byte>(payloads_), Check::parts);
  writer.add(geometry_name, std::span<const std::byte>(geometry_), Check::parts);
  FileKind kind = packed_kind;
  if (!has_looks()) kind.version = packed_vlod_version;
  writer.write(path, kind);
}

}  // namespace

void vlod::pack_cells(const VlodFile& file, std::span<const RefineObject> objects, const std::filesystem::path& path,
                      const std::function<bool(double)>& progress, int level) {
  const Packing packing(file, objects, progress, level);
  packing.write(path);
  if (progress) static_cast<void>(progress(1.0));
}

void pack_cells(const VlodFile& file, std::span<const RefineObject> objects, const std::filesystem::path& path,
                const std::function<bool(double)>& progress) {
  vlod::pack_cells(file, objects, path, progress, pack_level);
}

}  // namespace occlod
