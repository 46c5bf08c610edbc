#include "hlod/build/mesh_loader.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <utility>

namespace occlod::hlod {
namespace {

// What is stored of the nodes [begin, end) of the load. Throws Error.
void read_part(MeshSource& source, MeshLoad& load, std::size_t begin, std::size_t end) {
  std::vector<std::span<std::byte>> parts;
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t bytes = source.stored(load.first + static_cast<NodeId>(i)).bytes;
    load.meshes[i] = std::make_unique_for_overwrite<std::byte[]>(bytes);
    parts.emplace_back(load.meshes[i].get(), bytes);
  }
  source.read(load.first + static_cast<NodeId>(begin), parts);
}

// Throws Error.
void unpack(MeshSource& source, MeshLoad& load, std::size_t i) {
  load.meshes[i] = source.unpack(load.first + static_cast<NodeId>(i), std::move(load.meshes[i]));
}

}  // namespace

void read_or_throw(MeshSource& source, MeshLoad& load) {
  load.problems.resize(load.meshes.size());
  read_part(source, load, 0, load.meshes.size());
  for (std::size_t i = 0; i < load.meshes.size(); ++i) unpack(source, load, i);
}

void read_meshes(MeshSource& source, MeshLoad& load) {
  load.problems.resize(load.meshes.size());
  bool is_read = true;
  try {
    read_part(source, load, 0, load.meshes.size());
  } catch (const std::exception&) {
    is_read = false;  // one by one, to tell which
  }
  for (std::size_t i = 0; i < load.meshes.size(); ++i) try {
      if (!is_read) read_part(source, load, i, i + 1);
      unpack(source, load, i);
    } catch (const std::exception& error) {
      load.meshes[i].reset();
      load.problems[i] = error.what();
    }
}

MeshLoader::MeshLoader(MeshSource& source) : source_(source), thread_([this] { run(); }) {}

MeshLoader::~MeshLoader() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void MeshLoader::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return stopped_ || !waiting_.empty(); });
    if (stopped_) return;
    MeshLoad load = std::move(waiting_.front());
    waiting_.pop_front();
    is_reading_ = true;
    lock.unlock();
    read_meshes(source_, load);
    lock.lock();
    is_reading_ = false;
    ended_.push_back(std::move(load));
    changed_.notify_all();
  }
}

void MeshLoader::push(std::vector<MeshLoad> loads) {
  {
    const std::lock_guard lock(mutex_);
    std::ranges::move(loads, std::back_inserter(waiting_));
  }
  changed_.notify_all();
}

std::vector<MeshLoad> MeshLoader::withdraw() {
  const std::lock_guard lock(mutex_);
  std::vector<MeshLoad> loads;
  std::ranges::move(waiting_, std::back_inserter(loads));
  waiting_.clear();
  return loads;
}

void MeshLoader::collect(std::deque<MeshLoad>& out, std::size_t least) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return out.size() + ended_.size() >= least || (waiting_.empty() && !is_reading_); });
  std::ranges::move(ended_, std::back_inserter(out));
  ended_.clear();
}

}  // namespace occlod::hlod
