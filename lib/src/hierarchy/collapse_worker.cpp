#include "collapse_worker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "occlod/math/bounds.h"

namespace occlod {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
// Of two collapses of equal quadric error the shorter goes first: on flat surface, where every error is zero, this
// keeps triangles well shaped.
constexpr float edge_length_weight = 1e-8F;
constexpr float round_up = 1.0F + 1e-6F;

float inverse_extent(std::span<const glm::vec3> positions) {
  const Box box = bounding_box(positions);
  const glm::dvec3 size = glm::dvec3(box.max) - glm::dvec3(box.min);
  const double extent = std::max({size.x, size.y, size.z});
  return extent > 0.0 ? static_cast<float>(1.0 / extent) : 1.0F;
}

}  // namespace

SimplifyState::SimplifyState(const TriangleMesh& input, double boundary_weight)
    : positions(input.positions),
      unit(inverse_extent(positions)),
      mesh(input.triangles, input.vertex_count()),
      quadrics(input.vertex_count()),
      plain(input.vertex_count(), 0),
      costs(input.vertex_count(), infinity),
      targets(input.vertex_count(), no_id),
      block_of(input.vertex_count(), 0),
      made_by(input.triangle_count(), no_id),
      face_errors(input.triangle_count(), 0.0F) {
  make_quadrics(boundary_weight);
  for (VertexId v = 0; v < input.vertex_count(); ++v) propose(v);
}

void SimplifyState::make_quadrics(double boundary_weight) {
  for (FaceId f = 0; f < mesh.face_count(); ++f) {
    const Triangle& t = mesh.face(f);
    const glm::vec3 a = positions[t.x];
    const glm::vec3 normal = glm::cross((positions[t.y] - a) * unit, (positions[t.z] - a) * unit);
    const float twice_area = glm::length(normal);
    if (!(twice_area > 0.0F)) continue;
    for (int i = 0; i < 3; ++i) {
      quadrics[t[i]].add_plane(normal / twice_area, twice_area);
      quadrics[t[i]].weight += twice_area;
    }
  }
  Fan fan;
  for (VertexId v = 0; v < positions.size(); ++v) {
    plain[v] = fan.gather(mesh, v) ? 1 : 0;
    if (plain[v] == 0) hold_edges(v, boundary_weight);
  }
}

// Planes through the feature edges at v, upright on their faces: leaving the line costs.
void SimplifyState::hold_edges(VertexId v, double boundary_weight) {
  for (const FaceId f : mesh.star(v)) {
    const OppositeEdge e = opposite_edge(mesh.face(f), v);
    const glm::vec3 to_next = (positions[e.next] - positions[v]) * unit,
                    to_last = (positions[e.last] - positions[v]) * unit;
    const glm::vec3 face_normal = glm::cross(to_next, to_last);
    for (const auto& [w, edge] : {std::pair(e.next, to_next), std::pair(e.last, to_last)}) {
      if (mesh.edge_degree(v, w) == 2) continue;
      const glm::vec3 across = glm::cross(edge, face_normal);
      const float length = glm::length(across);
      if (length > 0.0F)
        quadrics[v].add_plane(across / length, static_cast<float>(boundary_weight) * glm::dot(edge, edge));
    }
  }
}

float SimplifyState::cost(VertexId v, VertexId u) const {
  const glm::vec3 edge = (positions[u] - positions[v]) * unit;
  return quadrics[v].mean_square(edge) + edge_length_weight * glm::dot(edge, edge);
}

void SimplifyState::propose(VertexId v) {
  float cheapest = infinity;
  VertexId target = no_id;
  const auto look_at = [&](VertexId u) {
    const float c = cost(v, u);
    if (c < cheapest) {
      cheapest = c;
      target = u;
    }
  };
  // Around a closed fan every neighbour comes next once.
  for (const FaceId f : mesh.star(v)) {
    const OppositeEdge e = opposite_edge(mesh.face(f), v);
    look_at(e.next);
    if (plain[v] == 0) look_at(e.last);
  }
  costs[v] = cheapest;
  targets[v] = target;
}

void CollapseWorker::run(const Block& block, BlockRecord& record) {
  block_ = &block;
  record_ = &record;
  heap_.clear();
  for (const VertexId v : block.vertices)
    if (state_.costs[v] <= block.threshold) heap_.push_back({state_.costs[v], v});
  std::make_heap(heap_.begin(), heap_.end());
  while (!heap_.empty() && record.faces_gone < block.stop_after) {
    std::pop_heap(heap_.begin(), heap_.end());
    const Candidate candidate = heap_.back();
    heap_.pop_back();
    // Stale entries are those that no longer say what the vertex does.
    if (candidate.cost == state_.costs[candidate.v]) consider(candidate);
  }
}

void CollapseWorker::push(VertexId v) {
  if (!(state_.costs[v] <= block_->threshold)) return;
  heap_.push_back({state_.costs[v], v});
  std::push_heap(heap_.begin(), heap_.end());
}

// Checks a candidate whose turn has come; makes the collapse, or puts it back where it belongs.
void CollapseWorker::consider(const Candidate& candidate) {
  const VertexId v = candidate.v;
  const bool is_fan = fan_.gather(state_.mesh, v);
  if (!is_fan) ring_.gather(state_.mesh, v);
  const std::span<const VertexId> ring = is_fan ? fan_.ring() : ring_.neighbours();
  if (!in_block(ring)) return;
  const Choice choice = is_fan ? choose_in_fan() : choose_in_ring();
  if (choice.cost > candidate.cost) {
    state_.costs[v] = choice.cost;
    state_.targets[v] = choice.u;
    push(v);
    return;
  }
  collapse(v, choice, ring);
}

bool CollapseWorker::in_block(std::span<const VertexId> vertices) const {
  return std::all_of(vertices.begin(), vertices.end(),
                     [&](VertexId w) { return state_.block_of[w] == block_->number; });
}

// The cheapest collapse that the rules allow. Where they allow none, the cheapest that breaks the topology.
CollapseWorker::Choice CollapseWorker::choose_in_fan() {
  fan_.measure(state_.positions);
  const VertexId v = fan_.vertex();
  std::array<float, Fan::most_neighbours> costs;
  for (std::size_t i = 0; i < fan_.size(); ++i) costs[i] = state_.cost(v, fan_.ring()[i]);
  for (std::size_t tries = 0; tries < fan_.size(); ++tries) {
    const auto i = static_cast<std::size_t>(
        std::min_element(costs.begin(), costs.begin() + static_cast<std::ptrdiff_t>(fan_.size())) - costs.begin());
    if (!(costs[i] < infinity)) break;
    if (fan_.keeps_orientation(i) && fan_.keeps_topology(state_.mesh, i))
      return {fan_.ring()[i], costs[i], fan_.change_bound(i), true};
    costs[i] = infinity;
  }
  return break_topology(fan_.ring(), v);
}

CollapseWorker::Choice CollapseWorker::choose_in_ring() {
  const VertexId v = ring_.vertex();
  const auto neighbours = ring_.neighbours();
  Choice best{no_id, infinity, 0.0F, true};
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    const float c = state_.cost(v, neighbours[i]);
    if (c < best.cost && keeps_topology(state_.mesh, ring_, i) &&
        keeps_orientation(state_.mesh, state_.positions, v, neighbours[i]))
      best = {neighbours[i], c, 0.0F, true};
  }
  if (best.u == no_id) return break_topology(neighbours, v);
  best.moved = static_cast<float>(change_bound_(state_.mesh, state_.positions, ring_, best.u)) * round_up;
  return best;
}

// At the price of the square of all that it may take away: a handle, a sliver or a component goes when errors have
// reached its size.
CollapseWorker::Choice CollapseWorker::break_topology(std::span<const VertexId> neighbours, VertexId v) const {
  Choice cheapest{no_id, infinity, 0.0F, false};
  float extent2 = 0.0F;
  for (const VertexId u : neighbours) {
    const glm::vec3 edge = (state_.positions[u] - state_.positions[v]) * state_.unit;
    extent2 = std::max(extent2, glm::dot(edge, edge));
    const float c = state_.cost(v, u);
    if (c < cheapest.cost) cheapest = {u, c, 0.0F, false};
  }
  cheapest.cost = std::max(cheapest.cost, 4.0F * extent2);
  return cheapest;
}

void CollapseWorker::collapse(VertexId v, const Choice& choice, std::span<const VertexId> ring) {
  const VertexId u = choice.u;
  const auto id = static_cast<CollapseId>(block_->first_id + record_->collapses.size());
  const std::size_t first_ended = record_->ended.size();
  float before = 0.0F;
  float extent = 0.0F;
  const glm::vec3 edge = (state_.positions[u] - state_.positions[v]) * state_.unit;
  float error = std::sqrt(state_.quadrics[v].mean_square(edge)) / state_.unit;
  record_->faces_gone += state_.mesh.collapse(v, u, !choice.keeps_topology, arena_, [&](FaceId f) {
    record_->ended.push_back({state_.mesh.face(f), state_.made_by[f]});
    state_.made_by[f] = id;
    before = std::max(before, state_.face_errors[f]);
    if (!choice.keeps_topology) extent = std::max(extent, longest_edge(state_.mesh.face(f)));
  });
  // What ended without keeping the topology may have left nothing near it: its own extent is missing.
  const float moved = choice.keeps_topology ? choice.moved : extent;
  if (!choice.keeps_topology) {
    error = std::max(error, extent);
    for (const VertexId w : ring) state_.plain[w] = 0;
  }
  const float after = (before + moved) * round_up;
  for (const FaceId f : state_.mesh.star(u))
    if (state_.made_by[f] == id) state_.face_errors[f] = after;
  record_->collapses.push_back({v, u, id, first_ended, error * round_up, after});
  state_.quadrics[u].add(state_.quadrics[v], edge);
  state_.costs[v] = infinity;
  for (const VertexId w : ring) update(w, v, u);
}

// After v went into u: w, of the ring, has lost one neighbour and may have gained one. Only u's quadric has changed.
void CollapseWorker::update(VertexId w, VertexId v, VertexId u) {
  const float old_cost = state_.costs[w];
  if (w == u || state_.targets[w] == v || state_.plain[w] == 0) {
    state_.propose(w);
  } else {
    const float c = state_.cost(w, u);
    if (c < old_cost) {
      state_.costs[w] = c;
      state_.targets[w] = u;
    }
  }
  if (state_.costs[w] != old_cost) push(w);
}

float CollapseWorker::longest_edge(const Triangle& t) const {
  const glm::vec3 &a = state_.positions[t.x], &b = state_.positions[t.y], &c = state_.positions[t.z];
  return std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
}

}  // namespace occlod
