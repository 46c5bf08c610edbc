#include "collapse_worker.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "unit_scale.h"

namespace occlod {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float round_up = 1.0F + 1e-6F;

}  // namespace

void CollapseWorker::start(const Block& block) {
  block_ = &block;
  record_.collapses.clear();
  record_.ranks.clear();
  record_.ended.clear();
  record_.faces_gone = 0;
  queue_.reset(block.vertices.size());
  for (std::uint32_t i = 0; i < block.vertices.size(); ++i)
    if (const float cost = state_.vertices[block.vertices[i]].cost; cost <= block.threshold) queue_.push(i, cost);
}

// Some more of the block, less than a millisecond's work; false when nothing is left to do.
bool CollapseWorker::take_steps() {
  constexpr int steps = 512;
  for (int step = 0; step < steps; ++step) {
    if (record_.faces_gone >= block_->stop_after) return false;
    const std::uint32_t i = queue_.pop();
    if (i == CollapseQueue::none) return false;
    prefetch_next();
    consider(block_->vertices[i]);
  }
  return true;
}

// What consider() will read first.
void CollapseWorker::prefetch_next() const {
  const std::uint32_t next = queue_.likely_next();
  if (next == CollapseQueue::none) return;
  prefetch(&state_.vertices[block_->vertices[next]]);
  state_.mesh.prefetch(block_->vertices[next]);
}

// Of a vertex of the block.
void CollapseWorker::set_cost(VertexId v, float cost) {
  state_.vertices[v].cost = cost;
  const std::uint32_t item = state_.turns[v].place - block_->first_turn;
  queue_.remove(item);
  if (cost <= block_->threshold) queue_.push(item, cost);
}

// Checks a vertex whose turn has come; makes its collapse, or puts it back where it belongs.
void CollapseWorker::consider(VertexId v) {
  const bool is_fan = fan_.gather(state_.mesh, v);
  if (!is_fan) ring_.gather(state_.mesh, v);
  const std::span<const VertexId> ring = is_fan ? fan_.ring() : ring_.neighbours();
  if (!in_block(ring)) return;
  for (const VertexId w : ring) state_.mesh.prefetch(w);
  const Choice choice = is_fan ? choose_in_fan() : choose_in_ring();
  if (CollapseQueue::level(choice.cost) > CollapseQueue::level(state_.vertices[v].cost))
    set_cost(v, choice.cost);
  else
    collapse(v, choice, ring, choice.keeps_topology ? movement(choice, is_fan) : 0.0F);
}

bool CollapseWorker::in_block(std::span<const VertexId> vertices) const {
  return std::all_of(vertices.begin(), vertices.end(),
                     [&](VertexId w) { return state_.turns[w].place - block_->first_turn < block_->vertices.size(); });
}

// The cheapest collapse that the rules allow. Where they allow none, the cheapest that breaks the topology.
CollapseWorker::Choice CollapseWorker::choose_in_fan() {
  fan_.measure_offsets(state_.position_of());
  fan_.measure_normals();
  const VertexId v = fan_.vertex();
  const std::span<float> costs = fan_.costs(state_.vertices[v].quadric);
  for (std::size_t tries = 0; tries < costs.size(); ++tries) {
    const auto cheapest = std::min_element(costs.begin(), costs.end());
    if (!(*cheapest < infinity)) break;
    const auto i = static_cast<std::size_t>(cheapest - costs.begin());
    if (fan_.keeps_orientation(i) && fan_.keeps_topology(state_.mesh, i)) return {fan_.ring()[i], *cheapest, true, i};
    *cheapest = infinity;
  }
  return break_topology(fan_.ring(), v);
}

CollapseWorker::Choice CollapseWorker::choose_in_ring() {
  const VertexId v = ring_.vertex();
  const auto neighbours = ring_.neighbours();
  Choice best{no_id, infinity, true};
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    const float c = state_.cost(v, neighbours[i]);
    if (c < best.cost && keeps_topology(state_.mesh, ring_, i) &&
        keeps_orientation(state_.mesh, state_.positions(), v, neighbours[i]))
      best = {neighbours[i], c, true, i};
  }
  return best.u == no_id ? break_topology(neighbours, v) : best;
}

// A handle, a sliver or a component goes when errors have reached its size: at the price of the mean square of lengths
// spread evenly about the middle of its extent.
CollapseWorker::Choice CollapseWorker::break_topology(std::span<const VertexId> neighbours, VertexId v) const {
  Choice cheapest{no_id, infinity, false};
  float extent2 = 0.0F;
  for (const VertexId u : neighbours) {
    const glm::vec3 edge = state_.edge(v, u);
    extent2 = std::max(extent2, glm::dot(edge, edge));
    const float c = state_.cost(v, u);
    if (c < cheapest.cost) cheapest = {u, c, false};
  }
  // A star without area has no weight to order it by.
  const float order = std::max(state_.vertices[v].quadric.order(), std::sqrt(extent2));
  cheapest.cost = std::max(cheapest.cost, order * extent2 / 12.0F);
  return cheapest;
}

// A bound on how far a collapse that keeps the topology moves the surface.
float CollapseWorker::movement(const Choice& choice, bool is_fan) {
  if (is_fan) return fan_.change_bound(choice.place);
  return static_cast<float>(change_bound_(state_.mesh, state_.positions(), ring_, choice.u)) * round_up;
}

// `moved`: how far the surface moves at most, if the topology is kept.
void CollapseWorker::collapse(VertexId v, const Choice& choice, std::span<const VertexId> ring, float moved) {
  const VertexId u = choice.u;
  const auto id = static_cast<CollapseId>(block_->first_id + record_.collapses.size());
  const std::size_t first_ended = record_.ended.size();
  record_.faces_gone += state_.mesh.collapse(v, u, id, !choice.keeps_topology, arena_, record_.ended);
  const glm::vec3 edge = state_.edge(v, u);
  float error = std::sqrt(state_.vertices[v].quadric.mean_square(edge));
  // What ended without keeping the topology may have left nothing near it: its own extent is missing.
  if (!choice.keeps_topology) {
    moved = longest_edge(std::span(record_.ended).subspan(first_ended));
    error = std::max(error, moved);
  }
  const float after = pass_on_errors(choice, v, ring, moved);
  const float to_object = round_up / state_.scale;
  record_.collapses.push_back(
      {v, u, id, first_ended, scaled_up(error, to_object), scaled_up(after, to_object), scaled_up(moved, to_object)});
  rank(v, choice, ring);
  state_.vertices[u].quadric.add(state_.vertices[v].quadric, edge);
  state_.vertices[v].cost = infinity;
  for (const VertexId w : ring) update(w, u);
}

// Faces that a collapse makes are as far from the input as the worst of those that it ends, plus how far it moves the
// surface. Each vertex of the ring has one of them. Returns their error.
float CollapseWorker::pass_on_errors(const Choice& choice, VertexId v, std::span<const VertexId> ring, float moved) {
  float before = state_.vertices[v].error;
  // Faces that others were folded onto lie at the ring.
  if (!choice.keeps_topology)
    for (const VertexId w : ring) before = std::max(before, state_.vertices[w].error);
  const float after = (before + moved) * round_up;
  for (const VertexId w : ring) state_.vertices[w].error = std::max(state_.vertices[w].error, after);
  return after;
}

// What a collapse comes after had its vertex in the ring: it made faces there, or holds a corner that this one needs.
// Faces that others are folded onto are not at v, but all their corners are in its ring.
void CollapseWorker::rank(VertexId v, const Choice& choice, std::span<const VertexId> ring) {
  float rank = std::max(choice.cost, state_.turns[v].rank);
  if (!choice.keeps_topology)
    for (const VertexId w : ring) rank = std::max(rank, state_.turns[w].rank);
  for (const VertexId w : ring) state_.turns[w].rank = std::max(state_.turns[w].rank, rank);
  record_.ranks.push_back(rank);
}

// After a collapse into u: w, of the ring, has lost one neighbour, which leaves its cost a lower bound, and may have
// gained u. Only u's quadric has changed.
void CollapseWorker::update(VertexId w, VertexId u) {
  const float old_cost = state_.vertices[w].cost;
  float cost = old_cost;
  if (w == u) {
    cost = state_.propose(w, fan_of_u_);
  } else {
    cost = std::min(cost, state_.cost(w, u));
  }
  if (cost != old_cost) set_cost(w, cost);
}

float CollapseWorker::longest_edge(std::span<const LevelFace> faces) const {
  float longest = 0.0F;
  for (const LevelFace& face : faces)
    for (int i = 0; i < 3; ++i)
      longest = std::max(longest, glm::length(state_.edge(face.corners[i], face.corners[(i + 1) % 3])));
  return longest;
}

}  // namespace occlod
