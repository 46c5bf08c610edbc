#include "cells/cell_loads.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>

#include "occlod/base.h"
#include "occlod/cell_walker.h"

namespace occlod {

std::optional<CellId> CellLoads::take_locked() {
  while (!wanted_.empty()) {
    const CellId cell = wanted_.back();
    wanted_.pop_back();
    if (std::ranges::find(under_way_, cell) != under_way_.end()) continue;
    under_way_.push_back(cell);
    return cell;
  }
  return std::nullopt;
}

std::optional<CellId> CellLoads::take() {
  const std::lock_guard lock(mutex_);
  return take_locked();
}

std::optional<CellId> CellLoads::take_or_wait() {
  std::unique_lock lock(mutex_);
  std::optional<CellId> taken;
  changed_.wait(lock, [&] { return stopped_ || (taken = take_locked()).has_value(); });
  return stopped_ ? std::nullopt : taken;
}

SharedAdditions CellLoads::find(CellId cell) const {
  const std::lock_guard lock(mutex_);
  const auto found = additions_.find(cell);
  return found == additions_.end() ? nullptr : found->second;
}

CellLoad CellLoads::load(CellId cell, CellMeshMaker& maker) const {
  CellLoad result;
  result.cell = cell;
  CellId at = cell;
  try {
    std::vector<CellId> path;
    file_.tree().path_to(cell, path);
    std::vector<SharedAdditions> kept;
    std::vector<const CellAdditions*> additions;
    for (const CellId node : path) {
      at = node;
      SharedAdditions found = find(node);
      if (!found) {
        found = std::make_shared<const CellAdditions>(reader_ ? reader_(node, additions) : file_.read(node, additions));
        result.bytes_read += file_.tree().node(node).payload_bytes;
        if (!file_.tree().is_leaf(node)) result.additions.emplace_back(node, found);
      }
      additions.push_back(found.get());
      kept.push_back(std::move(found));
    }
    result.mesh = std::make_shared<const CellMesh>(maker.make(cell, additions));
  } catch (const std::exception& error) {
    result.failed = at;
    result.problem = error.what();
  }
  result.bytes_read += maker.take_bytes_read();
  return result;
}

void CellLoads::finish(CellLoad load) {
  const std::lock_guard lock(mutex_);
  std::erase(under_way_, load.cell);
  std::erase(wanted_, load.cell);
  for (const auto& [node, additions] : load.additions) additions_.emplace(node, additions);
  ended_.push_back(std::move(load));
}

void CellLoads::want(std::span<const CellId> cells) {
  {
    const std::lock_guard lock(mutex_);
    wanted_.assign(cells.rbegin(), cells.rend());
    // Skip loads that have ended meanwhile but have not been collected yet.
    for (const CellLoad& load : ended_) std::erase(wanted_, load.cell);
  }
  changed_.notify_all();
}

void CellLoads::collect(std::vector<CellLoad>& out) {
  out.clear();
  const std::lock_guard lock(mutex_);
  out.swap(ended_);
}

std::size_t CellLoads::addition_bytes() const {
  const std::lock_guard lock(mutex_);
  std::size_t bytes = 0;
  for (const auto& [node, additions] : additions_) bytes += additions->bytes();
  return bytes;
}

void CellLoads::keep_additions(std::span<const CellId> path) {
  const std::lock_guard lock(mutex_);
  std::erase_if(additions_, [&](const auto& entry) { return std::ranges::find(path, entry.first) == path.end(); });
}

void CellLoads::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
}

namespace {

// Estimated bytes per drawn triangle: two thirds of a vertex with its normal. Hidden faces leave borders, so there are
// more than half as many vertices as triangles.
constexpr std::size_t packed_vertex_bytes = 2 * (sizeof(glm::vec3) + sizeof(glm::vec3)) / 3;

}  // namespace

CellResidents::CellResidents(const VlodFile& file, std::size_t base_triangles)
    : tree_(file.tree()),
      triangle_bytes_(sizeof(Triangle) + (file.is_packed() && !file.has_objects() ? packed_vertex_bytes : 0)),
      base_triangles_(base_triangles),
      objects_(file.object_count()) {}

void CellResidents::add(CellId cell, std::shared_ptr<const CellMesh> mesh) {
  Resident& resident = residents_[cell];
  if (resident.mesh) bytes_ -= resident.mesh->bytes();
  bytes_ += mesh->bytes();
  known_bytes_[cell] = mesh->bytes();
  resident = {std::move(mesh), calls_};
}

const std::shared_ptr<const CellMesh>& CellResidents::find(CellId cell) const {
  static const std::shared_ptr<const CellMesh> none;
  const auto found = residents_.find(cell);
  return found == residents_.end() ? none : found->second.mesh;
}

std::size_t CellResidents::bytes_of(CellId cell) const {
  if (const auto known = known_bytes_.find(cell); known != known_bytes_.end()) return known->second;
  std::size_t triangles = tree_.node(cell).drawn_triangles;
  if (!tree_.is_leaf(cell)) {
    // A split usually adds two faces to a cut.
    triangles = base_triangles_;
    for (CellId node = cell; node != no_id; node = tree_.node(node).parent)
      triangles += 2 * std::size_t{tree_.node(node).splits};
  }
  const std::size_t blocks = triangles / 256 + objects_;
  return sizeof(CellMesh) + triangles * triangle_bytes_ + blocks * sizeof(TriangleBlock) +
         objects_ * sizeof(CellMesh::Object);
}

void CellResidents::shrink(std::span<const CellId> kept, std::size_t bytes) {
  ++calls_;
  for (const CellId cell : kept)
    if (const auto found = residents_.find(cell); found != residents_.end()) found->second.wanted = calls_;
  while (bytes_ > bytes) {
    auto oldest = residents_.end();
    for (auto at = residents_.begin(); at != residents_.end(); ++at)
      if (at->first != 0 && at->second.wanted < calls_ &&
          (oldest == residents_.end() || at->second.wanted < oldest->second.wanted))
        oldest = at;
    if (oldest == residents_.end()) return;
    bytes_ -= oldest->second.mesh->bytes();
    residents_.erase(oldest);
  }
}

namespace {

constexpr double memory_seconds = 0.2;
constexpr double slope = 0.25;         // how far the eye may leave its course, relative to the distance travelled
constexpr double walking_speed = 1.4;  // m/s: a speed that an eye may reach at any time
constexpr int max_samples = 64;        // along the course

}  // namespace

void WalkMotion::step(const glm::dvec3& eye, double seconds) {
  const glm::dvec3 way = eye - eye_;
  eye_ = eye;
  if (is_first_ || !(glm::length(way) < jump_)) {
    is_first_ = false;
    velocity_ = glm::dvec3(0.0);
  } else if (seconds > 0.0) {
    velocity_ = glm::mix(velocity_, way / seconds, 1.0 - std::exp(-seconds / memory_seconds));
  }
}

void CellForecast::add(CellId leaf, double seconds) {
  const auto at = std::ranges::find(expected_, leaf, &ExpectedCell::leaf);
  if (at == expected_.end())
    expected_.push_back({leaf, seconds});
  else
    at->seconds = std::min(at->seconds, seconds);
}

const std::vector<ExpectedCell>& CellForecast::expect(CellId leaf, const glm::dvec3& eye, const glm::dvec3& velocity,
                                                      double horizon, std::size_t most) {
  if (leaf != here_) tree_.neighbours(leaf, neighbours_);
  here_ = leaf;
  expected_.clear();
  const double speed = glm::length(velocity), at_least = std::max(speed, walking_speed);
  const double aside = std::max(slope * speed, walking_speed);
  for (const CellId other : neighbours_) {
    // A cell ahead is entered when it is reached, one aside when the eye has drifted there, any other only after a
    // turn.
    const CellBox& box = tree_.node(other).box;
    const glm::dvec3 there = glm::clamp(eye, box.min, box.max) - eye;
    const glm::dvec3 ahead = speed > 0.0 ? velocity * (glm::dot(there, velocity) / (speed * speed)) : glm::dvec3(0.0);
    const double turn = glm::dot(there, velocity) < 0.0 ? memory_seconds : 0.0;
    add(other, std::max(glm::length(ahead) / at_least, glm::length(there - ahead) / aside) + turn);
  }
  // Samples the course in steps of half a cell; the first and the last sample are its ends.
  const CellBox& box = tree_.node(leaf).box;
  const double reach = speed * horizon, edge = std::max(glm::length(box.max - box.min) / 2.0, 1e-12);
  const int samples = static_cast<int>(std::clamp(std::ceil(2.0 * reach / edge), 1.0, double{max_samples}));
  for (int i = 0; speed > 0.0 && i <= samples && expected_.size() < 4 * most; ++i) {
    const double way = reach * i / samples, radius = slope * std::max(way, reach / samples);
    const glm::dvec3 place = eye + velocity * (way / speed);
    tree_.leaves_in({place - radius, place + radius}, found_);
    for (const CellId other : found_)
      if (other != leaf) add(other, way / speed);
  }
  std::ranges::stable_sort(expected_, {}, &ExpectedCell::seconds);
  if (expected_.size() > most) expected_.resize(most);
  return expected_;
}

}  // namespace occlod
