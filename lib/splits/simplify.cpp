#include "splits/simplify.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>

#include "base/memory.h"
#include "base/platform.h"
#include "base/threads.h"
#include "splits/build_progress.h"
#include "splits/collapse_worker.h"
#include "splits/quadric_minima.h"
#include "splits/spatial_order.h"

namespace occlod {
namespace {

// Joins the records of all blocks into one collapse sequence.

// Returns the ids of all collapses by ascending rank; equal ranks keep the order of recording.
UninitializedVector<Keyed> by_rank(const CollapseRecords& records, unsigned threads) {
  // Ranks are not negative, so their bits ascend with them. Only three bits of the mantissa are kept: equal keys stay
  // in recorded order, so neighbours in space stay neighbours in memory.
  constexpr unsigned dropped_bits = 20;
  std::size_t count = 0;
  for (std::size_t block = 0; block < records.size(); ++block) count += records[block].ranks.size();
  UninitializedVector<Keyed> keyed;
  keyed.reserve(count);
  for (std::size_t block = 0; block < records.size(); ++block) {
    CollapseId id = CollapseRecords::first_id(block);
    for (const float rank : records[block].ranks)
      keyed.push_back({std::bit_cast<std::uint32_t>(rank) >> dropped_bits, id++});
  }
  sort_by_key(keyed, 32 - dropped_bits, threads);
  return keyed;
}

// Joins the attributes; called only where they count.
void join_attributes(CollapseRecords& records, const UninitializedVector<Keyed>& order, CollapseSequence& sequence) {
  if (!sequence.has_attributes) return;
  sequence.attributes.resize(order.size());
  for (std::size_t block = 0; block < records.size(); ++block) {
    BlockRecord& record = records[block];
    const CollapseId first = CollapseRecords::first_id(block);
    sequence.corner_memory.push_back(std::move(record.corners));
    const std::vector<EndedCorners>& corners = sequence.corner_memory.back();
    for (std::size_t i = 0; i < record.first_corners.size(); ++i) {
      const std::size_t begin = record.first_corners[i];
      const std::size_t end = i + 1 < record.first_corners.size() ? record.first_corners[i + 1] : corners.size();
      sequence.attributes[sequence.places[first + i]] = {record.attribute_errors[i],
                                                         std::span(corners).subspan(begin, end - begin)};
    }
  }
}

// Fills in the sequence's collapses, their places and the misplaced faces. The records are in an order in which their
// collapses can be made; the sequence is in the order of ranks, which is another such order. Consumes `records`.
void join_records(CollapseRecords& records, CollapseSequence& sequence, unsigned threads,
                  const ProgressPart& progress) {
  const UninitializedVector<Keyed> order = by_rank(records, threads);
  sequence.places.resize(records.end_id());
  sequence.collapses.resize(order.size());
  const ProgressPart part{progress.progress, progress.first, progress.last, static_cast<double>(order.size())};
  for_each_range(
      order.size(), threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          sequence.places[order[i].item] = static_cast<CollapseId>(i);
          sequence.collapses[i] = records.collapse(order[i].item);
        }
      },
      [&](std::size_t done) { part.reach(done); });
  for (std::size_t block = 0; block < records.size(); ++block) {
    const std::vector<MisplacedFace>& misplaced = records[block].misplaced;
    sequence.misplaced.insert(sequence.misplaced.end(), misplaced.begin(), misplaced.end());
  }
  join_attributes(records, order, sequence);
  records.resize(0, 0);
}

// Number of vertices in a block: large enough for a good order, small enough for a cache. Once no more are left, the
// rest forms one block.
constexpr std::size_t block_size = CollapseRecords::block_size;
constexpr double cheap_share = 0.5;  // this share of the vertices, with the cheapest collapses, is processed in a pass
constexpr double min_progress = 1.0 / 128;  // share of the vertices; a pass that collapses fewer is the last

// Shares of the whole build's time at which passes begin and end and the sequence is joined. Later steps take the rest.
constexpr double passes_first = 0.15, passes_last = 0.7, joined = 0.75;

// Returns the fractional parts of multiples of irrational numbers, so that no two passes cut space in the same place.
glm::dvec3 shift_of(std::size_t pass) {
  const glm::dvec3 shift = static_cast<double>(pass) * glm::dvec3(0.6180339887, 0.4142135624, 0.7320508076);
  return shift - glm::floor(shift);
}

Box scaled_box(const TriangleMesh& mesh, float scale) {
  Box box = bounding_box(mesh.positions);
  box.min *= scale;
  box.max *= scale;
  return box;
}

// Runs passes over all blocks, each up to a cost threshold below which half of the vertices lie, then finishes in one
// block. Blocks are runs of vertices along a Morton curve that differs in each pass, so that vertices left alone at a
// border are processed in the next pass. Blocks do not touch each other, and their records are joined in their order,
// so the result does not depend on which thread ran which block.
class Simplifier {
 public:
  Simplifier(const TriangleMesh& mesh, const BuildOptions& options, const SimplifySetup& setup)
      : mesh_(mesh),
        options_(options),
        threads_(thread_count(options.threads)),
        progress_(options.progress),
        state_(std::make_unique<SimplifyState>(mesh, setup_of(options, threads_, setup),
                                               ProgressPart{progress_, 0.0, passes_first, 1.0})),
        box_(scaled_box(mesh, state_->scale)),
        live_faces_(mesh.triangle_count()) {
    live_.reserve(mesh.vertex_count());
    for (VertexId v = 0; v < mesh.vertex_count(); ++v) live_.push_back(v);
    live_.resize(keep_living(live_));
    for (unsigned i = 0; i < threads_; ++i) workers_.push_back(std::make_unique<CollapseWorker>(*state_, records_));
  }

  CollapseSequence run() {
    collapse();
    return join();
  }

  ReducedFaces reduce() {
    collapse();
    ReducedFaces result;
    for (const LevelFace& face : state_->mesh.faces()) result.faces.push_back(face.corners);
    if (state_->attributes != nullptr) result.corners = base_corners(state_->mesh.faces());
    // A vertex is merged later than all that are merged into it, so backwards every target is final.
    result.target.resize(mesh_.vertex_count());
    std::iota(result.target.begin(), result.target.end(), 0U);
    for (std::size_t block = records_.size(); block-- > 0;) {
      const auto& merges = records_[block].merges;
      for (std::size_t i = merges.size(); i-- > 0;) result.target[merges[i].v] = result.target[merges[i].u];
    }
    if (result.faces.empty() && records_.size() > 0) result.least_possible = records_[records_.size() - 1].last_gone;
    result.minima = quadric_minima(*state_, live_, result.target, mesh_.triangles);
    result.scale = state_->scale;
    return result;
  }

 private:
  void collapse() {
    for (std::size_t pass = 0; many_left(); ++pass) {
      if (pass > 0) sort_live(pass);
      const std::size_t before = live_.size();
      const std::size_t made =
          run_pass(make_blocks(block_size, threshold(), std::max(2 * options_.base_triangles, live_faces_ / 16)));
      if (static_cast<double>(made) < min_progress * static_cast<double>(before)) break;
    }
    // Run down to the base mesh, however long it takes: each run ends with a block that is exhausted or small enough.
    if (live_faces_ > options_.base_triangles)
      run_pass(make_blocks(live_.size(), std::numeric_limits<float>::max(), options_.base_triangles));
  }

  static SimplifySetup setup_of(const BuildOptions& options, unsigned threads, SimplifySetup setup) {
    setup.boundary_weight = options.boundary_weight;
    setup.threads = threads;
    setup.keeps_attributes = true;
    setup.attribute_weight = options.attribute_weight;
    return setup;
  }

  // Returns whether many faces are left. The last of them go in the order of their costs over the whole mesh.
  [[nodiscard]] bool many_left() const {
    return live_.size() > block_size && live_faces_ > 4 * options_.base_triangles;
  }

  // Coarse cells are enough to cut blocks: a block has some hundred of them on a surface.
  void sort_live(std::size_t pass) {
    const auto blocks = static_cast<unsigned>(live_.size() / block_size + 1);
    const unsigned bits = std::min(10U, 5U + static_cast<unsigned>(std::bit_width(blocks)) / 2);
    sort_spatially(state_->positions(), {box_, shift_of(pass), bits}, live_, threads_);
  }

  // Returns the cost below which the cheap share lies, estimated from every sixteenth vertex.
  [[nodiscard]] float threshold() const {
    std::vector<float> costs;
    for (std::size_t i = 0; i < live_.size(); i += 16) costs.push_back(state_->vertices[live_[i]].cost);
    const auto middle = costs.begin() + static_cast<std::ptrdiff_t>(cheap_share * static_cast<double>(costs.size()));
    std::nth_element(costs.begin(), middle, costs.end());
    return std::min(*middle, std::numeric_limits<float>::max());
  }

  // Makes blocks of `size` vertices that together leave `least` faces: each may remove its share of the others.
  [[nodiscard]] std::vector<Block> make_blocks(std::size_t size, float threshold, std::size_t least) {
    for_each_id(live_.size(), threads_, [&](std::uint32_t i) {
      constexpr std::uint32_t ahead = 16;
      if (i + ahead < live_.size()) prefetch(&state_->vertices[live_[i + ahead]].place);
      state_->vertices[live_[i]].place = i;
    });
    const double share =
        static_cast<double>(live_faces_ - std::min(live_faces_, least)) / static_cast<double>(live_.size());
    std::vector<Block> blocks;
    for (std::size_t begin = 0; begin < live_.size(); begin += size) {
      const auto vertices = std::span(live_).subspan(begin, std::min(size, live_.size() - begin));
      blocks.push_back({vertices, static_cast<std::uint32_t>(begin), records_.size() + blocks.size(), threshold,
                        static_cast<std::size_t>(std::ceil(share * static_cast<double>(vertices.size())))});
    }
    return blocks;
  }

  // Leaves only vertices that still have faces in live_. Returns the number of collapses made.
  std::size_t run_pass(const std::vector<Block>& blocks) {
    const std::size_t first_record = records_.size();
    records_.resize(first_record + blocks.size(), blocks.back().vertices.size());
    std::vector<std::size_t> kept(blocks.size());
    std::atomic<std::size_t> next = 0;
    const auto work = [&](CollapseWorker& worker, const auto& go_on) {
      try {
        for (std::size_t i = next++; i < blocks.size() && !progress_.is_cancelled(); i = next++) {
          worker.run(blocks[i], go_on);
          faces_gone_ += records_[blocks[i].record].faces_gone;
          kept[i] = keep_living(blocks[i].vertices);
        }
      } catch (...) {
        next = blocks.size();  // otherwise the other threads would run to the end
        throw;
      }
    };
    const ProgressPart part{progress_, passes_first, passes_last, static_cast<double>(mesh_.triangle_count())};
    const auto report = [&](std::size_t gone) { return part.reach(faces_gone_ + gone), true; };
    const auto heed = [&](std::size_t) { return !progress_.is_cancelled(); };
    share(thread_count_for(blocks.size(), static_cast<unsigned>(workers_.size())), [&](unsigned number) {
      if (number == 0)
        work(*workers_[0], report);
      else
        work(*workers_[number], heed);
    });
    std::size_t left = 0;
    for (std::size_t i = 0; i < blocks.size(); ++i)
      for (const VertexId v : blocks[i].vertices.first(kept[i])) live_[left++] = v;
    live_.resize(left);
    std::size_t made = 0;
    for (std::size_t i = first_record; i < records_.size(); ++i) {
      live_faces_ -= records_[i].faces_gone;
      made += std::max(records_[i].ranks.size(), records_[i].merges.size());
    }
    return made;
  }

  // Moves the vertices that have faces to the front. Returns their number.
  [[nodiscard]] std::size_t keep_living(std::span<VertexId> vertices) const {
    const auto is_dead = [&](VertexId v) { return state_->mesh.star(v).empty(); };
    return static_cast<std::size_t>(std::remove_if(vertices.begin(), vertices.end(), is_dead) - vertices.begin());
  }

  // Returns the corners of the base faces. StarMesh lists faces by their smallest corners, in the order of these
  // corners' stars.
  [[nodiscard]] std::vector<Triangle> base_corners(std::span<const LevelFace> base) const {
    std::vector<Triangle> result;
    std::vector<StarFace> before;
    VertexId v = no_id;
    for (const LevelFace& face : base) {
      if (face.corners.x != v) before.clear();
      v = face.corners.x;
      const StarFace of_v{face.corners.y, face.corners.z, face.made_by};
      const auto rank = static_cast<std::size_t>(std::count(before.begin(), before.end(), of_v));
      result.push_back(state_->attributes->corners.wedges(v, of_v, rank));
      before.push_back(of_v);
    }
    return result;
  }

  // Joins the records of all blocks into one sequence, ordered by rank. Frees the state first, because both need much
  // memory.
  CollapseSequence join() {
    CollapseSequence sequence;
    sequence.base = state_->mesh.faces();
    if (state_->attributes != nullptr) {
      sequence.has_attributes = true;
      sequence.base_corners = base_corners(sequence.base);
    }
    for (const auto& worker : workers_) sequence.memory.push_back(worker->take_memory());
    workers_.clear();
    state_.reset();
    join_records(records_, sequence, threads_, ProgressPart{progress_, passes_last, joined, 1.0});
    return sequence;
  }

  const TriangleMesh& mesh_;
  const BuildOptions& options_;
  unsigned threads_;
  BuildProgress progress_;
  std::unique_ptr<SimplifyState> state_;
  Box box_;
  CollapseRecords records_;
  std::vector<std::unique_ptr<CollapseWorker>> workers_;
  std::vector<VertexId> live_;  // in the order of the current pass
  std::size_t live_faces_ = 0;
  std::atomic<std::size_t> faces_gone_ = 0;
};

}  // namespace

CollapseSequence simplify(const TriangleMesh& mesh, const BuildOptions& options) {
  return Simplifier(mesh, options, {}).run();
}

ReducedFaces reduce(const TriangleMesh& mesh, const BuildOptions& options, std::span<const std::uint8_t> locked) {
  return Simplifier(mesh, options, {.locked = locked, .keeps_collapses = false}).reduce();
}

}  // namespace occlod
