#include "viewcells/packed_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "io/olod_codec.h"
#include "occlod/core/error.h"
#include "viewcells/vlod_format.h"

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
        (mesh.attributes & ~(has_normals | has_colors)) != 0)
      reader.refuse("section MESH",
                    fmt::format("claims {} splits of {} for object {}", mesh.splits, objects[i].split_count, i));
  }
  meshes_.assign(meshes.begin(), meshes.end());
}

void PackedGeometry::take_base(SectionReader& reader) {
  First next;
  for (const MeshRow& mesh : meshes_) {
    first_.push_back(next);
    next.vertex += mesh.base_vertices;
    next.normal += (mesh.attributes & has_normals) != 0 ? mesh.base_vertices : 0;
    next.color += (mesh.attributes & has_colors) != 0 ? mesh.base_vertices : 0;
    next.face += mesh.base_faces;
  }
  first_.push_back(next);
  const auto take = [&](std::string_view name, std::size_t count, auto& values) {
    const auto read = reader.read<typename std::remove_reference_t<decltype(values)>::value_type>(name);
    if (read.size() != count)
      reader.refuse(fmt::format("section {}", name), fmt::format("has {} elements, not {}", read.size(), count));
    values.assign(read.begin(), read.end());
  };
  take(base_positions_name, next.vertex, positions_);
  take(base_normals_name, next.normal, normals_);
  take(base_colors_name, next.color, colors_);
  take(base_faces_name, next.face, faces_);
  if (!are_finite(positions_) || !are_finite(normals_))
    reader.refuse("section BPOS", "has a vertex that is not finite");
  for (std::uint32_t m = 0; m < meshes_.size(); ++m)
    for (const Triangle& t : base(m).faces)
      if (std::max({t.x, t.y, t.z}) >= meshes_[m].base_vertices)
        reader.refuse("section BFAC", "has a face with a corner that is not there");
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
      const std::uint32_t attributes = meshes_[row.mesh].attributes;
      piece.place += row.count;
      piece.normals_place += (attributes & has_normals) != 0 ? row.count : 0;
      piece.colors_place += (attributes & has_colors) != 0 ? row.count : 0;
    }
  }
  if (end != data_bytes) reader.refuse("section GEOM", "has bytes of no frame");
  if (next_row != rows_.size()) reader.refuse("section PIEC", "has pieces of no frame");
  for (std::size_t m = 0; m < meshes_.size(); ++m)
    if (next[m] != meshes_[m].splits) reader.refuse("section FRAM", "lacks splits");
}

PackedGeometry::Base PackedGeometry::base(std::uint32_t mesh) const noexcept {
  const First &from = first_[mesh], &to = first_[mesh + std::size_t{1}];
  return {std::span(positions_).subspan(from.vertex, to.vertex - from.vertex),
          std::span(normals_).subspan(from.normal, to.normal - from.normal),
          std::span(colors_).subspan(from.color, to.color - from.color),
          std::span(faces_).subspan(from.face, to.face - from.face)};
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
  if (!decoded) throw Error({subject_, place, problem, packed_kind.rebuild});
  return std::make_shared<const GeometryFrame>(std::move(*decoded));
}

std::size_t PackedGeometry::bytes() const noexcept {
  std::size_t bytes = (positions_.size() + normals_.size()) * sizeof(glm::vec3) + colors_.size() * sizeof(glm::u8vec4) +
                      faces_.size() * sizeof(Triangle) + frames_.size() * sizeof(FrameRow) +
                      rows_.size() * sizeof(PieceRow);
  for (const std::vector<Piece>& pieces : pieces_) bytes += pieces.size() * sizeof(Piece);
  return bytes;
}

}  // namespace occlod::vlod
