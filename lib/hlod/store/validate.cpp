#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <optional>
#include <random>
#include <utility>

#include "base/arithmetic.h"
#include "hlod/build/within_points.h"
#include "hlod/store/structure.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"
#include "splits/positions.h"
#include "splits/triangle_keys.h"

namespace occlod::hlod {
namespace {

constexpr std::size_t max_violations = 20;

bool holds(const Box& outer, const Box& inner) {
  return glm::all(glm::lessThanEqual(outer.min, inner.min)) && glm::all(glm::lessThanEqual(inner.max, outer.max));
}

bool holds(const Sphere& outer, const glm::vec3& center, float radius) {
  return glm::distance(glm::dvec3(outer.center), glm::dvec3(center)) + static_cast<double>(radius) <=
         static_cast<double>(outer.radius);
}

// Counts a directed edge of the input's boundary.
struct BoundaryEdge {
  PointId from = 0, to = 0;
  std::size_t count = 0;
};

// Returns the directed edges that remain when each is cancelled by its reverse. Sorts `edges`.
std::vector<BoundaryEdge> net_edges(std::vector<std::pair<PointId, PointId>>& edges) {
  const auto undirected = [](const auto& e) {
    return std::pair(std::min(e.first, e.second), std::max(e.first, e.second));
  };
  std::sort(edges.begin(), edges.end(),
            [&](const auto& a, const auto& b) { return std::pair(undirected(a), a) < std::pair(undirected(b), b); });
  std::vector<BoundaryEdge> net;
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    std::size_t forward = 0, backward = 0;
    for (end = begin; end < edges.size() && undirected(edges[end]) == undirected(edges[begin]); ++end)
      ++(edges[end].first < edges[end].second ? forward : backward);
    const auto [low, high] = undirected(edges[begin]);
    if (forward > backward) net.push_back({low, high, forward - backward});
    if (backward > forward) net.push_back({high, low, backward - forward});
  }
  return net;
}

class Validator {
 public:
  Validator(const Hlod& hlod, std::size_t random_fronts)
      : h_(hlod), random_fronts_(random_fronts), points_(point_count()) {}

  std::vector<std::string> run() {
    if (h_.store() != nullptr) h_.require_all();  // throws
    if (const auto problem = check_structure(h_.data())) return {*problem};
    h_.require_all();
    for (NodeId n = 0; n < h_.node_count(); ++n) {
      if (const auto problem = check_mesh(h_.data(), n)) report("node {}: {}", n, *problem);
      if (const auto problem = check_within(h_.data(), n)) report("splits of node {}: {}", n, *problem);
    }
    if (!violations_.empty()) return violations_;
    check_errors();
    identify_points();
    if (!violations_.empty()) return violations_;
    within_.emplace(h_, points_);
    check_levels();
    check_reach();
    if (h_.data().borders == Borders::locked) check_fronts();
    return violations_;
  }

 private:
  // Records where a point went, and the node that merged it. A merged point is in no coarser node.
  struct PointMerge {
    PointId into = no_id;
    NodeId by = no_id;
    friend bool operator==(const PointMerge&, const PointMerge&) = default;
  };

  template <typename... Args>
  void report(fmt::format_string<Args...> format, Args&&... args) {
    if (violations_.size() < max_violations) violations_.push_back(fmt::format(format, std::forward<Args>(args)...));
  }

  [[nodiscard]] std::size_t point_count() const {
    std::size_t count = 0;
    for (const Node& node : h_.data().nodes) count += node.vertices;
    return count;
  }

  // Checks most of invariant 1.
  void check_errors() {
    for (NodeId n = 0; n < h_.node_count(); ++n) {
      const Node& node = h_.node(n);
      float child_error = 0.0F;
      for (const NodeId child : h_.children(n)) {
        const Node& c = h_.node(child);
        child_error = std::max(child_error, c.error);
        if (!(node.error >= c.error && node.guaranteed_error >= c.guaranteed_error))
          report("node {} has a smaller error than its child {}", n, child);
        if (!holds(node.lod_box, c.lod_box)) report("the lod_box of node {} does not hold that of node {}", n, child);
        if (!holds(node.sphere, c.sphere.center, c.sphere.radius))
          report("the sphere of node {} does not hold that of node {}", n, child);
      }
      if (node.child_error != child_error) report("the child_error of node {} is not that of a child", n);
      if (node.level == 0 && (node.error != 0.0F || node.guaranteed_error != 0.0F))
        report("node {} is part of the input, but has an error", n);
      if (!holds(node.lod_box, node.box)) report("the lod_box of node {} does not hold its box", n);
      for (int i = 0; i < 8; ++i)
        if (!holds(node.sphere, corner(node.box, i), 0.0F)) {
          report("the sphere of node {} does not hold its box", n);
          break;
        }
    }
  }

  // Identifies every vertex of every node by its position. Those that have moved are points of their own.
  void identify_points() {
    first_vertex_.reserve(h_.node_count());
    std::size_t vertices = 0;
    for (const Node& node : h_.data().nodes) {
      first_vertex_.push_back(vertices);
      vertices += node.vertices;
    }
    point_of_.resize(vertices);
    for (NodeId n = static_cast<NodeId>(h_.node_count()); n-- > 0;) {  // level 0 first
      const NodeMesh mesh = h_.mesh(n);
      for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        point_of_[first_vertex_[n] + i] = points_.add(mesh.positions[i]);
      }
    }
    merge_of_.resize(points_.positions().size());
    for (const glm::vec3& p : points_.positions()) boxes_.push_back({p, p});
  }

  [[nodiscard]] PointId point(NodeId n, std::size_t vertex) const { return point_of_[first_vertex_[n] + vertex]; }
  // Returns the point to which `parent` merges the vertex.
  [[nodiscard]] PointId image(NodeId n, const NodeMesh& mesh, std::uint16_t vertex, NodeId parent) const {
    return mesh.merged_into[vertex] == stays ? point(n, vertex) : point(parent, mesh.merged_into[vertex]);
  }

  void check_levels() {
    for (const Level& level : h_.data().levels) {
      merges_.clear();
      for (NodeId n = level.first_node; n < level.first_node + level.node_count; ++n)
        if (h_.node(n).level > 0) check_node(n);
      for (const auto& [from, merge] : merges_) boxes_[merge.into] = unite(boxes_[merge.into], boxes_[from]);
    }
  }

  // Checks invariants 2 and 3 and the rest of invariant 1.
  void check_node(NodeId n) {
    inputs_.clear();
    ChainSum input, wanted, found;
    for (const NodeId child : h_.children(n)) add_input(child, n, input, wanted);
    std::sort(inputs_.begin(), inputs_.end());
    for (const PointId p : inputs_)
      if (!holds(h_.node(n).box, boxes_[p]))
        return report("the box of node {} does not hold all that it stands for", n);
    const NodeMesh mesh = h_.mesh(n);
    std::vector<PointId> own(mesh.positions.size());
    for (std::size_t i = 0; i < own.size(); ++i) own[i] = point(n, i);
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
      found.add({own[mesh.indices[i]], own[mesh.indices[i + 1]], own[mesh.indices[i + 2]]});
    if (!(wanted == found)) report("node {} is not what it replaces with all merges applied", n);
    if (h_.has_within(n)) check_splits(n, own, input);
    std::sort(own.begin(), own.end());
    if (h_.data().has_seams)
      own.erase(std::unique(own.begin(), own.end()), own.end());
    else if (std::adjacent_find(own.begin(), own.end()) != own.end())
      report("node {} has a vertex twice", n);
    inputs_.erase(std::unique(inputs_.begin(), inputs_.end()), inputs_.end());
    if (!std::includes(inputs_.begin(), inputs_.end(), own.begin(), own.end()))
      report("node {} has a vertex that none of its children has or slides to", n);
  }

  // Checks invariant 5, without fronts.
  void check_splits(NodeId n, std::span<const PointId> own, const ChainSum& input) {
    if (const auto problem = within_->add(n, own, input)) return report("the splits of node {} {}", n, *problem);
    bool same = true;
    within_->for_each_merge(n, [&](PointId p, PointId into) { same = same && merge_of_[p] == PointMerge{into, n}; });
    if (!same) report("the splits of node {} contradict its merges", n);
  }

  // Adds the triangles of `child` that `parent` replaces, before and after its merges.
  void add_input(NodeId child, NodeId parent, ChainSum& before, ChainSum& after) {
    const NodeMesh mesh = h_.mesh(child);
    for (const Patch& patch : h_.patches(child)) {
      if (patch.parent != parent) continue;
      for (std::uint32_t i = patch.first_index; i < patch.first_index + patch.index_count; i += 3) {
        Triangle kept, moved;
        for (std::uint32_t k = 0; k < 3; ++k) {
          const std::uint16_t vertex = mesh.indices[i + k];
          moved[static_cast<int>(k)] = image(child, mesh, vertex, parent);
          kept[static_cast<int>(k)] = point(child, vertex);
          inputs_.insert(inputs_.end(), {kept[static_cast<int>(k)], moved[static_cast<int>(k)]});
          if (mesh.merged_into[vertex] != stays)
            note_merge(kept[static_cast<int>(k)], {moved[static_cast<int>(k)], parent});
        }
        before.add(kept);
        after.add(moved);
      }
    }
  }

  // Checks a part of invariant 4.
  void note_merge(PointId from, const PointMerge& merge) {
    if (merge_of_[from] == merge) return;
    merges_.emplace_back(from, merge);
    if (merge_of_[from].by != no_id && h_.data().borders == Borders::locked)
      report("nodes {} and {} both merge one vertex", merge_of_[from].by, merge.by);
    merge_of_[from] = merge;
  }

  // Checks invariant 6 by the leaves alone.
  void check_reach() {
    for (NodeId n = h_.data().levels[0].first_node; n < h_.node_count(); ++n) {
      const NodeMesh mesh = h_.mesh(n);
      for (const Patch& patch : h_.patches(n))
        for (std::uint32_t i = patch.first_index; i < patch.first_index + patch.index_count; i += 3) {
          const glm::vec3 corners[] = {mesh.positions[mesh.indices[i]], mesh.positions[mesh.indices[i + 1]],
                                       mesh.positions[mesh.indices[i + 2]]};
          const Box triangle = bounding_box(corners);
          if (holds(h_.node(n).box, triangle) && is_reached(patch.parent, triangle)) continue;
          report("a triangle of node {} is not in the boxes of the nodes that stand for it", n);
          i = patch.first_index + patch.index_count;  // one line per patch
        }
    }
  }

  // Returns whether traversal that takes only nodes whose boxes hold `what` gets to the node. no_id: it begins there.
  [[nodiscard]] bool is_reached(NodeId n, const Box& what) const {
    if (n == no_id) return true;
    if (!holds(h_.node(n).box, what)) return false;
    const std::span<const Patch> patches = h_.patches(n);
    return patches.empty() || std::ranges::any_of(patches, [&](const Patch& p) { return is_reached(p.parent, what); });
  }

  // Checks the rest of invariant 4. In a legal front, each input vertex lies where the coarser unrefined nodes have
  // moved it. The front conforms iff its oriented boundary is that of the input moved in this way. Both are sums of
  // terms that do not change from front to front: one per patch, and the edges of the input's boundary.
  void check_fronts() {
    const std::vector<ChainSum> patches = sum_patches();
    const std::vector<BoundaryEdge> input = input_boundary();
    std::mt19937_64 random(20070308), random_cuts(20060829);  // any fixed seeds
    for (std::size_t i = 0; i < random_fronts_; ++i) {
      const Refined refined = random_front(h_, random);
      check_front(refined, {}, patches, input);
      if (!h_.data().within.empty()) check_front(refined, random_cuts_of(h_, refined, random_cuts), patches, input);
    }
  }

  void check_front(const Refined& refined, const Cuts& cuts, std::span<const ChainSum> patches,
                   std::span<const BoundaryEdge> input) {
    ChainSum found, wanted;
    for_each_drawn(h_, refined, [&](NodeId n, const Patch&, std::size_t place) {
      if (cuts.empty() || cuts[n] == 0) found.add(patches[place]);
    });
    for (NodeId n = 0; n < cuts.size(); ++n)
      if (cuts[n] > 0) found.add(within_->edges(n, cuts[n]));
    for (const BoundaryEdge& edge : input)
      for (std::size_t k = 0; k < edge.count; ++k)
        wanted.add(moved(edge.from, refined, cuts), moved(edge.to, refined, cuts));
    if (!(found == wanted))
      report("a front with {} refined nodes{} is not a conforming mesh", std::count(refined.begin(), refined.end(), 1),
             cuts.empty() ? "" : " and cuts within nodes");
  }

  // Returns where a front has moved p. Each node that merges it must be on a coarser level than the one before; in a
  // damaged file it may not be.
  [[nodiscard]] PointId moved(PointId p, const Refined& refined, const Cuts& cuts) const {
    int level = 0;
    while (merge_of_[p].by != no_id && refined[merge_of_[p].by] == 0 && h_.node(merge_of_[p].by).level > level) {
      const NodeId by = merge_of_[p].by;
      level = h_.node(by).level;
      p = cuts.empty() || cuts[by] == 0 ? merge_of_[p].into : within_->moved(p, by, cuts[by]);
    }
    return p;
  }

  template <typename Visit>
  void for_each_edge_of(NodeId n, const Patch& patch, const Visit& visit) const {
    const NodeMesh mesh = h_.mesh(n);
    for (std::uint32_t i = patch.first_index; i < patch.first_index + patch.index_count; i += 3)
      for_each_edge({point(n, mesh.indices[i]), point(n, mesh.indices[i + 1]), point(n, mesh.indices[i + 2])}, visit);
  }

  [[nodiscard]] std::vector<ChainSum> sum_patches() const {
    std::vector<ChainSum> sums(h_.data().patches.size());
    for (NodeId n = 0; n < h_.node_count(); ++n) {
      std::size_t place = h_.node(n).first_patch;
      for (const Patch& patch : h_.patches(n)) {
        for_each_edge_of(n, patch, [&](PointId from, PointId to) { sums[place].add(from, to); });
        ++place;
      }
    }
    return sums;
  }

  // Cancels edges within each node first, so that few are left to be sorted together.
  [[nodiscard]] std::vector<BoundaryEdge> input_boundary() const {
    std::vector<std::pair<PointId, PointId>> edges, left;
    for (NodeId n = h_.data().levels[0].first_node; n < h_.node_count(); ++n) {
      edges.clear();
      for (const Patch& patch : h_.patches(n))
        for_each_edge_of(n, patch, [&](PointId from, PointId to) { edges.emplace_back(from, to); });
      for (const BoundaryEdge& edge : net_edges(edges)) left.insert(left.end(), edge.count, {edge.from, edge.to});
    }
    return net_edges(left);
  }

  const Hlod& h_;
  std::size_t random_fronts_;
  std::vector<std::string> violations_;
  PositionIds points_;
  std::vector<std::size_t> first_vertex_;  // per node, into point_of_
  std::vector<PointId> point_of_;
  std::vector<PointMerge> merge_of_;                    // per point
  std::vector<Box> boxes_;                              // per point, around all that were merged into it so far
  std::vector<std::pair<PointId, PointMerge>> merges_;  // of the level that is being checked
  std::vector<PointId> inputs_;                         // of the node that is being checked
  std::optional<WithinPoints> within_;                  // set once points are known
};

}  // namespace

std::vector<std::string> validate(const Hlod& hlod, std::size_t random_fronts) {
  return Validator(hlod, random_fronts).run();
}

namespace {

// Does what restores() does, for a mesh that has been rounded.
bool is_level_zero(const Hlod& hlod, const TriangleMesh& mesh) {
  if (hlod.data().input_triangle_count != mesh.triangle_count()) return false;
  WedgeAttributes input{mesh.positions, mesh.normals, mesh.colors, mesh.texture_coordinates, mesh.texture_origin};
  std::vector<CornerKey> restored, given;
  restored.reserve(mesh.triangle_count());
  given.reserve(mesh.triangle_count());
  for (NodeId n = 0; n < hlod.node_count(); ++n) {
    if (hlod.node(n).level > 0) continue;
    hlod.require(n);
    const NodeMesh node = hlod.mesh(n);
    WedgeAttributes attributes{node.positions, node.normals, node.colors, node.texture_coordinates,
                               hlod.data().texture_origin};
    if (!node.positions.empty() && !keep_those_of(input, attributes)) return false;
    for (std::size_t i = 0; i < node.indices.size(); i += 3)
      restored.push_back(corners_of(
          {node.indices[i], node.indices[i + 1], node.indices[i + 2]}, attributes,
          node.materials.empty() || mesh.materials.empty() ? MaterialId{0} : node.materials[node.indices[i]]));
  }
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    given.push_back(corners_of(mesh.wedge_triangles()[t], input, mesh.material_of(t)));
  std::sort(restored.begin(), restored.end());
  std::sort(given.begin(), given.end());
  return restored == given;
}

// Sums a set of triangles, whatever their order.
class TriangleSum final : public TriangleSink {
 public:
  // Moves pieces to this origin, and rounds them to the lattice, if there is one.
  explicit TriangleSum(const glm::dvec3& origin = glm::dvec3(0.0), float lattice_step = 0.0F)
      : origin_(origin), step_(lattice_step) {}

  void add(const Triangle& t, std::span<const glm::vec3> positions) {
    const TriangleKey key = key_of(t, positions);
    std::uint64_t low = 0x9e3779b97f4a7c15ULL, high = 0xc2b2ae3d27d4eb4fULL;
    for (const std::uint32_t bits : key) {
      low = scatter(low + bits);
      high = scatter(high ^ (std::uint64_t{bits} << 17U));
    }
    ++count_;
    low_ += low;
    high_ += high;
  }

  void add(const TriangleMesh& piece) override {
    if (piece.origin != origin_) {
      TriangleMesh moved = piece;
      move_origin(moved, origin_);
      return add(moved);
    }
    positions_ = piece.positions;
    for (glm::vec3& p : positions_) p = round_to_lattice(p, step_);
    for (const Triangle& t : piece.wedge_triangles()) {
      const glm::vec3 &a = positions_[t.x], &b = positions_[t.y], &c = positions_[t.z];
      if (a != b && b != c && c != a) add(t, positions_);
    }
  }

  friend bool operator==(const TriangleSum& a, const TriangleSum& b) {
    return a.count_ == b.count_ && a.low_ == b.low_ && a.high_ == b.high_;
  }

 private:
  glm::dvec3 origin_;
  float step_;
  std::vector<glm::vec3> positions_;  // of a piece
  std::uint64_t count_ = 0, low_ = 0, high_ = 0;
};

}  // namespace

bool restores(const Hlod& hlod, const TriangleMesh& mesh) {
  if (hlod.data().lattice_step > 0.0F || hlod.data().origin != mesh.origin) {
    TriangleMesh rounded = mesh;
    move_origin(rounded, hlod.data().origin);
    round_to_lattice(rounded, hlod.data().lattice_step);
    return is_level_zero(hlod, clean(std::move(rounded), {}, "rounded mesh").mesh);
  }
  return is_level_zero(hlod, mesh);
}

bool restores(const Hlod& hlod, const TriangleSource& source) {
  TriangleSum restored, given(hlod.data().origin, hlod.data().lattice_step);
  for (NodeId n = 0; n < hlod.node_count(); ++n) {
    if (hlod.node(n).level > 0) continue;
    hlod.require(n);
    const NodeMesh mesh = hlod.mesh(n);
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
      restored.add({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]}, mesh.positions);
  }
  source(given);
  return restored == given;
}

}  // namespace occlod::hlod
