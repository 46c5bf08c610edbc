#include "simplify.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <queue>

#include "change_bound.h"
#include "collapse_rules.h"
#include "occlod/core/error.h"
#include "quadric.h"
#include "star_mesh.h"

namespace occlod {
namespace {

// Of two collapses of equal quadric error the shorter goes first: on flat surface, where every error is zero, this
// keeps triangles well shaped.
constexpr double edge_length_weight = 1e-8;
constexpr std::size_t collapses_between_reports = 8192;

float round_up(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) >= x ? f : std::nextafter(f, std::numeric_limits<float>::infinity());
}

struct Candidate {
  double cost = 0.0;  // mean square error, object units squared; a lower bound until checked
  VertexId v = no_id;
  std::uint32_t stamp = 0;  // of v when this was computed

  // std::priority_queue pops the largest: the cheapest candidate, ties by id.
  bool operator<(const Candidate& other) const { return cost != other.cost ? cost > other.cost : v > other.v; }
};

struct Choice {
  VertexId u = no_id;
  double cost = std::numeric_limits<double>::infinity();
  bool keeps_topology = false;
};

class Simplifier {
 public:
  Simplifier(const TriangleMesh& mesh, const BuildOptions& options)
      : options_(options),
        positions_(mesh.positions),
        mesh_(mesh.triangles, mesh.vertex_count()),
        quadrics_(mesh.vertex_count()),
        stamps_(mesh.vertex_count(), 0),
        face_errors_(mesh.triangle_count(), 0.0) {}

  CollapseSequence run() {
    make_quadrics();
    for (VertexId v = 0; v < positions_.size(); ++v) propose(v);
    while (mesh_.live_face_count() > options_.base_triangles && !queue_.empty()) {
      const Candidate candidate = queue_.top();
      queue_.pop();
      if (candidate.stamp == stamps_[candidate.v]) consider(candidate);
    }
    sequence_.collapses.push_back(
        {no_id, no_id, sequence_.ended.size(), static_cast<FaceId>(mesh_.face_count()), 0.0F, 0.0F});
    sequence_.base = mesh_.live_faces();
    sequence_.faces = mesh_.release_faces();
    return std::move(sequence_);
  }

 private:
  void make_quadrics() {
    for (FaceId f = 0; f < mesh_.face_count(); ++f) {
      const Triangle& t = mesh_.face(f);
      const glm::dvec3 a(positions_[t.x]), b(positions_[t.y]), c(positions_[t.z]);
      const glm::dvec3 cross = glm::cross(b - a, c - a);
      const double twice_area = glm::length(cross);
      if (!(twice_area > 0.0)) continue;
      const glm::dvec3 normal = cross / twice_area;
      Quadric plane;
      plane.add_plane(normal, -glm::dot(normal, a), twice_area);
      plane.weight = twice_area;
      for (int i = 0; i < 3; ++i) {
        quadrics_[t[i]] += plane;
        hold_feature_edge(t[i], t[(i + 1) % 3], normal);
      }
    }
  }

  // A plane through a boundary or non-manifold edge, upright on the face: leaving the line costs.
  void hold_feature_edge(VertexId p, VertexId q, const glm::dvec3& face_normal) {
    if (mesh_.edge_degree(p, q) == 2) return;
    const glm::dvec3 a(positions_[p]);
    const glm::dvec3 edge = glm::dvec3(positions_[q]) - a;
    const double length2 = glm::dot(edge, edge);
    const glm::dvec3 across = glm::cross(edge, face_normal);
    const double length = glm::length(across);
    if (!(length > 0.0)) return;
    const glm::dvec3 normal = across / length;
    Quadric plane;
    plane.add_plane(normal, -glm::dot(normal, a), options_.boundary_weight * length2);
    quadrics_[p] += plane;
    quadrics_[q] += plane;
  }

  [[nodiscard]] double cost(VertexId v, VertexId u) const {
    const glm::dvec3 from(positions_[v]);
    const glm::dvec3 to(positions_[u]);
    const glm::dvec3 edge = to - from;
    return quadrics_[v].mean_square(to) + edge_length_weight * glm::dot(edge, edge);
  }

  // Puts v's cheapest collapse into the queue, unchecked.
  void propose(VertexId v) {
    ++stamps_[v];
    double cheapest = std::numeric_limits<double>::infinity();
    for (const FaceId f : mesh_.star(v)) {
      const OppositeEdge e = opposite_edge(mesh_.face(f), v);
      cheapest = std::min({cheapest, cost(v, e.next), cost(v, e.last)});
    }
    if (cheapest < std::numeric_limits<double>::infinity()) queue_.push({cheapest, v, stamps_[v]});
  }

  // Checks a candidate whose turn has come; makes the collapse, or puts it back where it belongs.
  void consider(const Candidate& candidate) {
    ring_.gather(mesh_, candidate.v);
    const Choice choice = choose();
    if (choice.cost > candidate.cost) {
      queue_.push({choice.cost, candidate.v, candidate.stamp});
      return;
    }
    collapse(choice);
  }

  // The cheapest collapse of the ring's vertex that the rules allow. Where they allow none, the cheapest that breaks
  // the topology, at the price of the square of all that it may take away: a handle, a sliver or a component goes when
  // errors have reached its size.
  [[nodiscard]] Choice choose() {
    const VertexId v = ring_.vertex();
    const auto neighbours = ring_.neighbours();
    Choice best, breaking;
    double extent2 = 0.0;
    for (std::size_t i = 0; i < neighbours.size(); ++i) {
      const VertexId u = neighbours[i];
      const glm::dvec3 edge = glm::dvec3(positions_[u]) - glm::dvec3(positions_[v]);
      extent2 = std::max(extent2, glm::dot(edge, edge));
      const double c = cost(v, u);
      if (c < breaking.cost) breaking = {u, c, false};
      if (c < best.cost && keeps_topology(mesh_, ring_, i) && keeps_orientation(mesh_, positions_, v, u))
        best = {u, c, true};
    }
    if (best.u != no_id) return best;
    breaking.cost = std::max(breaking.cost, 4.0 * extent2);
    return breaking;
  }

  void collapse(const Choice& choice) {
    const VertexId v = ring_.vertex();
    const VertexId u = choice.u;
    double moved = change_bound_(mesh_, positions_, ring_, u);
    double error = std::sqrt(quadrics_[v].mean_square(glm::dvec3(positions_[u])));
    const std::size_t first_ended = sequence_.ended.size();
    const auto first_made = static_cast<FaceId>(mesh_.face_count());
    mesh_.collapse(v, u, sequence_.ended);
    double before = 0.0;
    double extent = 0.0;
    for (std::size_t i = first_ended; i < sequence_.ended.size(); ++i) {
      before = std::max(before, face_errors_[sequence_.ended[i]]);
      extent = std::max(extent, longest_edge(mesh_.face(sequence_.ended[i])));
    }
    if (!choice.keeps_topology) {
      // What ended may have left nothing near it: its own extent is missing.
      moved = extent;
      error = std::max(error, extent);
    }
    const double after = before + moved;
    face_errors_.resize(mesh_.face_count(), after);
    sequence_.collapses.push_back({v, u, first_ended, first_made, round_up(error), round_up(after)});
    quadrics_[u] += quadrics_[v];
    ++stamps_[v];
    // Costs change only where a quadric or the set of neighbours did: u and the ring that it shares.
    for (const VertexId w : ring_.neighbours()) propose(w);
    report_progress();
  }

  [[nodiscard]] double longest_edge(const Triangle& t) const {
    const glm::dvec3 a(positions_[t.x]), b(positions_[t.y]), c(positions_[t.z]);
    return std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  }

  void report_progress() {
    if (!options_.progress || sequence_.collapses.size() % collapses_between_reports != 0) return;
    const double vertices = static_cast<double>(positions_.size());
    if (!options_.progress(static_cast<double>(sequence_.collapses.size()) / vertices))
      throw Error({"build", "", "was cancelled", ""});
  }

  const BuildOptions& options_;
  const std::vector<glm::vec3>& positions_;
  StarMesh mesh_;
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> stamps_;
  std::vector<double> face_errors_;  // distance of each face from the input, object units
  std::priority_queue<Candidate> queue_;
  CollapseSequence sequence_;
  VertexRing ring_;
  ChangeBound change_bound_;
};

}  // namespace

CollapseSequence simplify(const TriangleMesh& mesh, const BuildOptions& options) {
  return Simplifier(mesh, options).run();
}

}  // namespace occlod
