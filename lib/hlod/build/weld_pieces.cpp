#include "hlod/build/weld_pieces.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "splits/attribute_state.h"
#include "splits/morton_grid.h"
#include "splits/parallel.h"
#include "splits/spatial_order.h"
#include "splits/triangle_key.h"
#include "occlod/core/error.h"
#include "occlod/mesh/clean.h"
#include "occlod/mesh/quantise.h"

namespace occlod::hlod {
namespace {

using PositionBits = std::array<std::uint32_t, 3>;

PositionBits bits_of_position(const glm::vec3& p) { return {bits_of(p.x), bits_of(p.y), bits_of(p.z)}; }

// All at one position vanish; clean() would refuse a mesh of nothing else.
bool has_proper_triangle(const TriangleMesh& mesh) {
  return std::ranges::any_of(mesh.wedge_triangles(), [&](const Triangle& t) {
    if (std::max({t.x, t.y, t.z}) >= mesh.positions.size()) return true;  // which clean() tells of
    const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    return a != b && b != c && c != a;
  });
}

// Numbers the members of a small set by their positions, in the order in which they are met.
class PositionGroups {
 public:
  void reset(std::size_t members) {
    slots_.assign(std::bit_ceil(2 * members + 2), no_id);
    first_.clear();
  }
  // `p` may be that of an earlier one.
  std::uint32_t add(const glm::vec3& p) {
    const PositionBits bits = bits_of_position(p);
    std::size_t slot =
        (std::uint64_t{bits[0]} * 0x9e3779b97f4a7c15ULL ^ std::uint64_t{bits[1]} * 0xc2b2ae3d27d4eb4fULL ^
         std::uint64_t{bits[2]} * 0x165667b19e3779f9ULL) >>
        29U;
    for (slot &= slots_.size() - 1; slots_[slot] != no_id; slot = (slot + 1) & (slots_.size() - 1))
      if (first_[slots_[slot]] == bits) return slots_[slot];
    slots_[slot] = static_cast<std::uint32_t>(first_.size());
    first_.push_back(bits);
    return slots_[slot];
  }
  [[nodiscard]] std::size_t count() const { return first_.size(); }

 private:
  std::vector<std::uint32_t> slots_;
  std::vector<PositionBits> first_;  // by group
};

}  // namespace

void PieceCollector::add(const TriangleMesh& piece) {
  if (piece.triangles.empty()) return;
  if (!has_proper_triangle(piece)) {
    report_.triangles_read += piece.triangle_count();
    report_.repeated_index_triangles += piece.triangle_count();
    return;
  }
  const CleanMesh cleaned = clean(piece, MeshReport{}, fmt::format("piece {}", pieces_));
  count(cleaned.report);
  append(cleaned.mesh);
  ++pieces_;
}

void PieceCollector::count(const MeshReport& of_piece) {
  report_.vertices_read += of_piece.vertices_read;
  report_.polygons_read += of_piece.polygons_read;
  report_.triangles_read += of_piece.triangles_read;
  report_.unreferenced_vertices += of_piece.unreferenced_vertices;
  report_.nonfinite_vertices += of_piece.nonfinite_vertices;
  report_.repeated_index_triangles += of_piece.repeated_index_triangles;
  report_.vertices_welded += of_piece.vertices_welded;
  report_.left_out.texture_coordinates += of_piece.left_out.texture_coordinates;
}

void PieceCollector::append(const TriangleMesh& piece) {
  const std::size_t first = raw_.positions.size();
  if (first + piece.wedge_count() >= no_id || raw_.triangles.size() + piece.triangle_count() >= no_id)
    throw Error({fmt::format("piece {}", pieces_), "", "makes 2^32 vertices or triangles of all pieces",
                 "split the mesh into several HLODs"});
  const auto join = [](auto& all, const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
  // What not all pieces have, none has.
  const auto keep = [&](auto& all, const auto& more) {
    if (all.size() == first && !more.empty())
      join(all, more);
    else
      all = {};
  };
  keep(raw_.normals, piece.normals);
  keep(raw_.colors, piece.colors);
  join(raw_.positions, piece.positions);
  if (!piece.texture_coordinates.empty() || !raw_.texture_coordinates.empty()) {
    raw_.texture_coordinates.resize(first, glm::vec2(0.0F));
    join(raw_.texture_coordinates, piece.texture_coordinates);
    raw_.texture_coordinates.resize(raw_.positions.size(), glm::vec2(0.0F));
  }
  if (!piece.triangle_materials.empty() || !raw_.wedge_materials.empty()) {
    raw_.wedge_materials.resize(first, 0);
    if (piece.triangle_materials.empty())
      raw_.wedge_materials.resize(raw_.positions.size(), 0);
    else
      join(raw_.wedge_materials, wedge_materials(piece));
  }
  if (raw_.materials.size() < piece.materials.size()) {
    raw_.materials = piece.materials;
    raw_.textures = piece.textures;
    raw_.texture_origin = piece.texture_origin;
  }
  for (const Triangle& t : piece.wedge_triangles()) raw_.triangles.push_back(t + static_cast<VertexId>(first));
}

void PieceCollector::round(float lattice_step) {
  for (glm::vec3& p : raw_.positions) p = round_to_lattice(p, lattice_step);
  const std::size_t before = raw_.triangles.size();
  std::erase_if(raw_.triangles, [&](const Triangle& t) {
    const glm::vec3 &a = raw_.positions[t.x], &b = raw_.positions[t.y], &c = raw_.positions[t.z];
    return a == b || b == c || c == a;
  });
  report_.repeated_index_triangles += before - raw_.triangles.size();
  if (raw_.triangles.empty())
    throw Error({"rounded mesh", "", "has no triangle with three different corners", "quantise with more bits"});
  constexpr VertexId unused = no_id;
  LargeVector<VertexId> place(raw_.positions.size(), unused);
  for (const Triangle& t : raw_.triangles)
    for (int k = 0; k < 3; ++k) place[t[k]] = 0;
  VertexId used = 0;
  for (VertexId& v : place)
    if (v != unused) v = used++;
  report_.unreferenced_vertices += place.size() - used;
  const auto keep_used = [&](auto& values) {
    if (values.empty()) return;
    for (std::size_t v = 0; v < place.size(); ++v)
      if (place[v] != unused) values[place[v]] = values[v];
    values.resize(used);
  };
  keep_used(raw_.positions);
  keep_used(raw_.normals);
  keep_used(raw_.colors);
  keep_used(raw_.texture_coordinates);
  keep_used(raw_.wedge_materials);
  for (Triangle& t : raw_.triangles)
    for (int k = 0; k < 3; ++k) t[k] = place[t[k]];
}

// Vertices of `raw` are numbered anew.
class PieceCollector::Welder {
 public:
  Welder(WedgeMesh raw, unsigned threads) : raw_(std::move(raw)), threads_(threads), wedge_of_(raw_.positions.size()) {
    result_.materials = std::move(raw_.materials);
    result_.textures = std::move(raw_.textures);
    result_.texture_origin = raw_.texture_origin;
  }

  WedgeMesh run(MeshReport& report) {
    number_wedges();
    const std::size_t vertices = sources_.size();
    report.vertices_welded += raw_.positions.size() - vertices - extras_.size();
    number_triangles(vertices);
    for (const auto& [vertex, source] : extras_) {
      result_.extra_wedges.push_back(vertex);
      sources_.push_back(source);
      if (result_.extra_wedges.size() == 1 || *(result_.extra_wedges.end() - 2) != vertex) ++report.seam_vertices;
    }
    const auto gather = [&](auto& from, auto& to) {
      to.resize(from.empty() ? 0 : sources_.size());
      for_each_id(to.size(), threads_, [&](std::uint32_t i) { to[i] = from[sources_[i]]; });
      from = {};
    };
    gather(raw_.positions, result_.positions);
    gather(raw_.normals, result_.normals);
    gather(raw_.colors, result_.colors);
    gather(raw_.texture_coordinates, result_.texture_coordinates);
    gather(raw_.wedge_materials, result_.wedge_materials);
    for (std::size_t i = vertices; i < sources_.size(); ++i)  // as their vertices have it, to the bit
      result_.positions[i] = glm::vec3(result_.positions[result_.extra_wedges[i - vertices]]);
    return std::move(result_);
  }

 private:
  struct Extra {
    VertexId vertex = no_id, source = no_id;
  };

  void number_wedges() {
    LargeVector<VertexId> order(raw_.positions.size());
    std::iota(order.begin(), order.end(), VertexId{0});
    const MortonCurve curve{bounding_box(raw_.positions), glm::dvec3(0.0), 10};
    sort_spatially(std::span<const glm::vec3>(raw_.positions), curve, order, threads_);
    const MortonGrid grid(curve);
    sources_.reserve(order.size());
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
      const std::uint32_t code = grid.code(raw_.positions[order[begin]]);
      make_room();
      while (end < order.size() && grid.code(raw_.positions[order[end]]) == code) ++end;
      number_cell(std::span<const VertexId>(order).subspan(begin, end - begin));
    }
  }

  // Ascending vertices of one cell.
  void number_cell(std::span<const VertexId> members) {
    groups_.reset(members.size());
    group_of_.clear();
    for (const VertexId v : members) group_of_.push_back(groups_.add(raw_.positions[v]));
    const auto first = static_cast<VertexId>(sources_.size());
    for (std::size_t i = 0, next = 0; i < members.size(); ++i)  // groups are numbered by their first members
      if (group_of_[i] == next) {
        sources_.push_back(members[i]);
        wedge_of_[members[i]] = static_cast<VertexId>(first + next++);
      }
    if (groups_.count() == members.size()) return;
    shared_.clear();
    for (std::size_t i = 0; i < members.size(); ++i) shared_.emplace_back(group_of_[i], members[i]);
    std::sort(shared_.begin(), shared_.end());
    for (std::size_t begin = 0, end = 0; begin < shared_.size(); begin = end) {
      while (end < shared_.size() && shared_[end].first == shared_[begin].first) ++end;
      if (end - begin > 1) number_place(std::span(shared_).subspan(begin, end - begin), first + shared_[begin].first);
    }
  }

  // The vertices of one position, ascending. Equal ones become a wedge; the first is the vertex's own.
  void number_place(std::span<const std::pair<std::uint32_t, VertexId>> members, VertexId vertex) {
    kinds_.clear();
    for (const auto& [group, v] : members) kinds_.push_back({attributes_of(v), v, v});
    std::sort(kinds_.begin(), kinds_.end());
    for (std::size_t i = 1; i < kinds_.size(); ++i)
      if (kinds_[i].attributes == kinds_[i - 1].attributes) kinds_[i].first = kinds_[i - 1].first;
    std::sort(kinds_.begin(), kinds_.end(),
              [](const Kind& a, const Kind& b) { return std::pair(a.first, a.member) < std::pair(b.first, b.member); });
    const VertexId own = kinds_[0].first;
    for (std::size_t i = 0; i < kinds_.size(); ++i) {
      if (kinds_[i].first == own) {
        wedge_of_[kinds_[i].member] = vertex;
        continue;
      }
      if (kinds_[i].first != kinds_[i - 1].first) extras_.push_back({vertex, kinds_[i].first});
      wedge_of_[kinds_[i].member] = extra_mark - static_cast<WedgeId>(extras_.size());
    }
  }

  // Normal, colour, texture coordinates and material, by their bits.
  using Attributes = std::array<std::uint32_t, 7>;
  [[nodiscard]] Attributes attributes_of(VertexId v) const {
    Attributes attributes{};
    for (int k = 0; k < 3 && !raw_.normals.empty(); ++k)
      attributes[static_cast<std::size_t>(k)] = bits_of(raw_.normals[v][k]);
    if (!raw_.colors.empty()) attributes[3] = std::bit_cast<std::uint32_t>(raw_.colors[v]);
    for (int k = 0; k < 2 && !raw_.texture_coordinates.empty(); ++k)
      attributes[static_cast<std::size_t>(4 + k)] = bits_of(raw_.texture_coordinates[v][k]);
    if (!raw_.wedge_materials.empty()) attributes[6] = raw_.wedge_materials[v];
    return attributes;
  }

  void number_triangles(std::size_t vertices) {
    if (vertices + extras_.size() >= extra_mark - extras_.size())
      throw Error({"mesh", "", "has 2^32 vertices or wedges", "split it into several HLODs"});
    const std::size_t count = raw_.triangles.size();
    result_.triangles = std::move(raw_.triangles);
    result_.corners.resize(extras_.empty() ? 0 : count);
    for_each_id(count, threads_, [&](std::uint32_t t) {
      Triangle& triangle = result_.triangles[t];
      for (int k = 0; k < 3; ++k) {
        WedgeId wedge = wedge_of_[triangle[k]];
        triangle[k] = wedge;
        if (wedge >= vertices) {
          const std::size_t extra = extra_mark - wedge - 1;
          triangle[k] = extras_[extra].vertex;
          wedge = static_cast<WedgeId>(vertices + extra);
        }
        if (!extras_.empty()) result_.corners[t][k] = wedge;
      }
    });
  }

  struct Kind {
    Attributes attributes;
    VertexId member = no_id, first = no_id;  // `first`: of those with the same attributes
    friend bool operator<(const Kind& a, const Kind& b) {
      return a.attributes != b.attributes ? a.attributes < b.attributes : a.member < b.member;
    }
  };
  static constexpr WedgeId extra_mark = no_id;  // minus the place of an extra wedge and 1

  WedgeMesh raw_;
  unsigned threads_;
  WedgeMesh result_;
  LargeVector<VertexId> sources_;  // by wedge: which vertex of raw_ it is
  LargeVector<WedgeId> wedge_of_;  // by vertex of raw_
  LargeVector<Extra> extras_;      // by ascending vertex
  PositionGroups groups_;
  std::vector<std::uint32_t> group_of_;
  std::vector<std::pair<std::uint32_t, VertexId>> shared_;
  std::vector<Kind> kinds_;
};

WedgeMesh PieceCollector::weld(unsigned threads) { return Welder(std::move(raw_), threads).run(report_); }

}  // namespace occlod::hlod
