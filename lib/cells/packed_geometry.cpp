#include "cells/packed_geometry.h"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <memory>
#include <new>
#include <system_error>
#include <utility>

#include "cells/vlod_format.h"
#include "mesh/section_file.h"
#include "occlod/base.h"
#include "occlod/hierarchy.h"
#include "splits/star.h"
#include "splits/star_record.h"

namespace occlod::vlod {
namespace {

constexpr std::size_t vector_bytes = sizeof(glm::vec3), word_bytes = sizeof(std::uint32_t);

// Converts ids to their distance before the split or its vertex, modulo 2^32, and back, because neighbours have similar
// distances.
void turn_ids(std::span<std::uint32_t> record, SplitId s, VertexId vertex) {
  const auto vertices = [&](std::size_t first, std::size_t count) {
    for (std::uint32_t& word : record.subspan(first, count)) word = vertex - word;
  };
  const auto splits = [&](std::size_t first, std::size_t count) {
    for (std::uint32_t& word : record.subspan(first, count)) word = s - word;
  };
  const std::uint32_t header = record[0];
  if ((header & SplitStar::other_bit) == 0) {
    const std::size_t ring = header & 0xFFU, needed = (header >> 16U) & 0xFFU;
    vertices(1, ring);
    splits(1 + ring, needed);
    return;
  }
  const std::size_t inserted = record[2], needed = record[3], removed = record[4];
  vertices(1, 1);
  vertices(5, 3 * inserted);
  splits(5 + 3 * inserted, needed);
  for (std::size_t i = 0, at = 5 + 3 * inserted + needed; i < removed; ++i, at += 5) {
    splits(at, 1);
    vertices(at + 2, 3);
  }
}

// Returns the number of words of the record that begins here, whatever its contents; more than available where it does
// not fit.
std::uint64_t length_of(std::span<const std::uint32_t> words) {
  if (words.empty()) return 1;
  if ((words[0] & SplitStar::other_bit) == 0) return SplitStar(words.data(), 0).word_count();
  if (words.size() < 5) return words.size() + 1;
  return std::uint64_t{5} + std::uint64_t{3} * words[2] + words[3] + std::uint64_t{5} * words[4];
}

bool have_seams(std::span<const PieceRow> pieces, std::span<const MeshRow> meshes) {
  return std::ranges::any_of(pieces,
                             [&](const PieceRow& piece) { return (meshes[piece.mesh].attributes & has_seams) != 0; });
}

// Holds the attribute counts of the pieces' wedges, and where each piece begins. `extra`: as
// GeometryFrame::extra_wedges.
struct Counts {
  std::uint64_t splits = 0, normals = 0, colors = 0, coordinates = 0, materials = 0;
  std::vector<WedgePlace> pieces;

  [[nodiscard]] std::uint64_t bytes() const {
    return (splits + normals) * vector_bytes + colors * sizeof(glm::u8vec4) + coordinates * sizeof(glm::vec2) +
           materials * sizeof(MaterialId);
  }
};
Counts count(std::span<const PieceRow> pieces, std::span<const MeshRow> meshes, std::span<const std::uint32_t> extra) {
  Counts counts;
  for (const PieceRow& piece : pieces) {
    const auto place = [](std::uint64_t count) { return static_cast<std::uint32_t>(count); };
    counts.pieces.push_back(
        {place(counts.normals), place(counts.colors), place(counts.coordinates), place(counts.materials)});
    const std::uint32_t attributes = meshes[piece.mesh].attributes;
    const std::uint64_t first = counts.splits;
    counts.splits += piece.count;
    const std::uint64_t wedges = piece.count + (extra.empty() ? 0 : extra[counts.splits] - extra[first]);
    counts.normals += (attributes & has_normals) != 0 ? wedges : 0;
    counts.colors += (attributes & has_colors) != 0 ? wedges : 0;
    counts.coordinates += (attributes & has_coordinates) != 0 ? wedges : 0;
    counts.materials += (attributes & has_materials) != 0 ? wedges : 0;
  }
  return counts;
}

// Converts ascending places to the steps between them.
std::vector<std::uint32_t> steps_of(std::span<const std::uint32_t> places) {
  std::vector<std::uint32_t> steps;
  for (std::size_t i = 1; i < places.size(); ++i) steps.push_back(places[i] - places[i - 1]);
  return steps;
}
// Converts steps to places; returns nothing where they add up to more than `most`.
std::vector<std::uint32_t> places_of(std::span<const std::uint32_t> steps, std::uint64_t most) {
  std::vector<std::uint32_t> places{0};
  std::uint64_t sum = 0;
  for (const std::uint32_t step : steps) {
    if ((sum += step) > most) return {};
    places.push_back(static_cast<std::uint32_t>(sum));
  }
  return places;
}

template <typename T>
void put(std::span<const T> values, std::vector<std::byte>& raw) {
  const auto bytes = std::as_bytes(values);
  const std::size_t before = raw.size();
  raw.resize(before + bytes.size());
  olod::separate(bytes, sizeof(T), std::span(raw).subspan(before));
}

// Takes `count` values from the front of `raw`.
template <typename T>
void take(std::span<const std::byte>& raw, std::size_t count, std::vector<T>& values) {
  values.resize(count);
  olod::join(raw.first(count * sizeof(T)), sizeof(T), std::as_writable_bytes(std::span(values)));
  raw = raw.subspan(count * sizeof(T));
}

std::vector<std::byte> compressed(std::span<const std::byte> raw, int level) {
  std::vector<std::byte> bytes(ZSTD_compressBound(raw.size()));
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(), &ZSTD_freeCCtx);
  if (!context) throw std::bad_alloc();
  const std::size_t size = ZSTD_compressCCtx(context.get(), bytes.data(), bytes.size(), raw.data(), raw.size(), level);
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // the only possible failure with room for the worst case
  bytes.resize(size);
  return bytes;
}

// Takes the last part of a frame: how many extra wedges and corners each split has, and the corners. Returns false when
// the sizes do not match.
bool take_seams(std::span<const std::byte>& raw, GeometryFrame& frame, std::span<const PieceRow> pieces) {
  std::size_t splits = 0;
  for (const PieceRow& piece : pieces) splits += piece.count;
  if (raw.size() / (2 * word_bytes) < splits) return false;
  std::span<const std::byte> counts = raw.last(2 * word_bytes * splits);
  raw = raw.first(raw.size() - counts.size());
  std::vector<std::uint32_t> steps;
  take(counts, splits, steps);
  frame.extra_wedges = places_of(steps, max_frame_bytes);
  take(counts, splits, steps);
  frame.corner_starts = places_of(steps, raw.size() / word_bytes);
  if (frame.extra_wedges.empty() || frame.corner_starts.empty()) return false;
  std::span<const std::byte> corners = raw.last(frame.corner_starts.back() * word_bytes);
  raw = raw.first(raw.size() - corners.size());
  take(corners, frame.corner_starts.back(), frame.corners);
  return true;
}

// Calls visit(split, its number in the frame, its vertex, its mesh) for each split.
template <typename Visit>
void for_each_split(std::span<const PieceRow> pieces, std::span<const MeshRow> meshes, const Visit& visit) {
  std::uint32_t place = 0;
  for (const PieceRow& piece : pieces)
    for (std::uint32_t i = 0; i < piece.count; ++i, ++place)
      visit(piece.first + i, place, meshes[piece.mesh].base_vertices + piece.first + i, meshes[piece.mesh]);
}

// Finds where records begin and restores their ids. Returns a description of the problem, or nothing.
std::string read_stars(GeometryFrame& frame, std::span<const PieceRow> pieces, std::span<const MeshRow> meshes) {
  std::string problem;
  std::size_t at = 0;
  for_each_split(pieces, meshes, [&](SplitId s, std::uint32_t place, VertexId vertex, const MeshRow& mesh) {
    if (!problem.empty()) return;
    const auto rest = std::span(frame.words).subspan(at);
    const std::uint64_t length = length_of(rest);
    if (length > rest.size()) {
      problem = "does not hold the stars that it says";
      return;
    }
    const auto record = rest.first(static_cast<std::size_t>(length));
    turn_ids(record, s, vertex);
    if (const auto wrong = check_star(record, s, vertex, mesh.base_faces)) problem = *wrong;
    frame.stars.push_back(static_cast<std::uint32_t>(at));
    at += record.size();
    if (problem.empty() && !frame.corner_starts.empty()) {
      const std::uint32_t corners = frame.corner_starts[place + 1] - frame.corner_starts[place];
      if (corners != 0 && corners != 3 * std::uint64_t{SplitStar(record.data(), vertex).inserted_count()})
        problem = "has corners that are not those of its faces";
    }
  });
  if (problem.empty() && at != frame.words.size()) problem = "holds more stars than it says";
  return problem;
}

}  // namespace

bool are_finite(std::span<const glm::vec3> vectors) {
  return std::ranges::all_of(
      vectors, [](const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); });
}

EncodedFrame encode_frame(const GeometryFrame& frame, std::span<const PieceRow> pieces, std::span<const MeshRow> meshes,
                          int level) {
  std::vector<std::uint32_t> words = frame.words;
  for_each_split(pieces, meshes, [&](SplitId s, std::uint32_t place, VertexId vertex, const MeshRow&) {
    const auto record = std::span(words).subspan(frame.stars[place]);
    turn_ids(record.first(static_cast<std::size_t>(length_of(record))), s, vertex);
  });
  std::vector<std::byte> raw;
  put(std::span<const std::uint32_t>(words), raw);
  put(std::span<const glm::vec3>(frame.positions), raw);
  put(std::span<const glm::vec3>(frame.normals), raw);
  put(std::span<const glm::u8vec4>(frame.colors), raw);
  put(std::span<const glm::vec2>(frame.coordinates), raw);
  put(std::span<const MaterialId>(frame.materials), raw);
  if (have_seams(pieces, meshes)) {
    put(std::span<const std::uint32_t>(frame.corners), raw);
    put(std::span<const std::uint32_t>(steps_of(frame.extra_wedges)), raw);
    put(std::span<const std::uint32_t>(steps_of(frame.corner_starts)), raw);
  }
  const auto raw_bytes = static_cast<std::uint32_t>(raw.size());
  std::vector<std::byte> bytes = level == 0 ? raw : compressed(raw, level);
  // Bytes of equal size would be read as uncompressed, so store the raw bytes then.
  return {bytes.size() < raw.size() ? std::move(bytes) : std::move(raw), raw_bytes};
}

std::optional<GeometryFrame> decode_frame(std::span<const std::byte> bytes, std::uint32_t raw_bytes,
                                          std::span<const PieceRow> pieces, std::span<const MeshRow> meshes,
                                          std::string& problem) {
  std::vector<std::byte> unpacked;
  std::span<const std::byte> raw = bytes;
  if (bytes.size() != raw_bytes) {
    unpacked.resize(raw_bytes);
    if (ZSTD_decompress(unpacked.data(), unpacked.size(), bytes.data(), bytes.size()) != raw_bytes) {
      problem = "cannot be decompressed";
      return {};
    }
    raw = unpacked;
  }
  GeometryFrame frame;
  if (have_seams(pieces, meshes) && !take_seams(raw, frame, pieces)) {
    problem = "does not hold the seams that it says";
    return {};
  }
  Counts counts = count(pieces, meshes, frame.extra_wedges);
  if (counts.bytes() > raw.size() || (raw.size() - counts.bytes()) % word_bytes != 0) {
    problem = "does not hold the vertices that it says";
    return {};
  }
  take(raw, (raw.size() - static_cast<std::size_t>(counts.bytes())) / word_bytes, frame.words);
  take(raw, counts.splits, frame.positions);
  take(raw, counts.normals, frame.normals);
  take(raw, counts.colors, frame.colors);
  take(raw, counts.coordinates, frame.coordinates);
  take(raw, counts.materials, frame.materials);
  frame.pieces = std::move(counts.pieces);
  frame.stars.reserve(counts.splits);
  problem = read_stars(frame, pieces, meshes);
  if (problem.empty() && (!are_finite(frame.positions) || !are_finite(frame.normals)))
    problem = "has a vertex that is not finite";
  if (!problem.empty()) return {};
  return frame;
}

using sections::Check;
using sections::SectionReader;

std::vector<std::uint32_t> meshes_of(std::span<const StoredObject> objects) {
  std::vector<std::uint32_t> meshes;
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const auto same = std::ranges::find(objects.first(i), objects[i].hierarchy, &StoredObject::hierarchy);
    const auto earlier = static_cast<std::size_t>(same - objects.begin());
    meshes.push_back(earlier < i ? meshes[earlier] : count++);
  }
  return meshes;
}

PackedGeometry::PackedGeometry(SectionReader& reader, std::span<const StoredObject> objects, const InputFile& file,
                               std::string subject)
    : file_(file), subject_(std::move(subject)), mesh_of_(meshes_of(objects)) {
  take_meshes(reader, objects);
  take_materials(reader);
  take_base(reader);
  take_frames(reader);
}

void PackedGeometry::take_meshes(SectionReader& reader, std::span<const StoredObject> objects) {
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
    const auto has_textures = [&](const Material& m) { return m.texture_beyond(own.textures.size()) == no_texture; };
    if (look.texture_origin > static_cast<std::uint32_t>(TextureOrigin::top_left) ||
        !take(material, all.materials.end(), look.materials, own.materials) ||
        !take(texture, all.textures.end(), look.textures, own.textures) ||
        !std::ranges::all_of(own.materials, has_textures))
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
  std::size_t at = 0;  // index in `extra`
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
    if (frame.raw_bytes > max_frame_bytes || !olod::is_plausible(frame.bytes, frame.raw_bytes))
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

namespace {

constexpr std::uint64_t max_at_once = 1U << 20U;  // approximate, in bytes of the file

}  // namespace

void GeometryCache::get(std::span<const std::uint32_t> frames, Frames& out, std::uint64_t& bytes_read) {
  find(frames, out);
  for (std::size_t first = 0, end = 0; first < frames.size(); first = end) {
    end = first + 1;
    if (out[first]) continue;
    std::uint64_t bytes = geometry_.frames()[frames[first]].bytes;
    while (end < frames.size() && !out[end] && frames[end] == frames[end - 1] + 1 && bytes < max_at_once)
      bytes += geometry_.frames()[frames[end++]].bytes;
    read(frames[first], std::span(out).subspan(first, end - first), bytes_read);
  }
}

void GeometryCache::find(std::span<const std::uint32_t> frames, Frames& out) {
  out.assign(frames.size(), nullptr);
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (const auto found = entries_.find(frames[i]); found != entries_.end()) {
      found->second.asked = ++calls_;
      out[i] = found->second.frame;
    }
}

void GeometryCache::read(std::uint32_t first, std::span<std::shared_ptr<const GeometryFrame>> out,
                         std::uint64_t& bytes_read) {
  const auto count = static_cast<std::uint32_t>(out.size());
  std::uint64_t bytes = 0;
  for (const FrameRow& row : geometry_.frames().subspan(first, count)) bytes += row.bytes;
  if (before_read_) before_read_(bytes);
  std::ranges::move(geometry_.read(first, count), out.begin());
  bytes_read += bytes;
  const std::lock_guard lock(mutex_);
  for (std::uint32_t i = 0; i < count; ++i)
    if (out[i]->bytes() <= limit_ && entries_.try_emplace(first + i, Entry{out[i], ++calls_}).second)
      bytes_ += out[i]->bytes();
  shrink();
}

void GeometryCache::limit(std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  limit_ = bytes;
  shrink();
}

std::size_t GeometryCache::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

void GeometryCache::shrink() {
  while (bytes_ > limit_) {
    const auto oldest = std::ranges::min_element(entries_, {}, [](const auto& entry) { return entry.second.asked; });
    bytes_ -= oldest->second.frame->bytes();
    entries_.erase(oldest);
  }
}

}  // namespace occlod::vlod
