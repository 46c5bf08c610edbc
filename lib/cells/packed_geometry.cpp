#include "cells/packed_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <system_error>
#include <utility>

#include "mesh/olod_codec.h"
#include "occlod/core/error.h"
#include "cells/vlod_format.h"

namespace occlod::vlod {

using sections::Check;
using sections::SectionReader;

std::vector<std::uint32_t> meshes_of(std::span<const VlodObject> objects) {
  std::vector<std::uint32_t> meshes;
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const auto same = std::ranges::find(objects.first(i), objects[i].hierarchy, &VlodObject::hierarchy);
    const auto earlier = static_cast<std::size_t>(same - objects.begin());
    meshes.push_back(earlier < i ? meshes[earlier] : count++);
  }
  return meshes;
}

PackedGeometry::PackedGeometry(SectionReader& reader, std::span<const VlodObject> objects, const InputFile& file,
                               std::string subject)
    : file_(file), subject_(std::move(subject)), mesh_of_(meshes_of(objects)) {
  take_meshes(reader, objects);
  take_materials(reader);
  take_base(reader);
  take_frames(reader);
}

void PackedGeometry::take_meshes(SectionReader& reader, std::span<const VlodObject> objects) {
  const std::span<const MeshRow> meshes = reader.read<MeshRow>(meshes_name);
  const std::size_t count = mesh_of_.empty() ? 0 : *std::ranges::max_element(mesh_of_) + std::size_t{1};
  if (meshes.size() != count)
    reader.refuse("section MESH", fmt::format("has {} meshes, the objects have {}", meshes.size(), count));
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const MeshRow& mesh = meshes[mesh_of_[i]];
    if (mesh.splits > objects[i].split_count || (std::uint64_t{mesh.base_vertices} + mesh.splits) >> 32U != 0 ||
        (mesh.attributes & ~all_attributes) != 0)
      reader.refuse("section MESH",
                    fmt::format("claims {} splits of {} for object {}", mesh.splits, objects[i].split_count, i));
  }
  meshes_.assign(meshes.begin(), meshes.end());
}

void PackedGeometry::take_materials(SectionReader& reader) {
  if (!reader.has(looks_name)) return;
  const std::span<const LookRow> looks = reader.read<LookRow>(looks_name);
  if (looks.size() != meshes_.size())
    reader.refuse("section LOOK", fmt::format("has {} meshes, not {}", looks.size(), meshes_.size()));
  sections::Materials all = sections::read_materials(reader);
  auto material = all.materials.begin();
  auto texture = all.textures.begin();
  const auto take = [](auto& at, auto end, std::uint32_t count, auto& to) {
    if (count > static_cast<std::size_t>(end - at)) return false;
    to.assign(std::make_move_iterator(at), std::make_move_iterator(at + count));
    at += count;
    return true;
  };
  for (const LookRow& look : looks) {
    sections::Materials& own = materials_.emplace_back();
    own.origin = static_cast<TextureOrigin>(look.texture_origin);
    const auto has_texture = [&](const Material& m) {
      return m.texture == no_texture || m.texture < own.textures.size();
    };
    if (look.texture_origin > static_cast<std::uint32_t>(TextureOrigin::top_left) ||
        !take(material, all.materials.end(), look.materials, own.materials) ||
        !take(texture, all.textures.end(), look.textures, own.textures) ||
        !std::ranges::all_of(own.materials, has_texture))
      reader.refuse("section LOOK", "does not say what materials there are");
  }
}

SurfaceMaterials PackedGeometry::materials(std::uint32_t mesh) const noexcept {
  if (materials_.empty()) return {};
  return {materials_[mesh].materials, materials_[mesh].textures, materials_[mesh].origin};
}

bool PackedGeometry::are_there(std::uint32_t mesh, std::span<const MaterialId> of_wedges) const {
  const std::size_t count = std::max<std::size_t>(materials(mesh).materials.size(), 1);
  return std::ranges::all_of(of_wedges, [count](MaterialId material) { return material < count; });
}

void PackedGeometry::take_base(SectionReader& reader) {
  const auto take = [&](std::string_view name, std::size_t count, auto& values) {
    const auto read = reader.read<typename std::remove_reference_t<decltype(values)>::value_type>(name);
    if (read.size() != count)
      reader.refuse(fmt::format("section {}", name), fmt::format("has {} elements, not {}", read.size(), count));
    values.assign(read.begin(), read.end());
  };
  const bool has_looks = !materials_.empty();
  std::size_t seam_vertices = 0;
  for (const MeshRow& mesh : meshes_) seam_vertices += (mesh.attributes & has_seams) != 0 ? mesh.base_vertices : 0;
  std::vector<std::uint32_t> extra;
  if (has_looks) take(base_wedges_name, seam_vertices, extra);
  if (!has_looks &&
      std::ranges::any_of(meshes_, [](const MeshRow& mesh) { return mesh.attributes >= has_coordinates; }))
    reader.refuse("section MESH", "claims attributes that are not there");
  First next;
  std::size_t at = 0;  // of `extra`
  for (const MeshRow& mesh : meshes_) {
    first_.push_back(next);
    std::uint64_t wedges = mesh.base_vertices;
    if ((mesh.attributes & has_seams) != 0) {
      wedges = 0;
      for (std::uint32_t v = 0; v < mesh.base_vertices; ++v, wedges += std::uint64_t{1} + extra[at++])
        first_wedges_.push_back(static_cast<std::uint32_t>(wedges));
      if (wedges >= no_id) reader.refuse("section BWED", "has more wedges than there can be");
      first_wedges_.push_back(static_cast<std::uint32_t>(wedges));
      next.corner += mesh.base_faces;
    }
    next.wedges = first_wedges_.size();
    next.vertex += mesh.base_vertices;
    next.normal += (mesh.attributes & has_normals) != 0 ? wedges : 0;
    next.color += (mesh.attributes & has_colors) != 0 ? wedges : 0;
    next.coordinate += (mesh.attributes & has_coordinates) != 0 ? wedges : 0;
    next.material += (mesh.attributes & has_materials) != 0 ? wedges : 0;
    next.face += mesh.base_faces;
  }
  first_.push_back(next);
  take(base_positions_name, next.vertex, positions_);
  take(base_normals_name, next.normal, normals_);
  take(base_colors_name, next.color, colors_);
  take(base_faces_name, next.face, faces_);
  if (has_looks) {
    take(base_coordinates_name, next.coordinate, coordinates_);
    take(base_materials_name, next.material, wedge_materials_);
    take(base_corners_name, next.corner, corners_);
  }
  check_base(reader);
}

void PackedGeometry::check_base(SectionReader& reader) const {
  if (!are_finite(positions_) || !are_finite(normals_))
    reader.refuse("section BPOS", "has a vertex that is not finite");
  for (std::uint32_t m = 0; m < meshes_.size(); ++m) {
    const Base base = this->base(m);
    for (std::size_t f = 0; f < base.faces.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        if (base.faces[f][k] >= meshes_[m].base_vertices)
          reader.refuse("section BFAC", "has a face with a corner that is not there");
        if (!base.corners.empty() && base.corners[f][k] > base.extra_count(base.faces[f][k]))
          reader.refuse("section BCOR", "has a corner with a wedge that is not there");
      }
    if (!are_there(m, base.materials)) reader.refuse("section BMAT", "has a material that is not there");
  }
}

void PackedGeometry::take_frames(SectionReader& reader) {
  const std::span<const FrameRow> frames = reader.read<FrameRow>(frames_name);
  const std::span<const PieceRow> rows = reader.read<PieceRow>(pieces_name);
  const std::uint64_t data_bytes = reader.read<std::byte>(geometry_name, Check::parts).size();
  data_ = reader.offset_of(geometry_name);
  frames_.assign(frames.begin(), frames.end());
  rows_.assign(rows.begin(), rows.end());
  pieces_.resize(meshes_.size());
  std::vector<std::uint64_t> next(meshes_.size(), 0);
  std::uint64_t next_row = 0, end = 0;
  for (std::uint32_t f = 0; f < frames_.size(); ++f) {
    const FrameRow& frame = frames_[f];
    const auto refuse = [&](const char* problem) { reader.refuse(fmt::format("frame {}", f), problem); };
    if (frame.bytes > data_bytes - end) refuse("lies outside the file");
    if (frame.offset != end) refuse("does not begin where the one before ends");
    end += frame.bytes;
    if (frame.raw_bytes > most_frame_bytes || !olod::is_plausible(frame.bytes, frame.raw_bytes))
      refuse("claims more than it can hold");
    if (frame.first_piece != next_row || frame.pieces == 0 || frame.pieces > rows_.size() - next_row)
      refuse("has pieces that are not its own");
    next_row += frame.pieces;
    Piece piece;
    piece.frame = f;
    for (const PieceRow& row : pieces_of(frame)) {
      if (row.mesh >= meshes_.size() || row.first != next[row.mesh] || row.count == 0 ||
          row.count > meshes_[row.mesh].splits - row.first || row.count > frame.raw_bytes)
        refuse("has splits that are not in their place");
      next[row.mesh] += row.count;
      piece.row = row;
      pieces_[row.mesh].push_back(piece);
      ++piece.number;
      piece.place += row.count;
    }
  }
  if (end != data_bytes) reader.refuse("section GEOM", "has bytes of no frame");
  if (next_row != rows_.size()) reader.refuse("section PIEC", "has pieces of no frame");
  for (std::size_t m = 0; m < meshes_.size(); ++m)
    if (next[m] != meshes_[m].splits) reader.refuse("section FRAM", "lacks splits");
}

PackedGeometry::Base PackedGeometry::base(std::uint32_t mesh) const noexcept {
  const First &from = first_[mesh], &to = first_[mesh + std::size_t{1}];
  const auto part = [](const auto& values, std::size_t first, std::size_t end) {
    return std::span(values).subspan(first, end - first);
  };
  return {part(positions_, from.vertex, to.vertex),
          part(normals_, from.normal, to.normal),
          part(colors_, from.color, to.color),
          part(coordinates_, from.coordinate, to.coordinate),
          part(wedge_materials_, from.material, to.material),
          part(first_wedges_, from.wedges, to.wedges),
          part(faces_, from.face, to.face),
          part(corners_, from.corner, to.corner)};
}

const PackedGeometry::Piece& PackedGeometry::piece_of(std::uint32_t mesh, SplitId split) const noexcept {
  const std::vector<Piece>& pieces = pieces_[mesh];
  return *(std::ranges::upper_bound(pieces, split, {}, [](const Piece& piece) { return piece.row.first; }) - 1);
}

std::vector<std::shared_ptr<const GeometryFrame>> PackedGeometry::read(std::uint32_t first, std::uint32_t count) const {
  const auto rows = std::span(frames_).subspan(first, count);
  std::vector<std::byte> bytes(rows.back().offset + rows.back().bytes - rows.front().offset);
  try {
    file_.read(bytes, data_ + rows.front().offset);
  } catch (const std::system_error& error) {
    throw Error({subject_, fmt::format("frame {}", first), fmt::format("cannot be read: {}", error.code().message()),
                 "check the disk"});
  }
  std::vector<std::shared_ptr<const GeometryFrame>> frames;
  for (std::uint32_t i = 0; i < count; ++i)
    frames.push_back(decode(first + i, std::span(bytes).subspan(rows[i].offset - rows.front().offset, rows[i].bytes)));
  return frames;
}

std::shared_ptr<const GeometryFrame> PackedGeometry::decode(std::uint32_t frame,
                                                            std::span<const std::byte> bytes) const {
  const FrameRow& row = frames_[frame];
  const std::string place = fmt::format("frame {}", frame);
  if (sections::checksum_of(bytes) != row.checksum)
    throw Error({subject_, place, "is damaged: its checksum is wrong", packed_kind.rebuild});
  std::string problem;
  auto decoded = decode_frame(bytes, row.raw_bytes, pieces_of(row), meshes_, problem);
  for (std::uint32_t p = 0; decoded && p < row.pieces; ++p) {
    const std::uint32_t mesh = pieces_of(row)[p].mesh;
    if ((meshes_[mesh].attributes & has_materials) == 0) continue;
    const auto next = p + 1 < row.pieces ? decoded->pieces[p + 1].material : decoded->materials.size();
    const auto first = decoded->pieces[p].material;
    if (are_there(mesh, std::span(decoded->materials).subspan(first, next - first))) continue;
    problem = "has a material that is not there";
    decoded.reset();
  }
  if (!decoded) throw Error({subject_, place, problem, packed_kind.rebuild});
  return std::make_shared<const GeometryFrame>(std::move(*decoded));
}

std::size_t PackedGeometry::bytes() const noexcept {
  std::size_t bytes = (positions_.size() + normals_.size()) * sizeof(glm::vec3) + colors_.size() * sizeof(glm::u8vec4) +
                      coordinates_.size() * sizeof(glm::vec2) + wedge_materials_.size() * sizeof(MaterialId) +
                      first_wedges_.size() * sizeof(std::uint32_t) +
                      (faces_.size() + corners_.size()) * sizeof(Triangle) + frames_.size() * sizeof(FrameRow) +
                      rows_.size() * sizeof(PieceRow);
  for (const std::vector<Piece>& pieces : pieces_) bytes += pieces.size() * sizeof(Piece);
  for (const sections::Materials& materials : materials_)
    for (const Texture& texture : materials.textures) bytes += texture.bytes.size();
  return bytes;
}

}  // namespace occlod::vlod
