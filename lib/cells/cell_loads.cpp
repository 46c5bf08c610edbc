#include "cells/cell_loads.h"

#include <algorithm>
#include <exception>

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
        found = std::make_shared<const CellAdditions>(reader_(node, additions));
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
    // What has ended meanwhile has not been collected yet.
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

}  // namespace occlod
