#include "splits/collapse_worker.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "occlod/hierarchy.h"
#include "splits/positions.h"
#include "splits/star.h"
#include "splits/star_mesh.h"

namespace occlod {
namespace {

// Returns whether no vertex appears twice in the ring, so that no two faces have the same outer edge.
bool is_simple(std::span<const LevelFace> fan) {
  const VertexId last = fan.back().corners.z;
  for (std::size_t i = 0; i < fan.size(); ++i) {
    const VertexId w = fan[i].corners.y;
    if (i > 0 && w == last) return false;
    for (std::size_t k = 0; k < i; ++k)
      if (fan[k].corners.y == w) return false;
  }
  return true;
}

bool is_closed_fan(std::span<const LevelFace> faces) {
  VertexId from = faces.back().corners.z;
  for (const LevelFace& face : faces) {
    if (face.corners.y != from) return false;
    from = face.corners.z;
  }
  return true;
}

// Sorts faces at v that form one open fan into ring order.
bool order_open_fan(std::span<LevelFace> faces) {
  // The fan starts at the face that follows no other.
  const auto follows_another = [&](const LevelFace& f) {
    return std::any_of(faces.begin(), faces.end(), [&](const LevelFace& g) { return g.corners.z == f.corners.y; });
  };
  const auto start = std::find_if_not(faces.begin(), faces.end(), follows_another);
  if (start == faces.end()) return false;
  std::swap(faces[0], *start);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    std::size_t k = i;
    while (k < faces.size() && faces[k].corners.y != faces[i - 1].corners.z) ++k;
    if (k == faces.size()) return false;
    std::swap(faces[i], faces[k]);
  }
  return true;
}

// Finds the slot of a removed face. A split removes the faces that its collapse made; those of a fan take the places of
// the star's own faces: the face in place of slot j has the outer edge of slot j. Returns j, or the number of slots
// when there is no such place.
std::uint32_t find_slot(const Collapse& maker, const Triangle& corners) {
  const std::uint32_t slots = maker.ended_count();
  if (!maker.is_fan() || !contains(corners, maker.u)) return slots;
  // Takes the other two corners in winding order; like the slot search, it uses selects instead of unpredictable
  // branches.
  const VertexId next = corners.x == maker.u ? corners.y : corners.y == maker.u ? corners.z : corners.x;
  const VertexId last = corners.x == maker.u ? corners.z : corners.y == maker.u ? corners.x : corners.y;
  const std::span<const VertexId> ring = maker.ring();
  std::uint32_t slot = slots;
  for (std::uint32_t k = 0; k < slots; ++k) slot = ring[k] == next ? k : slot;
  return slot < slots && ring[slot + 1 == ring.size() ? 0 : slot + 1] == last ? slot : slots;
}

}  // namespace

StarShape shape_of(VertexId v, std::span<LevelFace> faces) {
  if (faces.empty() || faces.size() > SplitStar::max_ring) return StarShape::other;
  for (const LevelFace& face : faces)
    if (face.corners.x != v) return StarShape::other;
  const bool closed = is_closed_fan(faces);
  if (!closed && !order_open_fan(faces)) return StarShape::other;
  if (!is_simple(faces)) return StarShape::other;
  return closed ? StarShape::closed_fan : StarShape::open_fan;
}

std::uint32_t* CollapseMemory::allocate(std::size_t words) {
  constexpr std::size_t first_chunk = std::size_t{1} << 18U, most = std::size_t{1} << 22U;  // words
  if (words > left_) {
    left_ = std::max(words, std::min(first_chunk << chunks_.size(), most));
    chunks_.emplace_back();
    chunks_.back().reserve(left_);
  }
  std::uint32_t* const result = chunks_.back().data() + (chunks_.back().capacity() - left_);
  left_ -= words;
  return result;
}

Collapse& CollapseMemory::add(std::span<const LevelFace> ended, StarShape shape) {
  static_assert(sizeof(Collapse) % sizeof(std::uint32_t) == 0 && alignof(Collapse) == alignof(std::uint32_t));
  constexpr std::size_t head = sizeof(Collapse) / sizeof(std::uint32_t);
  const std::size_t n = ended.size(), ring_size = shape == StarShape::open_fan ? n + 1 : n;
  const std::size_t words = shape == StarShape::other ? 3 * n : ring_size + n + (n + 3) / 4;
  Collapse& collapse = *new (allocate(head + words)) Collapse;
  collapse.ended_count_ = static_cast<std::uint32_t>(n);
  collapse.shape_ = shape;
  std::uint32_t* next = collapse.words();
  if (shape == StarShape::other) {
    for (const LevelFace& face : ended)
      for (int k = 0; k < 3; ++k) *next++ = face.corners[k];
    return collapse;
  }
  for (const LevelFace& face : ended) *next++ = face.corners.y;
  if (shape == StarShape::open_fan) *next++ = ended.back().corners.z;
  for (std::size_t i = 0; i < n; ++i) *next++ = no_id;
  for (std::size_t i = 0; i < n; i += 4) *next++ = 0;
  return collapse;
}

// Each face of a manifold fan has its own place, so threads do not conflict; elsewhere two faces may share a place, and
// those stars are stored as lists.
void CollapseRecords::add(std::size_t block, CollapseId id, Collapse& collapse, std::span<const LevelFace> ended) {
  BlockRecord& record = records_[block];
  collapses_[id] = &collapse;
  for (std::uint32_t slot = 0; slot < ended.size(); ++slot) {
    const LevelFace& face = ended[slot];
    if (face.made_by == no_id) continue;
    Collapse& maker = *collapses_[face.made_by];
    const std::uint32_t place = slot < 256 ? find_slot(maker, face.corners) : maker.ended_count();
    if (place < maker.ended_count())
      maker.set_successor(place, {id, slot});
    else
      record.misplaced.push_back({face.made_by, id, slot});
  }
}

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float round_up = 1.0F + 1e-6F;
// Attributes are evaluated for at most this many neighbours of a vertex; only hubs of large wheels have more.
constexpr std::size_t max_evaluated = 32;

void raise(VertexRecord& record, const VertexRecord& least) {
  record = {std::max(record.error, least.error), std::max(record.rank, least.rank)};
}

}  // namespace

void CollapseWorker::start(const Block& block) {
  block_ = &block;
  merges_.clear();
  made_.clear();
  ended_.clear();
  corners_.clear();
  wedge_merges_.clear();
  faces_gone_ = last_gone_ = 0;
  largest_cost_ = largest_error_ = 0.0F;
  queue_.reset(block.vertices.size());
  constexpr std::uint32_t ahead = 16;
  for (std::uint32_t i = 0; i < block.vertices.size(); ++i) {
    if (i + ahead < block.vertices.size()) {
      prefetch(&state_.vertices[block.vertices[i + ahead]]);
      state_.mesh.prefetch_place(block.vertices[i + ahead]);
      state_.mesh.prefetch(block.vertices[i + ahead / 2]);
    }
    if (const float cost = state_.vertices[block.vertices[i]].cost; cost <= block.threshold) queue_.push(i, cost);
  }
}

// Processes a part of the block that takes less than a millisecond. Returns false when nothing is left to do.
bool CollapseWorker::take_steps() {
  constexpr int steps = 512;
  for (int step = 0; step < steps; ++step) {
    if (faces_gone_ >= block_->stop_after) return false;
    const std::uint32_t i = queue_.pop();
    if (i == CollapseQueue::none) return false;
    prefetch_next();
    consider(block_->vertices[i]);
  }
  return true;
}

// Prefetches the data that consider() will read first.
void CollapseWorker::prefetch_next() const {
  const std::uint32_t next = queue_.likely_next();
  if (next == CollapseQueue::none) return;
  state_.mesh.prefetch(block_->vertices[next]);
  const std::uint32_t later = queue_.likely_after(next);
  if (later == CollapseQueue::none) return;
  prefetch(&state_.vertices[block_->vertices[later]]);
  state_.mesh.prefetch_place(block_->vertices[later]);
}

// Sets the cost of a vertex of the block, and queues the vertex if the cost is within the threshold.
void CollapseWorker::set_cost(VertexId v, float cost) {
  state_.vertices[v].cost = cost;
  const std::uint32_t item = state_.vertices[v].place - block_->first_place;
  queue_.remove(item);
  if (cost <= block_->threshold) queue_.push(item, cost);
}

// Checks the vertex at the front of the queue: makes its collapse, or puts it back with its updated cost.
void CollapseWorker::consider(VertexId v) {
  const bool is_fan = fan_.gather(state_.mesh, v);
  if (!is_fan) ring_.gather(state_.mesh, v);
  const std::span<const VertexId> ring = is_fan ? fan_.ring() : ring_.neighbours();
  if (!in_block(ring)) return;
  for (const VertexId w : ring) state_.mesh.prefetch(w);
  const Choice choice = state_.attributes != nullptr ? choose_with_attributes(ring, is_fan)
                        : is_fan                     ? choose_in_fan()
                                                     : choose_in_ring();
  if (CollapseQueue::level(choice.cost) > CollapseQueue::level(state_.vertices[v].cost))
    set_cost(v, choice.cost);
  else
    collapse(v, choice, ring, choice.keeps_topology && state_.keeps_collapses ? movement(choice, is_fan) : 0.0F);
}

bool CollapseWorker::in_block(std::span<const VertexId> vertices) const {
  return std::all_of(vertices.begin(), vertices.end(), [&](VertexId w) {
    return state_.vertices[w].place - block_->first_place < block_->vertices.size();
  });
}

// Returns the cheapest collapse that the rules allow; if they allow none, the cheapest that breaks the topology.
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
    if (c < best.cost && keeps_surface(state_.mesh, ring_, i) &&
        keeps_orientation(state_.mesh, state_.positions(), v, neighbours[i]))
      best = {neighbours[i], c, true, i};
  }
  return best.u == no_id ? break_topology(neighbours, v) : best;
}

// Chooses like choose_in_fan() or choose_in_ring(), but with attribute errors added to the cost. These are expensive
// to compute, so neighbours are tried by ascending quadric cost until that alone exceeds the best total.
CollapseWorker::Choice CollapseWorker::choose_with_attributes(std::span<const VertexId> ring, bool is_fan) {
  const VertexId v = is_fan ? fan_.vertex() : ring_.vertex();
  const VertexQuadric& quadric = state_.vertices[v].quadric;
  std::span<float> costs;
  if (is_fan) {
    fan_.measure_offsets(state_.position_of());
    fan_.measure_normals();
    costs = fan_.costs(quadric);
  } else {
    ring_costs_.clear();
    for (const VertexId u : ring) ring_costs_.push_back(state_.cost(v, u));
    costs = ring_costs_;
  }
  attributes_.gather(state_.mesh, *state_.attributes, state_.positions(), v);
  const float weight = quadric.order() * state_.attribute_weight2;
  const float so_far = weight * quadric.inverse_weight() * state_.attributes->sums[v];
  Choice best{no_id, infinity, true};
  std::size_t evaluated = 0;
  for (std::size_t tries = 0; tries < costs.size() && evaluated < max_evaluated; ++tries) {
    const auto cheapest = std::min_element(costs.begin(), costs.end());
    const float cost = *cheapest + so_far;
    if (!(cost < best.cost)) break;
    *cheapest = infinity;
    const auto i = static_cast<std::size_t>(cheapest - costs.begin());
    const bool is_allowed =
        is_fan ? fan_.keeps_orientation(i) && fan_.keeps_topology(state_.mesh, i)
               : keeps_surface(state_.mesh, ring_, i) && keeps_orientation(state_.mesh, state_.positions(), v, ring[i]);
    if (!is_allowed) continue;
    // No total within the best is above this, whatever rounding does.
    const float most = (1.0F + 1e-6F) * ((best.cost - cost) / weight);
    const float deviation2 = attributes_.choose(ring[i], most);
    const float total = cost + weight * deviation2;
    ++evaluated;
    if (!(total < best.cost)) continue;
    best = {ring[i], total, true, i};
    attributes_.keep(ring[i], deviation2);
  }
  return best.u == no_id ? break_topology(ring, v) : best;
}

// Chooses a collapse that removes a handle, a sliver or a component once errors have reached its size. Its cost is the
// mean square of lengths that are spread evenly about the middle of its extent.
CollapseWorker::Choice CollapseWorker::break_topology(std::span<const VertexId> neighbours, VertexId v) const {
  Choice cheapest{no_id, infinity, false};
  float extent2 = 0.0F;
  for (const VertexId u : neighbours) {
    const glm::vec3 edge = state_.edge(v, u);
    extent2 = std::max(extent2, glm::dot(edge, edge));
    const float c = state_.cost(v, u);
    if (c < cheapest.cost) cheapest = {u, c, false};
  }
  // A star without area has no weight to order it by, so its extent is used instead.
  const float order = std::max(state_.vertices[v].quadric.order(), std::sqrt(extent2));
  cheapest.cost = std::max(cheapest.cost, order * extent2 / 12.0F);
  return cheapest;
}

// Bounds how far a collapse that keeps the topology moves the surface. The bound of a fan is computed later, in a
// batch.
float CollapseWorker::movement(const Choice& choice, bool is_fan) {
  if (!is_fan) return static_cast<float>(change_bound_(state_.positions(), ring_, choice.u)) * round_up;
  Batch& batch = batches_[fan_.size()];
  if (batch.fans.size() == FanMovements::capacity) compute_movements(batch);
  batch.made[batch.fans.size()] = made_.size();
  batch.fans.add(fan_, choice.place);
  return 0.0F;
}

void CollapseWorker::compute_movements(Batch& batch) {
  const FanMovements::PerFan<float> bounds = batch.fans.bounds();
  for (std::size_t i = 0; i < batch.fans.size(); ++i) made_[batch.made[i]].moved = bounds[i];
  batch.fans.clear();
}

// Makes the collapse. `moved` bounds how far the surface moves, if the topology is kept.
void CollapseWorker::collapse(VertexId v, const Choice& choice, std::span<const VertexId> ring, float moved) {
  const VertexId u = choice.u;
  const auto id = static_cast<CollapseId>(CollapseRecords::first_id(block_->record) + merges_.size());
  const std::size_t first_ended = ended_.size(), first_corners = corners_.size();
  const float deviation2 = state_.attributes != nullptr ? attributes_.settle(u) : 0.0F;
  const bool is_ring = choice.keeps_topology && state_.mesh.star(v).is_ring();
  last_gone_ = state_.mesh.collapse(v, u, id, !choice.keeps_topology, arena_, ended_);
  faces_gone_ += last_gone_;
  merges_.push_back({v, u});
  float attribute_error = 0.0F;
  if (state_.attributes != nullptr) {
    move_corners(v, u, id, first_ended);
    if (state_.keeps_wedge_merges) attributes_.list_merges(v, u, wedge_merges_);
    attribute_error = add_deviation(v, deviation2);
    state_.attributes->sums[u] += state_.attributes->sums[v];
  }
  const glm::vec3 edge = state_.edge(v, u);
  float error = std::sqrt(state_.vertices[v].quadric.mean_square(edge));
  // A collapse that breaks the topology may leave nothing near the faces it ends, so their own extent is added.
  if (!choice.keeps_topology) {
    moved = longest_edge(std::span(ended_).subspan(first_ended));
    error = std::max(error, moved);
  }
  if (state_.keeps_collapses) {
    made_.push_back(
        {v, u, first_ended, error, moved, choice.keeps_topology, is_ring, choice.cost, attribute_error, first_corners});
  } else {
    largest_cost_ = std::max(largest_cost_, choice.cost);
    largest_error_ = std::max({largest_error_, error, state_.attribute_weight2 > 0.0F ? attribute_error : 0.0F});
    ended_.clear();
    corners_.clear();
  }
  state_.vertices[u].quadric.add(state_.vertices[v].quadric, edge);
  state_.vertices[v].cost = infinity;
  for (const VertexId w : ring) update(w, u);
}

// Adds a squared deviation to the sum of v. Returns the root mean square over all collapses that led to v.
float CollapseWorker::add_deviation(VertexId v, float deviation2) {
  const float weight = state_.vertices[v].quadric.weight;
  float& sum = state_.attributes->sums[v];
  sum += weight * deviation2;
  return std::sqrt(weight > 0.0F ? sum / weight : deviation2);
}

// Records the wedges of the faces that v's collapse ended, and assigns wedges to the faces that it made. attributes_
// has already chosen them.
void CollapseWorker::move_corners(VertexId v, VertexId u, CollapseId id, std::size_t first_ended) {
  const auto add = [&](const LevelFace& face, const Triangle& wedges) {
    if (wedges != face.corners) corners_.push_back({face, wedges});
  };
  CornerMap& map = state_.attributes->corners;
  const std::span<const StarFace> star = attributes_.faces();
  for (std::size_t i = 0; i < star.size(); ++i)
    add({{v, star[i].next, star[i].last}, star[i].made_by}, attributes_.wedges()[i]);
  const auto folded = std::span<const LevelFace>(ended_).subspan(first_ended + star.size());
  folded_.clear();
  for (const LevelFace& face : folded) {
    const StarFace of_u{face.corners.y, face.corners.z, face.made_by};
    add(face, map.wedges(u, of_u, static_cast<std::size_t>(std::count(folded_.begin(), folded_.end(), of_u))));
    folded_.push_back(of_u);
  }
  map.collapse(state_.mesh, v, u, id, star, attributes_.wedges_of_u(), folded);
}

// Records all collapses made.
void CollapseWorker::finish() {
  for (Batch& batch : batches_)
    if (batch.fans.size() > 0) compute_movements(batch);
  BlockRecord& record = records_[block_->record];
  record.faces_gone = faces_gone_;
  record.last_gone = last_gone_;
  const float to_object = round_up / state_.scale;
  record.wedge_merges = wedge_merges_;
  if (!state_.keeps_collapses) {
    record.merges = merges_;
    record.largest_cost = largest_cost_;
    record.largest_error = scaled_up(largest_error_, to_object);
    return;
  }
  const CollapseId first = CollapseRecords::first_id(block_->record);
  record.ranks.reserve(made_.size());
  for (std::size_t i = 0; i < made_.size(); ++i) {
    const Made& made = made_[i];
    const std::span<LevelFace> ended = ended_by(i);
    const bool is_fan = made.is_ring && ended.size() <= SplitStar::max_ring;
    const StarShape shape = is_fan ? StarShape::closed_fan : shape_of(made.v, ended);
    const VertexRecord reached = raise_ring(made, ended, shape);
    Collapse& collapse = memory_.add(ended, shape);
    collapse.v = made.v;
    collapse.u = made.u;
    collapse.error = scaled_up(made.error, to_object);
    if (!made.keeps_topology) record.torn = std::max(record.torn, collapse.error);
    collapse.guaranteed_error = scaled_up(reached.error, to_object);
    collapse.moved = scaled_up(made.moved, to_object);
    record.ranks.push_back(reached.rank);
    records_.add(block_->record, first + static_cast<CollapseId>(i), collapse, ended);
    prefetch_makers(i);
    if (state_.attributes != nullptr) {
      record_corners(i, ended, record);
      record.attribute_errors.push_back(scaled_up(made.attribute_error, to_object));
    }
  }
}

// Records corners by the slots of the faces that collapse i ended, which are in their final order.
void CollapseWorker::record_corners(std::size_t i, std::span<const LevelFace> ended, BlockRecord& record) {
  record.first_corners.push_back(record.corners.size());
  const std::size_t first = made_[i].first_corners;
  const std::size_t end = i + 1 < made_.size() ? made_[i + 1].first_corners : corners_.size();
  const auto corners = std::span<const CornerFace>(corners_).subspan(first, end - first);
  taken_.assign(corners.size(), false);
  std::size_t first_left = 0;  // most faces are already in order
  for (std::uint32_t slot = 0; first_left < corners.size() && slot < ended.size(); ++slot) {
    while (first_left < corners.size() && taken_[first_left]) ++first_left;
    for (std::size_t c = first_left; c < corners.size(); ++c) {
      const LevelFace& face = corners[c].face;
      if (taken_[c] || face.made_by != ended[slot].made_by || face.corners != ended[slot].corners) continue;
      taken_[c] = true;
      record.corners.push_back({slot, corners[c].wedges});
      break;
    }
  }
}

// Returns the faces that collapse i ended.
std::span<LevelFace> CollapseWorker::ended_by(std::size_t i) {
  const std::size_t end = i + 1 < made_.size() ? made_[i + 1].first_ended : ended_.size();
  return std::span(ended_).subspan(made_[i].first_ended, end - made_[i].first_ended);
}

// Prefetches the makers, because collapses of earlier passes are scattered in memory.
void CollapseWorker::prefetch_makers(std::size_t i) {
  constexpr std::size_t ahead = 4;
  const CollapseId first = CollapseRecords::first_id(block_->record);
  const auto for_each_maker = [&](std::size_t later, const auto& visit) {
    if (later >= made_.size() || first == 0) return;
    // Visits the block's first collapse in the place of makers that are not earlier, instead of branching.
    for (const LevelFace& face : ended_by(later)) visit(records_.collapse(std::min(face.made_by, first)));
  };
  if (i + ahead < made_.size()) {
    prefetch(&state_.records[made_[i + ahead].v]);
    for (const LevelFace& face : ended_by(i + ahead)) prefetch(&state_.records[face.corners.y]);
  }
  for_each_maker(i + 2 * ahead, [](Collapse* const& place) { prefetch(&place); });
  for_each_maker(i + ahead, [](Collapse* const& place) {
    prefetch(place);
    prefetch(reinterpret_cast<const std::byte*>(place) + 64);  // the successors
  });
}

// Raises what is recorded of the ring to what the collapse reaches, and returns that. The error of the faces that it
// makes is the largest of those that it ends, plus how far it moves the surface: each ring vertex is a corner of an
// ended face and has one of the new faces. Its rank must not be less than the ranks of the collapses it depends on,
// each of which had v in its ring: it made faces there, or has a corner that this one needs. Faces onto which others
// are folded are not at v, but all their corners are in its ring.
VertexRecord CollapseWorker::raise_ring(const Made& made, std::span<const LevelFace> ended, StarShape shape) {
  VertexRecord reached = state_.records[made.v];
  if (!made.keeps_topology)
    for (const LevelFace& face : ended)
      for (int k = 0; k < 3; ++k) raise(reached, state_.records[face.corners[k]]);
  reached = {(reached.error + made.moved) * round_up, std::max(made.cost, reached.rank)};
  for (const LevelFace& face : ended) {
    raise(state_.records[face.corners.y], reached);
    if (shape != StarShape::closed_fan) raise(state_.records[face.corners.z], reached);
  }
  return reached;
}

// Updates ring vertex w after a collapse into u. It has lost one neighbour, which leaves its cost a valid lower bound,
// and may have gained u. Only u's quadric has changed.
void CollapseWorker::update(VertexId w, VertexId u) {
  if (state_.is_locked(w)) return;
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
