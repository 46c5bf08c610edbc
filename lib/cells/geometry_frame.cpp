#include "cells/geometry_frame.h"

#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <utility>

#include "splits/star_record.h"
#include "mesh/olod_codec.h"
#include "occlod/hierarchy/split_star.h"

namespace occlod::vlod {
namespace {

constexpr std::size_t vector_bytes = sizeof(glm::vec3), word_bytes = sizeof(std::uint32_t);

// Ids become how far they lie before the split or its vertex, modulo 2^32, and back again: neighbours have similar
// ones.
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

// Words of the record that begins here, whatever they hold; more than there are where it does not fit.
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

// What wedges of the pieces have, and where each piece begins. `extra`: as GeometryFrame::extra_wedges.
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

// Of ascending places the steps between them; and back.
std::vector<std::uint32_t> steps_of(std::span<const std::uint32_t> places) {
  std::vector<std::uint32_t> steps;
  for (std::size_t i = 1; i < places.size(); ++i) steps.push_back(places[i] - places[i - 1]);
  return steps;
}
// Nothing where they add up to more than `most`.
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

// So many values, of what is left.
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
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // the only way to fail with room for the worst case
  bytes.resize(size);
  return bytes;
}

// What is behind all else: how many extra wedges and corners each split has, and the corners. False: it does not fit.
bool take_seams(std::span<const std::byte>& raw, GeometryFrame& frame, std::span<const PieceRow> pieces) {
  std::size_t splits = 0;
  for (const PieceRow& piece : pieces) splits += piece.count;
  if (raw.size() / (2 * word_bytes) < splits) return false;
  std::span<const std::byte> counts = raw.last(2 * word_bytes * splits);
  raw = raw.first(raw.size() - counts.size());
  std::vector<std::uint32_t> steps;
  take(counts, splits, steps);
  frame.extra_wedges = places_of(steps, most_frame_bytes);
  take(counts, splits, steps);
  frame.corner_starts = places_of(steps, raw.size() / word_bytes);
  if (frame.extra_wedges.empty() || frame.corner_starts.empty()) return false;
  std::span<const std::byte> corners = raw.last(frame.corner_starts.back() * word_bytes);
  raw = raw.first(raw.size() - corners.size());
  take(corners, frame.corner_starts.back(), frame.corners);
  return true;
}

// Calls visit(split, its number in the frame, its vertex, its mesh) for each.
template <typename Visit>
void for_each_split(std::span<const PieceRow> pieces, std::span<const MeshRow> meshes, const Visit& visit) {
  std::uint32_t place = 0;
  for (const PieceRow& piece : pieces)
    for (std::uint32_t i = 0; i < piece.count; ++i, ++place)
      visit(piece.first + i, place, meshes[piece.mesh].base_vertices + piece.first + i, meshes[piece.mesh]);
}

// Finds where records begin and turns their ids back. Returns what is wrong, or nothing.
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
  // Of the same size it would be taken as not compressed.
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

}  // namespace occlod::vlod
