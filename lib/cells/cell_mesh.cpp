#include "cells/cell_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <glm/common.hpp>
#include <limits>
#include <utility>

#include "cells/leaf_faces.h"
#include "cells/vlod_format.h"
#include "occlod/base.h"
#include "occlod/vlod_file.h"
#include "refine/screen_error.h"
#include "splits/star.h"

namespace occlod::vlod {

void PackedFaces::draw(std::uint32_t object, std::span<const SplitId> applied, std::span<const FaceRef> hidden,
                       const CellView* view, const std::string& place, CellObjectMesh& out) {
  out.positions.clear();
  out.normals.clear();
  out.colors.clear();
  out.texture_coordinates.clear();
  out.materials.clear();
  out.triangles.clear();
  take_cut(cache_.geometry().mesh_of(object), applied, place);
  remove_faces(applied, hidden, place);
  out_of_others_.clear();
  out_of_.assign(base_.positions.size() + applied.size(), no_id);
  for (std::uint32_t f = 0; f < base_.faces.size(); ++f)
    if (!removed_[f]) put(base_.faces[f], base_.corners.empty() ? Triangle(0) : base_.corners[f], view, place, out);
  for (std::uint32_t rank = 0; rank < applied.size(); ++rank) {
    const SplitStar it = star(rank, applied[rank]);
    for (std::uint32_t slot = 0; slot < it.inserted_count(); ++slot)
      if (!removed_[first_face_[rank] + slot])
        put(it.inserted(slot), vertices_[rank].frame->corners_of(vertices_[rank].place, slot), view, place, out);
  }
  frames_.clear();
}

void PackedFaces::take_cut(std::uint32_t mesh, std::span<const SplitId> applied, const std::string& place) {
  mesh_ = mesh;
  base_ = cache_.geometry().base(mesh);
  runs_.clear();
  for (std::uint32_t rank = 0; rank < applied.size(); ++rank) {
    if (rank > 0 && applied[rank] == applied[rank - 1])
      refuse(place, fmt::format("split {} is there twice", applied[rank]));
    if (runs_.empty() || runs_.back().end != applied[rank]) runs_.push_back({applied[rank], applied[rank], rank});
    ++runs_.back().end;
  }
  take_frames(applied, place);
  first_face_.assign(1, static_cast<std::uint32_t>(base_.faces.size()));
  for (std::uint32_t rank = 0; rank < applied.size(); ++rank)
    first_face_.push_back(first_face_.back() + star(rank, applied[rank]).inserted_count());
}

void PackedFaces::take_frames(std::span<const SplitId> applied, const std::string& place) {
  const PackedGeometry& geometry = cache_.geometry();
  pieces_.clear();
  numbers_.clear();
  std::uint64_t bytes = 0;
  for (const SplitId s : applied) {
    if (!pieces_.empty() && s - pieces_.back()->row.first < pieces_.back()->row.count) continue;
    pieces_.push_back(&geometry.piece_of(mesh_, s));
    numbers_.push_back(pieces_.back()->frame);
    bytes += geometry.frames()[numbers_.back()].raw_bytes;
  }
  if (bytes > max_bytes_)
    throw Error({geometry.subject(), place,
                 fmt::format("needs {} bytes of memory to be put together, which may hold {}", bytes, max_bytes_),
                 "give more"});
  cache_.get(numbers_, frames_, bytes_read_);
  vertices_.clear();
  std::size_t at = 0;
  for (const SplitId s : applied) {
    if (s - pieces_[at]->row.first >= pieces_[at]->row.count) ++at;
    const PackedGeometry::Piece& piece = *pieces_[at];
    const std::uint32_t in_frame = piece.place + (s - piece.row.first);
    vertices_.push_back({frames_[at].get(), in_frame, frames_[at]->first_wedge(in_frame, piece.number, piece.place)});
  }
}

void PackedFaces::remove_faces(std::span<const SplitId> applied, std::span<const FaceRef> hidden,
                               const std::string& place) {
  removed_.assign(first_face_.back(), false);
  for (std::uint32_t rank = 0; rank < applied.size(); ++rank) {
    const SplitStar it = star(rank, applied[rank]);
    for (const SplitId needed : it.dependencies())
      if (rank_of(needed) == no_id)
        refuse(place, fmt::format("split {} needs split {}, which is not there", applied[rank], needed));
    it.for_each_removed_ref([&](const FaceRef& face) { remove(face, place); });
  }
  for (const FaceRef& face : hidden)
    if (face.split == no_id || rank_of(face.split) != no_id) remove(face, place);
}

void PackedFaces::remove(const FaceRef& face, const std::string& place) {
  const std::uint32_t rank = face.split == no_id ? no_id : rank_of(face.split);
  const std::uint32_t first = face.split == no_id ? 0 : first_face_[rank];
  const std::uint32_t end = face.split == no_id ? first_face_[0] : first_face_[rank + std::size_t{1}];
  if (face.slot >= end - first) refuse(place, "a face is hidden or removed that does not exist");
  removed_[first + face.slot] = true;
}

std::uint32_t PackedFaces::rank_of(SplitId s) const noexcept {
  const auto after = std::ranges::upper_bound(runs_, s, {}, &Run::first);
  if (after == runs_.begin()) return no_id;
  const Run& run = *(after - 1);
  return s < run.end ? run.rank + (s - run.first) : no_id;
}

SplitStar PackedFaces::star(std::uint32_t rank, SplitId s) const noexcept {
  const Vertex& vertex = vertices_[rank];
  return {vertex.frame->words.data() + vertex.frame->stars[vertex.place],
          static_cast<VertexId>(base_.positions.size() + s)};
}

std::uint32_t PackedFaces::place_of(VertexId vertex) const noexcept {
  const auto base = static_cast<std::uint32_t>(base_.positions.size());
  if (vertex < base) return vertex;
  const std::uint32_t rank = rank_of(vertex - base);
  return rank == no_id ? no_id : base + rank;
}

const glm::vec3& PackedFaces::position(std::uint32_t place) const noexcept {
  if (place < base_.positions.size()) return base_.positions[place];
  const Vertex& vertex = vertices_[place - base_.positions.size()];
  return vertex.frame->positions[vertex.place];
}

std::uint32_t PackedFaces::extra_count(std::uint32_t place) const noexcept {
  if (place < base_.positions.size()) return base_.extra_count(place);
  const Vertex& vertex = vertices_[place - base_.positions.size()];
  return vertex.frame->extra_count(vertex.place);
}

void PackedFaces::put(const Triangle& t, const Triangle& corners, const CellView* view, const std::string& place,
                      CellObjectMesh& out) {
  Triangle places;
  for (int k = 0; k < 3; ++k) {
    places[k] = place_of(t[k]);
    if (places[k] == no_id) refuse(place, "a face has a corner that is not there");
    if (corners[k] > extra_count(places[k])) refuse(place, "a face has a wedge that is not there");
  }
  if (view != nullptr && view->faces_away(position(places.x), position(places.y), position(places.z))) return;
  for (int k = 0; k < 3; ++k) places[k] = put_wedge(places[k], corners[k], out);
  out.triangles.push_back(places);
}

std::uint32_t PackedFaces::put_wedge(std::uint32_t place, std::uint32_t wedge, CellObjectMesh& out) {
  const std::uint64_t key = std::uint64_t{place} << 32U | wedge;
  std::uint32_t& it = wedge == 0 ? out_of_[place] : out_of_others_.try_emplace(key, no_id).first->second;
  if (it != no_id) return it;
  it = static_cast<std::uint32_t>(out.positions.size());
  out.positions.push_back(position(place));
  const std::uint32_t attributes = cache_.geometry().mesh(mesh_).attributes;
  const auto take = [&](std::uint32_t attribute, const auto& values, std::uint32_t at, auto& to) {
    if ((attributes & attribute) != 0) to.push_back(values[at]);
  };
  if (place < base_.positions.size()) {
    const std::uint32_t at = base_.first_wedge(place) + wedge;
    take(has_normals, base_.normals, at, out.normals);
    take(has_colors, base_.colors, at, out.colors);
    take(has_coordinates, base_.coordinates, at, out.texture_coordinates);
    take(has_materials, base_.materials, at, out.materials);
    return it;
  }
  const Vertex& vertex = vertices_[place - base_.positions.size()];
  const WedgePlace at = vertex.first.after(wedge);
  take(has_normals, vertex.frame->normals, at.normal, out.normals);
  take(has_colors, vertex.frame->colors, at.color, out.colors);
  take(has_coordinates, vertex.frame->coordinates, at.coordinate, out.texture_coordinates);
  take(has_materials, vertex.frame->materials, at.material, out.materials);
  return it;
}

void PackedFaces::refuse(const std::string& place, const std::string& problem) const {
  throw Error({cache_.geometry().subject(), place, problem, packed_kind.rebuild});
}

}  // namespace occlod::vlod

namespace occlod {
namespace {

constexpr std::size_t block_triangles = 512;  // at most

Box box_around(std::span<const Triangle> triangles, std::span<const glm::vec3> positions) {
  Box box{positions[triangles[0].x], positions[triangles[0].x]};
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      box.min = glm::min(box.min, positions[t[k]]);
      box.max = glm::max(box.max, positions[t[k]]);
    }
  return box;
}

int longest_axis(std::span<const PlacedTriangle> triangles) {
  glm::vec3 low = triangles[0].place, high = low;
  for (const PlacedTriangle& t : triangles) {
    low = glm::min(low, t.place);
    high = glm::max(high, t.place);
  }
  const glm::vec3 size = high - low;
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

// Halves ranges at the median of the longest axis until they are small enough, and calls visit(range) for each.
template <typename Visit>
void halve(std::span<PlacedTriangle> triangles, const Visit& visit) {
  if (triangles.size() <= block_triangles) return visit(triangles);
  const int axis = longest_axis(triangles);
  const std::size_t half = triangles.size() / 2;
  std::ranges::nth_element(triangles, triangles.begin() + static_cast<std::ptrdiff_t>(half), {},
                           [&](const PlacedTriangle& t) { return t.place[axis]; });
  halve(triangles.first(half), visit);
  halve(triangles.subspan(half), visit);
}

}  // namespace

CellMeshMaker::CellMeshMaker(const VlodFile& file, std::span<const RefineObject> objects)
    : file_(file), objects_(objects.begin(), objects.end()), faces_(objects) {}

CellMeshMaker::CellMeshMaker(const VlodFile& file, vlod::GeometryCache& cache, std::size_t max_bytes)
    : file_(file),
      objects_(placements(file)),
      faces_(std::span<const RefineObject>()),
      packed_(std::in_place, cache, max_bytes) {}

CellMesh CellMeshMaker::make(CellId cell, std::span<const CellAdditions* const> path) {
  const bool is_leaf = file_.tree().is_leaf(cell), has_error = is_leaf || packed_;
  CellMesh mesh;
  mesh.objects.resize(objects_.size());
  if (has_error) mesh.error_px = file_.tree().node(cell).error_px;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    const CellView view = view_of(cell, i);
    cut_.gather(i, path, is_leaf);
    draw(cell, i, view);
    if (!has_error) mesh.error_px = std::max(mesh.error_px, error_of(i, view));
    append(i, mesh);
  }
  mesh.triangles.shrink_to_fit();
  mesh.blocks.shrink_to_fit();
  mesh.positions.shrink_to_fit();
  mesh.normals.shrink_to_fit();
  mesh.colors.shrink_to_fit();
  mesh.coordinates.shrink_to_fit();
  mesh.materials.shrink_to_fit();
  return mesh;
}

double CellMeshMaker::error_px(CellId cell, std::span<const CellAdditions* const> path) {
  double error = 0.0;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    cut_.gather(i, path, false);
    faces_.set(i, cut_.applied);
    error = std::max(error, error_of(i, view_of(cell, i)));
  }
  return error;
}

CellView CellMeshMaker::view_of(CellId cell, std::uint32_t object) const {
  return {file_.tree().node(cell).box, file_.options().cell.eyes, objects_[object].object_to_world};
}

void CellMeshMaker::draw(CellId cell, std::uint32_t object, const CellView& view) {
  if (packed_) {
    packed_->draw(object, cut_.applied, cut_.hidden, objects_[object].two_sided ? nullptr : &view,
                  fmt::format("cell {}", cell), drawn_);
    return;
  }
  faces_.set(object, cut_.applied);
  faces_.drawn(object, view, cut_.hidden, drawn_.triangles);
}

// The topmost splits of subtrees have their largest errors, so the splits next to the cut determine the error. The cut
// is that of faces_.
double CellMeshMaker::error_of(std::uint32_t object, const CellView& view) const {
  const Hierarchy& hierarchy = *objects_[object].hierarchy;
  double error = 0.0;
  const auto look_at = [&](SplitId s) {
    if (s == no_id || faces_.applies(object, s)) return;
    const float own = errors_of(hierarchy, s, objects_[object].attributes).guaranteed;
    error = std::max(error,
                     static_cast<double>(own) * static_cast<double>(view.largest_scale_px(hierarchy.node(s).sphere)));
  };
  for (const SplitId root : hierarchy.data().roots) look_at(root);
  for (const SplitId s : cut_.applied) {
    look_at(hierarchy.node(s).child_u);
    look_at(hierarchy.node(s).child_v);
  }
  return error;
}

void CellMeshMaker::append(std::uint32_t object, CellMesh& mesh) {
  const auto size = [](const auto& values) { return static_cast<std::uint32_t>(values.size()); };
  const auto add = [&](const auto& from, auto& to) {
    const CellMesh::Object::Part part{size(to), size(from)};
    to.insert(to.end(), from.begin(), from.end());
    return part;
  };
  CellMesh::Object& place = mesh.objects[object];
  place.first_triangle = size(mesh.triangles);
  place.triangles = size(drawn_.triangles);
  place.first_block = size(mesh.blocks);
  if (drawn_.triangles.empty()) return;
  const std::span<const glm::vec3> positions =
      packed_ ? std::span<const glm::vec3>(drawn_.positions) : objects_[object].hierarchy->positions();
  append_blocks(positions, mesh);
  place.blocks = size(mesh.blocks) - place.first_block;
  place.positions = add(drawn_.positions, mesh.positions);
  place.normals = add(drawn_.normals, mesh.normals);
  place.colors = add(drawn_.colors, mesh.colors);
  place.coordinates = add(drawn_.texture_coordinates, mesh.coordinates);
  place.materials = add(drawn_.materials, mesh.materials);
}

// Triangles are moved together with their places, since their vertices are all over the memory.
void CellMeshMaker::append_blocks(std::span<const glm::vec3> positions, CellMesh& mesh) {
  placed_.clear();
  placed_.reserve(drawn_.triangles.size());
  for (const Triangle& t : drawn_.triangles) placed_.push_back({positions[t.x] + positions[t.y] + positions[t.z], t});
  const std::size_t first = mesh.triangles.size();
  halve(placed_, [&](std::span<const PlacedTriangle> block) {
    const std::size_t at = mesh.triangles.size();
    for (const PlacedTriangle& t : block) mesh.triangles.push_back(t.triangle);
    mesh.blocks.push_back({box_around(std::span(mesh.triangles).subspan(at), positions),
                           static_cast<std::uint32_t>(at - first), static_cast<std::uint32_t>(block.size())});
  });
}

std::vector<CellObjectMesh> read_cell(const VlodFile& file, CellId cell) {
  if (!file.is_packed() || file.has_objects())
    throw Error({"read_cell()", "", "is for a packed file that was opened without objects",
                 "pack the file with 'occlod cells pack', or give its objects"});
  std::vector<CellId> path;
  file.tree().path_to(cell, path);
  std::vector<CellAdditions> additions;
  std::vector<const CellAdditions*> above;
  additions.reserve(path.size());
  for (const CellId n : path) above.push_back(&additions.emplace_back(file.read(n, above)));

  constexpr std::size_t most = std::numeric_limits<std::size_t>::max();
  vlod::GeometryCache cache(*file.geometry());
  cache.limit(most);
  vlod::PackedFaces faces(cache, most);
  std::vector<CellObjectMesh> meshes(file.object_count());
  PathCut cut;
  for (std::uint32_t i = 0; i < meshes.size(); ++i) {
    cut.gather(i, above, file.tree().is_leaf(cell));
    const vlod::StoredObject& object = file.objects()[i];
    const CellView view(file.tree().node(cell).box, file.options().cell.eyes, object.object_to_world);
    faces.draw(i, cut.applied, cut.hidden, object.two_sided != 0 ? nullptr : &view, fmt::format("cell {}", cell),
               meshes[i]);
  }
  return meshes;
}

}  // namespace occlod
