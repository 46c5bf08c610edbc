#include "occlod/vlod_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include "base/platform.h"
#include "cells/cell_geometry.h"
#include "cells/leaf_faces.h"
#include "cells/packed_geometry.h"
#include "cells/packed_numbers.h"
#include "cells/vlod_format.h"
#include "cells/vlod_payload.h"
#include "occlod/base.h"
#include "splits/star.h"

namespace occlod {
namespace {

// Limits the depth so that programs may descend by recursion: 32 levels below root cells, 22 above.
constexpr std::uint32_t max_levels = 64;

[[noreturn]] void refuse(const std::string& subject, CellId cell, const char* problem) {
  throw Error({subject, fmt::format("cell {}", cell), problem, "build the cells again with 'occlod cells build'"});
}

bool holds(const CellBox& box, const glm::dvec3& p) { return overlap(box, {p, p}); }

bool is_box(const CellBox& box) {
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(box.min[axis]) || !std::isfinite(box.max[axis]) || box.min[axis] > box.max[axis]) return false;
  return true;
}

// Returns whether two boxes that meet share more than an edge: a piece of a face, where a face has a size.
bool share_face(const CellBox& a, const CellBox& b) {
  int touching = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double common = std::min(a.max[axis], b.max[axis]) - std::max(a.min[axis], b.min[axis]);
    const bool is_flat = a.min[axis] == a.max[axis] || b.min[axis] == b.max[axis];
    if (common < 0.0) return false;
    touching += common == 0.0 && !is_flat ? 1 : 0;
  }
  return touching <= 1;
}

}  // namespace

CellTree::CellTree(std::vector<CellNode> nodes, const std::string& subject) : nodes_(std::move(nodes)) {
  if (nodes_.empty() || nodes_.size() >= no_id) throw Error({subject, "", "has no cells, or too many", ""});
  std::vector<CellId> open;  // from the root to the last node
  for (CellId n = 0; n < nodes_.size(); ++n) {
    const CellNode& node = nodes_[n];
    while (!open.empty() && nodes_[open.back()].end == n) open.pop_back();
    if (node.parent != (open.empty() ? no_id : open.back()) || open.empty() != (n == 0) || node.level != open.size())
      refuse(subject, n, "is not in its place in the tree");
    if (node.level > max_levels) refuse(subject, n, "is too deep in the tree");
    if (node.end <= n || node.end > (open.empty() ? nodes_.size() : nodes_[open.back()].end))
      refuse(subject, n, "ends outside the cell above it");
    if (!is_box(node.box)) refuse(subject, n, "has a box that is not finite, or inverted");
    if (!open.empty() && unite(nodes_[open.back()].box, node.box) != nodes_[open.back()].box)
      refuse(subject, n, "reaches out of the cell above it");
    open.push_back(n);
    if (is_leaf(n)) ++leaf_count_;
  }
  if (nodes_.front().end != nodes_.size()) refuse(subject, 0, "does not hold all others");
}

CellId CellTree::leaf_of(const glm::dvec3& eye) const {
  CellId n = 0;
  while (n < nodes_.size() && (!holds(nodes_[n].box, eye) || !is_leaf(n)))
    n = holds(nodes_[n].box, eye) ? n + 1 : nodes_[n].end;
  return n < nodes_.size() ? n : no_id;
}

CellId CellTree::nearest_leaf(const glm::dvec3& eye) const {
  CellId best = no_id;
  double best_distance = std::numeric_limits<double>::infinity();
  for (CellId n = 0; n < nodes_.size();) {
    const double distance = smallest_distance(nodes_[n].box, {eye, eye});
    if (!(distance < best_distance)) {
      n = nodes_[n].end;
      continue;
    }
    if (is_leaf(n)) {
      best = n;
      best_distance = distance;
    }
    ++n;
  }
  return best;
}

void CellTree::leaves_in(const CellBox& box, std::vector<CellId>& out) const {
  out.clear();
  for (CellId n = 0; n < nodes_.size();) {
    if (!overlap(nodes_[n].box, box)) {
      n = nodes_[n].end;
      continue;
    }
    if (is_leaf(n)) out.push_back(n);
    ++n;
  }
}

void CellTree::neighbours(CellId leaf, std::vector<CellId>& out) const {
  leaves_in(nodes_[leaf].box, out);
  std::erase_if(out, [&](CellId n) { return n == leaf || !share_face(nodes_[leaf].box, nodes_[n].box); });
}

void CellTree::path_to(CellId cell, std::vector<CellId>& out) const {
  out.clear();
  for (CellId n = cell; n != no_id; n = nodes_[n].parent) out.push_back(n);
  std::reverse(out.begin(), out.end());
}

CellId CellTree::common_ancestor(CellId a, CellId b) const noexcept {
  while (!(a <= b && b < nodes_[a].end)) a = nodes_[a].parent;
  return a;
}

using namespace vlod;
using sections::SectionReader;

namespace {

// Holds what a node and those above it add for one object.
class PathOfObject {
 public:
  PathOfObject(const ObjectAdditions& own, std::span<const CellAdditions* const> ancestors) : own_(&own) {
    for (const CellAdditions* ancestor : ancestors) {
      const auto& objects = ancestor->objects;
      const auto found =
          std::lower_bound(objects.begin(), objects.end(), own.object,
                           [](const ObjectAdditions& a, std::uint32_t object) { return a.object < object; });
      if (found != objects.end() && found->object == own.object) above_.emplace_back(found->splits);
    }
  }

  [[nodiscard]] bool has_above(SplitId s) const {
    return std::any_of(above_.begin(), above_.end(), [s](std::span<const SplitId> splits) {
      return std::binary_search(splits.begin(), splits.end(), s);
    });
  }
  [[nodiscard]] bool has(SplitId s) const {
    return std::binary_search(own_->splits.begin(), own_->splits.end(), s) || has_above(s);
  }

 private:
  const ObjectAdditions* own_;
  std::vector<std::span<const SplitId>> above_;
};

// Returns a description of the problem, or nothing.
std::string problem_of(const ObjectAdditions& additions, const Hierarchy& hierarchy, const PathOfObject& path) {
  for (const SplitId s : additions.splits) {
    if (path.has_above(s)) return fmt::format("split {} is there twice", s);
    for (const SplitId needed : star_of(hierarchy, s).dependencies())
      if (!path.has(needed)) return fmt::format("split {} needs split {}, which is not there", s, needed);
  }
  for (const FaceRef& face : additions.hidden) {
    const std::size_t faces =
        face.split == no_id ? hierarchy.base_triangle_count() : star_of(hierarchy, face.split).inserted_count();
    if (face.slot >= faces) return "a face is hidden that does not exist";
  }
  return {};
}

// Returns the additions sorted by object.
CellAdditions sorted(const Additions& additions, const GlobalIds& ids) {
  std::map<std::uint32_t, ObjectAdditions> objects;
  for (const std::uint64_t split : additions.splits) {
    const GlobalIds::Place place = ids.place_of_split(split);
    objects[place.object].splits.push_back(place.split);
  }
  for (const std::uint64_t face : additions.hidden) {
    const GlobalIds::Place place = ids.place_of_owner(face >> 32U);
    objects[place.object].hidden.push_back({place.split, static_cast<std::uint32_t>(face)});
  }
  CellAdditions result;
  result.candidates.assign(additions.candidates.begin(), additions.candidates.end());
  for (auto& [object, it] : objects) {
    it.object = object;
    result.objects.push_back(std::move(it));
  }
  return result;
}

}  // namespace

std::size_t CellAdditions::bytes() const noexcept {
  std::size_t bytes = sizeof(*this) + objects.capacity() * sizeof(ObjectAdditions) + candidates.capacity() * 4;
  for (const ObjectAdditions& object : objects)
    bytes += object.splits.capacity() * sizeof(SplitId) + object.hidden.capacity() * sizeof(FaceRef);
  return bytes;
}

class VlodFile::Impl {
 public:
  Impl(const std::filesystem::path& path, bool has_objects)
      : path_(path.string()), file_(open_file(path)), reader_(std::in_place, path, kind_of(*file_), true) {
    // Both may have been opened while one file replaced another.
    sections::FileHeader header;
    file_->read(std::as_writable_bytes(std::span(&header, 1)));
    const sections::FileHeader mapped = reader_->header();
    if (std::memcmp(&header, &mapped, sizeof(header)) != 0)
      reader_->refuse("", "was replaced while it was opened", "open it again");
    version_ = header.version;
    scene_ = read_options(*reader_, path_, key_);
    ids_.emplace(scene_.objects, path_);
    if (reader_->has(geometry_name)) geometry_.emplace(*reader_, scene_.objects, *file_, path_);
    if (geometry_ && has_objects) numbers_.emplace(*reader_, *geometry_, scene_.objects);
    take_nodes();
    reader_.reset();  // also closes the mapping
  }

  void expect(std::span<const RefineObject> objects, std::span<const std::string> names);
  [[nodiscard]] CellAdditions read(CellId cell, std::span<const CellAdditions* const> ancestors) const;

  [[nodiscard]] const CellTree& tree() const noexcept { return *tree_; }
  [[nodiscard]] const CellTreeOptions& options() const noexcept { return scene_.options; }
  [[nodiscard]] std::span<const vlod::StoredObject> objects() const noexcept { return scene_.objects; }
  [[nodiscard]] const Key& key() const noexcept { return key_; }
  [[nodiscard]] std::uint32_t version() const noexcept { return version_; }
  [[nodiscard]] std::uint64_t file_bytes() const noexcept { return file_->size(); }
  [[nodiscard]] const PackedGeometry* geometry() const noexcept { return geometry_ ? &*geometry_ : nullptr; }
  [[nodiscard]] bool has_objects() const noexcept { return !hierarchies_.empty(); }

 private:
  // A file that begins with no known signature is treated as not packed, and rejected as such.
  static const sections::FileKind& kind_of(const InputFile& file) {
    sections::FileHeader header;
    if (file.size() >= sizeof(header)) file.read(std::as_writable_bytes(std::span(&header, 1)));
    const bool is_packed = header.version == packed_vlod_version || header.version == textured_vlod_version;
    return is_packed ? packed_kind : file_kind;
  }

  [[noreturn]] void refuse(CellId cell, const std::string& problem) const {
    throw Error({path_, fmt::format("cell {}", cell), problem, (geometry_ ? packed_kind : file_kind).rebuild});
  }

  void take_nodes() {
    const std::span<const CellNode> nodes = reader_->read<CellNode>(nodes_name);
    std::uint64_t packed_splits = 0;
    for (std::uint32_t i = 0; geometry_ && i < scene_.objects.size(); ++i)
      packed_splits += geometry_->mesh(geometry_->mesh_of(i)).splits;
    tree_.emplace(std::vector<CellNode>(nodes.begin(), nodes.end()), path_);
    const std::uint64_t data_bytes = reader_->read<std::byte>(data_name, sections::Check::parts).size();
    data_ = reader_->offset_of(data_name);
    for (CellId n = 0; n < nodes.size(); ++n) {
      const CellNode& node = nodes[n];
      if (node.payload > data_bytes || node.payload_bytes > data_bytes - node.payload)
        refuse(n, "adds what lies outside the file");
      if (node.payload_bytes > max_payload_bytes) refuse(n, "adds more than 16 MiB");
      if (std::uint64_t{node.splits} + node.candidates + node.hidden_faces >
              std::uint64_t{node.payload_bytes} * (geometry_ ? max_packed_ids_per_byte : max_ids_per_byte) ||
          (geometry_ && node.splits > packed_splits))
        refuse(n, fmt::format("claims {} splits, {} candidates and {} faces", node.splits, node.candidates,
                              node.hidden_faces));
    }
  }

  // Returns whether all splits exist; if hierarchies are given, converts the splits to the hierarchies' numbers.
  [[nodiscard]] bool take_packed(CellAdditions& additions) const;

  std::string path_;
  std::shared_ptr<const InputFile> file_;
  std::uint32_t version_ = 0;
  std::optional<SectionReader> reader_;  // used only while the file is opened
  Key key_{};
  Scene scene_;
  std::optional<GlobalIds> ids_;
  std::optional<CellTree> tree_;
  std::uint64_t data_ = 0;                     // start of the section
  std::optional<PackedGeometry> geometry_;     // of a packed file
  std::optional<PackedNumbers> numbers_;       // of a packed file that was opened with its objects
  std::vector<const Hierarchy*> hierarchies_;  // per object, if it was opened with them
};

void VlodFile::Impl::expect(std::span<const RefineObject> objects, std::span<const std::string> names) {
  constexpr const char* rebuild = "build the cells again with 'occlod cells build'";
  if (objects.size() != scene_.objects.size())
    throw Error({path_, "",
                 fmt::format("its cells are of {} objects, the scene has {}", scene_.objects.size(), objects.size()),
                 rebuild});
  const std::vector<vlod::StoredObject> given = describe(objects);
  for (std::size_t i = 0; i < given.size(); ++i) {
    const vlod::StoredObject &now = given[i], &then = scene_.objects[i];
    const char* const what = now.hierarchy != then.hierarchy || now.split_count != then.split_count ? "has changed"
                             : now.object_to_world != then.object_to_world                          ? "has been moved"
                             : now.two_sided != then.two_sided ? "is now seen from other sides"
                             : now.ignores_attributes != then.ignores_attributes
                                 ? "has had 'attributes' turned on or off"
                                 : nullptr;
    if (what == nullptr) continue;
    const std::string name =
        i < names.size() ? fmt::format("object {} ({})", i, names[i]) : fmt::format("object {}", i);
    throw Error({path_, name, fmt::format("{} since its cells were built", what), rebuild});
  }
  for (const RefineObject& object : objects) hierarchies_.push_back(object.hierarchy);
}

CellAdditions VlodFile::Impl::read(CellId cell, std::span<const CellAdditions* const> ancestors) const {
  const CellNode& node = tree_->node(cell);
  std::vector<std::byte> bytes(node.payload_bytes);
  try {
    file_->read(bytes, data_ + node.payload);
  } catch (const std::system_error& error) {
    throw Error({path_, fmt::format("cell {}", cell), fmt::format("cannot be read: {}", error.code().message()),
                 "check the disk"});
  }
  if (sections::checksum_of(bytes) != node.checksum) refuse(cell, "is damaged: its checksum is wrong");
  std::string problem;
  std::vector<std::uint64_t> known;
  if (!ancestors.empty()) known.assign(ancestors.back()->candidates.begin(), ancestors.back()->candidates.end());
  const auto additions =
      decode(bytes, {ids_->split_count(), ids_->owner_count(), node.splits, node.candidates, node.hidden_faces}, known,
             problem);
  if (!additions) refuse(cell, problem);
  CellAdditions result = sorted(*additions, *ids_);
  if (geometry_ && !take_packed(result)) refuse(cell, "adds a split that is not there");
  if (hierarchies_.empty()) return result;
  for (const ObjectAdditions& object : result.objects) {
    problem = problem_of(object, *hierarchies_[object.object], PathOfObject(object, ancestors));
    if (!problem.empty()) refuse(cell, fmt::format("object {}: {}", object.object, problem));
  }
  return result;
}

bool VlodFile::Impl::take_packed(CellAdditions& additions) const {
  for (ObjectAdditions& object : additions.objects) {
    const std::uint32_t mesh = geometry_->mesh_of(object.object), end = geometry_->mesh(mesh).splits;
    const auto is_there = [end](SplitId s) { return s == no_id || s < end; };
    if (!std::ranges::all_of(object.splits, is_there) || !std::ranges::all_of(object.hidden, is_there, &FaceRef::split))
      return false;
    if (numbers_) numbers_->restore(mesh, object);
  }
  return additions.candidates.empty();
}

VlodFile::VlodFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VlodFile::~VlodFile() = default;

const CellTree& VlodFile::tree() const noexcept { return impl_->tree(); }
const CellTreeOptions& VlodFile::options() const noexcept { return impl_->options(); }
std::size_t VlodFile::object_count() const noexcept { return impl_->objects().size(); }
std::span<const vlod::StoredObject> VlodFile::objects() const noexcept { return impl_->objects(); }
const std::array<std::uint64_t, 2>& VlodFile::key() const noexcept { return impl_->key(); }
std::uint64_t VlodFile::file_bytes() const noexcept { return impl_->file_bytes(); }
bool VlodFile::is_packed() const noexcept { return geometry() != nullptr; }
std::uint32_t VlodFile::version() const noexcept { return impl_->version(); }
SurfaceMaterials VlodFile::materials(std::uint32_t object) const noexcept {
  return is_packed() ? geometry()->materials(geometry()->mesh_of(object)) : SurfaceMaterials{};
}
const vlod::PackedGeometry* VlodFile::geometry() const noexcept { return impl_->geometry(); }
bool VlodFile::has_objects() const noexcept { return impl_->has_objects(); }
PackedCounts VlodFile::packed_counts() const noexcept {
  PackedCounts counts;
  if (!is_packed()) return counts;
  for (const MeshRow& mesh : geometry()->meshes()) counts.splits += mesh.splits;
  for (const FrameRow& frame : geometry()->frames()) {
    counts.bytes += frame.bytes;
    counts.raw_bytes += frame.raw_bytes;
  }
  counts.frames = geometry()->frames().size();
  return counts;
}
CellAdditions VlodFile::read(CellId cell, std::span<const CellAdditions* const> ancestors) const {
  return impl_->read(cell, ancestors);
}

std::shared_ptr<const VlodFile> open_vlod(const std::filesystem::path& path) { return open_vlod(path, {}, {}); }

std::shared_ptr<const VlodFile> open_vlod(const std::filesystem::path& path, std::span<const RefineObject> objects,
                                          std::span<const std::string> names) {
  auto impl = std::make_unique<VlodFile::Impl>(path, !objects.empty());
  if (!objects.empty()) impl->expect(objects, names);
  return std::shared_ptr<const VlodFile>(new VlodFile(std::move(impl)));
}

std::vector<CellObjectCut> read_cell(const VlodFile& file, std::span<const RefineObject> objects, CellId leaf) {
  std::vector<CellId> path;
  file.tree().path_to(leaf, path);
  std::vector<CellAdditions> additions;
  std::vector<const CellAdditions*> ancestors;
  additions.reserve(path.size());
  for (const CellId cell : path) ancestors.push_back(&additions.emplace_back(file.read(cell, ancestors)));

  std::vector<CellObjectCut> cuts(objects.size());
  std::vector<std::vector<FaceRef>> hidden(objects.size());
  for (const CellAdditions& of_node : additions) {
    for (const ObjectAdditions& object : of_node.objects) {
      std::vector<SplitId>& applied = cuts[object.object].applied;
      applied.insert(applied.end(), object.splits.begin(), object.splits.end());
      std::vector<FaceRef>& faces = hidden[object.object];
      faces.insert(faces.end(), object.hidden.begin(), object.hidden.end());
    }
  }
  LeafFaces faces(objects);
  for (std::uint32_t i = 0; i < objects.size(); ++i) {
    std::ranges::sort(cuts[i].applied);
    std::ranges::sort(hidden[i], {}, face_key);
    const CellView view(file.tree().node(leaf).box, file.options().cell.eyes, objects[i].object_to_world);
    faces.set(i, cuts[i].applied);
    faces.drawn(i, view, hidden[i], cuts[i].triangles);
  }
  return cuts;
}

}  // namespace occlod
