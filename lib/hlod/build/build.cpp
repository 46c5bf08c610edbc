#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "base/memory.h"
#include "base/option_checker.h"
#include "base/threads.h"
#include "hlod/build/build_journal.h"
#include "hlod/build/finish_level.h"
#include "hlod/build/group_triangles.h"
#include "hlod/build/level_draft.h"
#include "hlod/build/simplify_nodes.h"
#include "mesh/mesh_report.h"
#include "mesh/stream_mesh.h"
#include "mesh/wedges.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/mesh.h"
#include "splits/attribute_state.h"
#include "splits/build_progress.h"
#include "splits/build_steps.h"
#include "splits/spatial_order.h"
#include "splits/triangle_keys.h"

namespace occlod::hlod {
namespace {

// Collects the pieces that a source gives, and makes one mesh of them in arrays that may be larger than memory.
class PieceCollector final : public TriangleSink {
 public:
  explicit PieceCollector(int threads) : threads_(threads) {}
  // Cleans the piece. Throws Error as TriangleSink says.
  void add(const TriangleMesh& piece) override;
  void add_counts(const MeshReport& of_object) override { add_counts_of_reading(read_, of_object); }
  // Returns the positions of all pieces so far.
  [[nodiscard]] std::span<const glm::vec3> positions() const { return raw_.positions; }
  // Rounds the positions of all pieces to the lattice, and then cleans as clean() does: removes triangles with two
  // corners at one place, and vertices that no other triangle uses. Throws Error when no triangle is left. O(n).
  void round(float lattice_step);
  // Returns the mesh of all pieces with its vertices along a Morton curve; those of one cell are in the order in which
  // triangles first use them. Vertices at one position become one, and equal attributes there one wedge. Uses up what
  // was collected. O(n log n).
  [[nodiscard]] WedgeMesh weld();
  [[nodiscard]] bool has_triangles() const { return !raw_.triangles.empty(); }
  // Returns what was read and what became of it when `mesh`, the result of weld(), was made.
  [[nodiscard]] MeshReport report(const WedgeMesh& mesh) const;

 private:
  class Welder;

  // Appends a piece without extra wedges, whose vertices are in the order in which triangles first use them.
  void append(const TriangleMesh& piece);

  WedgeMesh raw_;  // a vertex per wedge of each piece; `triangles` only
  std::size_t pieces_ = 0;
  MeshReport read_;         // sums of what the source counted
  MeshReport pieces_read_;  // sums of what pieces show
  int threads_;
};

using PositionBits = std::array<std::uint32_t, 3>;

PositionBits bits_of_position(const glm::vec3& p) { return {bits_of(p.x), bits_of(p.y), bits_of(p.z)}; }

// Returns whether any triangle has corners at different positions; clean() would refuse a mesh without one.
bool has_proper_triangle(const TriangleMesh& mesh) {
  return std::ranges::any_of(mesh.wedge_triangles(), [&](const Triangle& t) {
    if (std::max({t.x, t.y, t.z}) >= mesh.positions.size()) return true;  // reported by clean()
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
  // Returns the group of `p`, which is an earlier one if `p` has its position.
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
  std::vector<PositionBits> first_;  // per group
};

void PieceCollector::add(const TriangleMesh& piece) {
  if (piece.triangles.empty()) return;
  if (!has_proper_triangle(piece)) {
    pieces_read_.triangles_read += piece.triangle_count();
    return;
  }
  CleanMesh cleaned = clean(piece, MeshReport{}, fmt::format("piece {}", pieces_), threads_);
  if (pieces_ == 0) raw_.origin = piece.origin;
  move_origin(cleaned.mesh, raw_.origin);
  add_counts_of_reading(pieces_read_, cleaned.report);
  TriangleMesh parted = part_features(std::move(cleaned.mesh));
  TriangleMesh in_order = PieceCutter(arrays_of(parted)).cut(0, parted.triangle_count());
  in_order.materials = std::move(parted.materials);
  in_order.textures = std::move(parted.textures);
  in_order.feature_names = std::move(parted.feature_names);
  append(in_order);
  ++pieces_;
}

void PieceCollector::append(const TriangleMesh& piece) {
  const std::size_t first = raw_.positions.size();
  if (first + piece.wedge_count() >= no_id || raw_.triangles.size() + piece.triangle_count() >= no_id)
    throw Error({fmt::format("piece {}", pieces_), "", "makes 2^32 vertices or triangles of all pieces",
                 "split the mesh into several HLODs"});
  const auto join = [](auto& all, const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
  // Drops arrays that not all pieces have.
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
  if (!piece.triangle_features.empty() || !raw_.wedge_features.empty()) {
    raw_.wedge_features.resize(first, 0);
    join(raw_.wedge_features, wedge_features(piece));
    raw_.wedge_features.resize(raw_.positions.size(), 0);
  }
  if (raw_.feature_names.size() < piece.feature_names.size()) raw_.feature_names = piece.feature_names;
  if (raw_.materials.size() < piece.materials.size()) {
    raw_.materials = piece.materials;
    raw_.textures = piece.textures;
    raw_.texture_origin = piece.texture_origin;
  }
  raw_.up = piece.up;
  for (const Triangle& t : piece.wedge_triangles()) raw_.triangles.push_back(t + static_cast<VertexId>(first));
}

void PieceCollector::round(float lattice_step) {
  for (glm::vec3& p : raw_.positions) p = round_to_lattice(p, lattice_step);
  std::erase_if(raw_.triangles, [&](const Triangle& t) {
    const glm::vec3 &a = raw_.positions[t.x], &b = raw_.positions[t.y], &c = raw_.positions[t.z];
    return a == b || b == c || c == a;
  });
  if (raw_.triangles.empty())
    throw Error({"rounded mesh", "", "has no triangle with three different corners", "quantise with more bits"});
  constexpr VertexId unused = no_id;
  LargeVector<VertexId> place(raw_.positions.size(), unused);
  for (const Triangle& t : raw_.triangles)
    for (int k = 0; k < 3; ++k) place[t[k]] = 0;
  VertexId used = 0;
  for (VertexId& v : place)
    if (v != unused) v = used++;
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
  keep_used(raw_.wedge_features);
  for (Triangle& t : raw_.triangles)
    for (int k = 0; k < 3; ++k) t[k] = place[t[k]];
}

// Numbers the vertices of `raw` anew.
class PieceCollector::Welder {
 public:
  Welder(WedgeMesh raw, unsigned threads) : raw_(std::move(raw)), threads_(threads), wedge_of_(raw_.positions.size()) {
    result_.materials = std::move(raw_.materials);
    result_.textures = std::move(raw_.textures);
    result_.feature_names = std::move(raw_.feature_names);
    result_.texture_origin = raw_.texture_origin;
    result_.origin = raw_.origin;
    result_.up = raw_.up;
  }

  WedgeMesh run() {
    number_wedges();
    const std::size_t vertices = sources_.size();
    number_triangles(vertices);
    for (const auto& [vertex, source] : extras_) {
      result_.extra_wedges.push_back(vertex);
      sources_.push_back(source);
    }
    const auto gather = [&](auto& from, auto& to) {
      // Coarser levels add a third as many wedges and more. With room for them the array is not copied when it grows.
      if (!from.empty()) to.reserve(sources_.size() / 2 * 3);
      to.resize(from.empty() ? 0 : sources_.size());
      for_each_id(to.size(), threads_, [&](std::uint32_t i) { to[i] = from[sources_[i]]; });
      from = {};
    };
    gather(raw_.positions, result_.positions);
    gather(raw_.normals, result_.normals);
    gather(raw_.colors, result_.colors);
    gather(raw_.texture_coordinates, result_.texture_coordinates);
    gather(raw_.wedge_materials, result_.wedge_materials);
    gather(raw_.wedge_features, result_.wedge_features);
    for (std::size_t i = vertices; i < sources_.size(); ++i)  // copied from their vertices, to the bit
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

  // Numbers the vertices of one cell, given in ascending order.
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

  // Numbers the vertices at one position, given in ascending order. Equal ones become a wedge; the first is the
  // vertex's own.
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

  // Holds the bits of normal, colour, texture coordinates, material and feature.
  using Attributes = std::array<std::uint32_t, 8>;
  [[nodiscard]] Attributes attributes_of(VertexId v) const {
    Attributes attributes{};
    for (int k = 0; k < 3 && !raw_.normals.empty(); ++k)
      attributes[static_cast<std::size_t>(k)] = bits_of(raw_.normals[v][k]);
    if (!raw_.colors.empty()) attributes[3] = std::bit_cast<std::uint32_t>(raw_.colors[v]);
    for (int k = 0; k < 2 && !raw_.texture_coordinates.empty(); ++k)
      attributes[static_cast<std::size_t>(4 + k)] = bits_of(raw_.texture_coordinates[v][k]);
    attributes[6] = raw_.material_of(v);
    attributes[7] = raw_.feature_of(v);
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
    VertexId member = no_id, first = no_id;  // `first` is the first with the same attributes
    friend bool operator<(const Kind& a, const Kind& b) {
      return a.attributes != b.attributes ? a.attributes < b.attributes : a.member < b.member;
    }
  };
  static constexpr WedgeId extra_mark = no_id;  // minus 1 and the place of an extra wedge

  WedgeMesh raw_;
  unsigned threads_;
  WedgeMesh result_;
  LargeVector<VertexId> sources_;  // per wedge, its vertex of raw_
  LargeVector<WedgeId> wedge_of_;  // per vertex of raw_
  LargeVector<Extra> extras_;      // by ascending vertex
  PositionGroups groups_;
  std::vector<std::uint32_t> group_of_;
  std::vector<std::pair<std::uint32_t, VertexId>> shared_;
  std::vector<Kind> kinds_;
};

WedgeMesh PieceCollector::weld() {
  const LargeVector<FeatureId>& features = raw_.wedge_features;
  if (std::ranges::adjacent_find(features, std::ranges::not_equal_to{}) == features.end()) {
    raw_.wedge_features = {};
    raw_.feature_names.clear();
  }
  return Welder(std::move(raw_), thread_count(threads_)).run();
}

MeshReport PieceCollector::report(const WedgeMesh& mesh) const {
  MeshReport report = read_.vertices_read > 0 ? read_ : pieces_read_;
  settle_counts(report, mesh.vertex_count(), mesh.triangles.size());
  const auto& extra = mesh.extra_wedges;  // by ascending vertex
  for (std::size_t i = 0; i < extra.size(); ++i) report.seam_vertices += i == 0 || extra[i] != extra[i - 1] ? 1U : 0U;
  count_topology(std::span(mesh.positions).first(mesh.vertex_count()), mesh.triangles, report, threads_);
  return report;
}

constexpr double min_progress = 0.97;  // a level with a larger share of the triangles below it is left out
constexpr double grouped = 0.15, simplified = 0.85;  // shares of the total time

void check_options(const HlodBuildOptions& options) {
  const OptionChecker check("hlod build");
  check.in_range("node_triangles", options.node_triangles, 16, 4096);
  if (options.quantise_bits != 0) check.in_range("quantise_bits", options.quantise_bits, 8, 23);
  check.in_range("threads", options.threads, 0, 1024);
  if (options.grouping == Grouping::shifted && options.borders == Borders::free)
    throw Error({"hlod build", "option borders", "shifted groups need locked borders",
                 "choose nested groups or locked borders"});
}

class Builder {
 public:
  // The options and `journal`, which may be null, must outlive the builder.
  Builder(WedgeMesh mesh, const HlodBuildOptions& options, BuildJournal* journal)
      : mesh_(std::move(mesh)),
        within_(options.within),
        threads_(thread_count(options.threads)),
        progress_(options.progress),
        journal_(journal),
        grouping_(mesh_, options.grouping, hlod_reduction(options.node_triangles), threads_),
        simplifier_(mesh_, options, hlod_reduction(options.node_triangles), threads_, journal) {}

  HlodData run() {
    progress_.reach(0.0);
    const TriangleGroups groups = known_or(mesh_.triangles.size(), [&] { return grouping_.group_input(); });
    levels_.push_back(input_level(mesh_, groups, threads_));
    while (levels_.back().nodes.size() > 1 && add_level()) continue;
    return assemble(mesh_, std::move(levels_), within_, threads_);
  }

 private:
  // Returns whether there may be another level.
  bool add_level() {
    LevelDraft& below = levels_.back();
    const double before = share_of(levels_.size() - 1), after = share_of(levels_.size());
    TriangleGroups groups = known_or(
        below.triangles.size(), [&] { return grouping_.group_level(below, static_cast<unsigned>(levels_.size())); });
    grouping_.finish_level(below, groups);
    const ProgressPart part{progress_, before + grouped * (after - before), after,
                            static_cast<double>(below.triangles.size())};
    part.reach(0);
    LevelDraft level = simplifier_.run(below, std::move(groups), part);
    if (!level.triangles.empty() &&
        static_cast<double>(level.triangles.size()) > min_progress * static_cast<double>(below.triangles.size())) {
      below.parent_of = {};
      return false;
    }
    levels_.push_back(std::move(level));
    return !levels_.back().triangles.empty();
  }

  // Returns the groups that the journal has next for this many triangles, or else those that make() makes.
  template <typename Make>
  TriangleGroups known_or(std::size_t triangles, const Make& make) {
    TriangleGroups groups;
    if (journal_ != nullptr && journal_->take(triangles, groups)) return groups;
    groups = make();
    if (journal_ != nullptr) journal_->append(groups);
    return groups;
  }

  // Returns the share that is done when this many levels above the input are finished: each takes a quarter of the time
  // of the level below.
  static double share_of(std::size_t levels) {
    return simplified * (1.0 - std::pow(0.25, static_cast<double>(levels)));
  }

  WedgeMesh mesh_;
  Within within_;
  unsigned threads_;
  BuildProgress progress_;
  BuildJournal* journal_;
  TriangleGrouping grouping_;
  NodeSimplifier simplifier_;
  std::vector<LevelDraft> levels_;
};

Hlod build(WedgeMesh mesh, float lattice_step, const HlodBuildOptions& options, BuildJournal* journal,
           std::size_t& taken) {
  mesh.lattice_step = lattice_step;
  const LargeMemoryReuse reuse;
  if (journal != nullptr) journal->begin(mesh);
  HlodData data = Builder(std::move(mesh), options, journal).run();
  taken = journal != nullptr ? journal->taken() : 0;
  data.grouping = options.grouping;
  data.borders = options.borders;
  data.node_triangles = options.node_triangles;
  Hlod hlod = make_hlod(std::move(data));
  BuildProgress(options.progress).reach(1.0);
  return hlod;
}

// Opens the journal before the mesh is there, so that one that does not fit is reported at once. Returns null for none.
std::unique_ptr<BuildJournal> open_journal(const HlodBuildOptions& options) {
  return options.journal.empty() ? nullptr : std::make_unique<BuildJournal>(options.journal, options);
}

// Returns the step of the lattice of positions; 0 without one.
float step_of(std::span<const glm::vec3> positions, const HlodBuildOptions& options) {
  return options.quantise_bits == 0 ? 0.0F : lattice_step(bounding_box(positions), options.quantise_bits);
}

}  // namespace

Hlod build_hlod(const TriangleMesh& mesh, const HlodBuildOptions& options) {
  MeshReport report;
  return build_hlod(mesh, options, report);
}

Hlod build_hlod(const TriangleMesh& mesh, const HlodBuildOptions& options, MeshReport& report) {
  std::size_t taken = 0;
  return build_hlod(mesh, options, report, taken);
}

Hlod build_hlod(const TriangleSource& source, const HlodBuildOptions& options, MeshReport& report) {
  std::size_t taken = 0;
  return build_hlod(source, options, report, taken);
}

Hlod build_hlod(const TriangleMesh& mesh, const HlodBuildOptions& options, MeshReport& report, std::size_t& taken) {
  check_options(options);
  const std::unique_ptr<BuildJournal> journal = open_journal(options);
  check_input(mesh);
  check_welded(mesh);
  const unsigned threads = thread_count(options.threads);
  const float step = step_of(mesh.positions, options);
  if (step == 0.0F) return build(to_wedge_mesh(mesh, threads), step, options, journal.get(), taken);
  TriangleMesh rounded = mesh;
  round_to_lattice(rounded, step);
  CleanMesh cleaned = clean(std::move(rounded), {}, "rounded mesh", options.threads);
  report = report_of(report, cleaned);
  return build(to_wedge_mesh(cleaned.mesh, threads), step, options, journal.get(), taken);
}

Hlod build_hlod(const TriangleSource& source, const HlodBuildOptions& options, MeshReport& report, std::size_t& taken) {
  check_options(options);
  const std::unique_ptr<BuildJournal> journal = open_journal(options);
  PieceCollector pieces(options.threads);
  source(pieces);
  if (!pieces.has_triangles())
    throw Error({"hlod build", "", "the source has no triangle with three different corners", "give one at least"});
  const float step = step_of(pieces.positions(), options);
  if (step > 0.0F) pieces.round(step);
  WedgeMesh mesh = pieces.weld();
  report = pieces.report(mesh);
  return build(std::move(mesh), step, options, journal.get(), taken);
}

}  // namespace occlod::hlod
