#include "cells/packed_faces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include "cells/leaf_faces.h"
#include "cells/vlod_format.h"
#include "occlod/base.h"
#include "occlod/vlod_file.h"

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
  std::vector<CellObjectMesh> meshes(file.objects().size());
  PathCut cut;
  for (std::uint32_t i = 0; i < meshes.size(); ++i) {
    cut.gather(i, above, file.tree().is_leaf(cell));
    const VlodObject& object = file.objects()[i];
    const CellView view(file.tree().node(cell).box, file.options().cell.eyes, object.object_to_world);
    faces.draw(i, cut.applied, cut.hidden, object.two_sided != 0 ? nullptr : &view, fmt::format("cell {}", cell),
               meshes[i]);
  }
  return meshes;
}

}  // namespace occlod
