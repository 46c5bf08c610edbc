#include "simplify.h"

#include <algorithm>
#include <atomic>
#include <glm/common.hpp>
#include <limits>
#include <thread>

#include "collapse_worker.h"
#include "occlod/core/error.h"
#include "parallel.h"
#include "spatial_order.h"

namespace occlod {
namespace {

// Vertices of a block: large enough for a good order, small enough for a cache. Once no more are left, the rest is one
// block.
constexpr std::size_t block_size = 16384;
constexpr double cheap_share = 0.35;  // of the vertices, those with the cheapest collapses have their turn in a pass
constexpr double least_progress = 1.0 / 128;  // of the vertices; a pass that collapses fewer is the last

// The fractional parts of multiples of irrational numbers: no two passes cut space in the same place.
glm::dvec3 shift_of(std::size_t pass) {
  const glm::dvec3 shift = static_cast<double>(pass) * glm::dvec3(0.6180339887, 0.4142135624, 0.7320508076);
  return shift - glm::floor(shift);
}

// Passes over all blocks, each as far as a threshold of cost below which a third of the vertices lie; then the rest in
// one. Blocks are runs of vertices along a Morton curve, another curve in each pass, so that what a border kept has its
// turn in the next. Blocks do not touch each other, and their records are joined in their order: the result does not
// depend on which thread ran which.
class Simplifier {
 public:
  Simplifier(const TriangleMesh& mesh, const BuildOptions& options)
      : options_(options), state_(mesh, options.boundary_weight), live_faces_(mesh.triangle_count()) {
    live_.reserve(mesh.vertex_count());
    for (VertexId v = 0; v < mesh.vertex_count(); ++v) live_.push_back(v);
    const unsigned threads = thread_count(options.threads);
    for (unsigned i = 0; i < threads; ++i) workers_.emplace_back(state_);
  }

  CollapseSequence run() {
    const std::size_t vertices = live_.size();
    for (std::size_t pass = 0; many_left(); ++pass) {
      sort_spatially(state_.positions, shift_of(pass), live_);
      const std::size_t made = run_pass(make_blocks(block_size, threshold()));
      if (static_cast<double>(made) < least_progress * static_cast<double>(live_.size())) break;
      drop_dead();
      report(1.0 - static_cast<double>(live_.size()) / static_cast<double>(vertices));
    }
    drop_dead();
    // Down to the base, however long that takes: each run ends with a block that has nothing left or is small enough.
    if (live_faces_ > options_.base_triangles) run_pass(make_blocks(live_.size(), std::numeric_limits<float>::max()));
    sequence_.collapses.push_back({no_id, no_id, no_id, sequence_.ended.size(), 0.0F, 0.0F});
    for (const FaceId f : state_.mesh.live_faces()) sequence_.base.push_back({state_.mesh.face(f), state_.made_by[f]});
    return std::move(sequence_);
  }

 private:
  // Blocks may take away far more than a fine base mesh allows, so they stop well before it.
  [[nodiscard]] bool many_left() const {
    return live_.size() > block_size && live_faces_ > 4 * options_.base_triangles;
  }

  [[nodiscard]] float threshold() {
    costs_.clear();
    for (const VertexId v : live_) costs_.push_back(state_.costs[v]);
    const auto middle = costs_.begin() + static_cast<std::ptrdiff_t>(cheap_share * static_cast<double>(costs_.size()));
    std::nth_element(costs_.begin(), middle, costs_.end());
    return std::min(*middle, std::numeric_limits<float>::max());
  }

  [[nodiscard]] std::vector<Block> make_blocks(std::size_t size, float threshold) {
    std::vector<Block> blocks;
    for (std::size_t begin = 0; begin < live_.size(); begin += size) {
      const auto vertices = std::span<const VertexId>(live_).subspan(begin, std::min(size, live_.size() - begin));
      const auto number = static_cast<std::uint32_t>(blocks.size());
      for (const VertexId v : vertices) state_.block_of[v] = number;
      blocks.push_back(
          {vertices, number, next_id_, threshold, live_faces_ - std::min(live_faces_, options_.base_triangles)});
      next_id_ += static_cast<CollapseId>(vertices.size());
    }
    return blocks;
  }

  // Returns how many collapses were made.
  std::size_t run_pass(const std::vector<Block>& blocks) {
    records_.assign(blocks.size(), {});
    std::atomic<std::size_t> next = 0;
    const auto work = [&](CollapseWorker& worker) {
      for (std::size_t i = next++; i < blocks.size(); i = next++) worker.run(blocks[i], records_[i]);
    };
    {
      std::vector<std::jthread> threads;
      for (std::size_t i = 1; i < std::min(workers_.size(), blocks.size()); ++i)
        threads.emplace_back([&, i] { work(workers_[i]); });
      work(workers_[0]);
    }
    std::size_t made = 0;
    for (const BlockRecord& record : records_) {
      for (Collapse collapse : record.collapses) {
        collapse.first_ended += sequence_.ended.size();
        sequence_.collapses.push_back(collapse);
      }
      sequence_.ended.insert(sequence_.ended.end(), record.ended.begin(), record.ended.end());
      live_faces_ -= record.faces_gone;
      made += record.collapses.size();
    }
    return made;
  }

  void drop_dead() {
    std::erase_if(live_, [&](VertexId v) { return state_.mesh.star(v).empty(); });
  }

  void report(double done) const {
    if (options_.progress && !options_.progress(done)) throw Error({"build", "", "was cancelled", ""});
  }

  const BuildOptions& options_;
  SimplifyState state_;
  std::vector<CollapseWorker> workers_;
  std::vector<VertexId> live_;  // in the order of the pass
  std::size_t live_faces_ = 0;
  CollapseId next_id_ = 0;
  std::vector<float> costs_;
  std::vector<BlockRecord> records_;
  CollapseSequence sequence_;
};

}  // namespace

CollapseSequence simplify(const TriangleMesh& mesh, const BuildOptions& options) {
  return Simplifier(mesh, options).run();
}

}  // namespace occlod
