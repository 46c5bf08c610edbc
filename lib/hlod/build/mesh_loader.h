// Reads and checks meshes, on a thread of its own.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "hlod/build/mesh_source.h"
#include "hlod/store/node_cache.h"

namespace occlod::hlod {

// Consecutive nodes whose meshes lie side by side, to be read together.
struct MeshLoad {
  NodeId first = 0;
  std::size_t bytes = 0;              // as they are stored
  std::vector<MeshBytes> meshes;      // of the nodes from `first` on; null before they are read, and where that failed
  std::vector<std::string> problems;  // of each, one line if it failed
};

// Reads on the calling thread. Throws Error for the first that fails.
void read_or_throw(MeshSource& source, MeshLoad& load);
// Likewise, but does not throw.
void read_meshes(MeshSource& source, MeshLoad& load);

class MeshLoader {
 public:
  // The source outlives the loader.
  explicit MeshLoader(MeshSource& source);
  // Waits for the load that has begun.
  ~MeshLoader();
  MeshLoader(const MeshLoader&) = delete;
  MeshLoader& operator=(const MeshLoader&) = delete;

  // After all that were pushed before.
  void push(std::vector<MeshLoad> loads);
  // Those that have not begun, in order.
  [[nodiscard]] std::vector<MeshLoad> withdraw();
  // Appends those that have ended, in order; waits until `out` has so many or none is left.
  void collect(std::deque<MeshLoad>& out, std::size_t least = 0);

 private:
  void run();

  MeshSource& source_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<MeshLoad> waiting_, ended_;
  bool is_reading_ = false, stopped_ = false;
  std::thread thread_;
};

}  // namespace occlod::hlod
