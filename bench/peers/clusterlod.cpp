// Builds clusters by meshoptimizer's demo/clusterlod.h, for bench_clusters: reads a mesh that it wrote, and writes
// clusters that it reads. Links nothing of occlod, which may have another meshoptimizer.
#include <meshoptimizer.h>

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#define CLUSTERLOD_IMPLEMENTATION
#include <clusterlod.h>

#include "peers/raw_clusters.h"

namespace {

using occlod::bench::RawClusters;
using occlod::bench::RawMesh;

RawClusters build(const RawMesh& mesh, const clodConfig& config) {
  RawClusters result;
  clodMesh input{};
  input.indices = mesh.indices.data();
  input.index_count = mesh.indices.size();
  input.vertex_count = mesh.positions.size() / 3;
  input.vertex_positions = mesh.positions.data();
  input.vertex_positions_stride = 3 * sizeof(float);
  clodBuild(config, input, [&](clodGroup group, const clodCluster* clusters, std::size_t count) {
    const auto id = static_cast<std::uint32_t>(result.group_errors.size());
    result.group_errors.push_back(group.simplified.error);
    for (std::size_t c = 0; c < count; ++c) {
      result.groups.push_back(id);
      result.refined.push_back(clusters[c].refined < 0 ? UINT32_MAX : static_cast<std::uint32_t>(clusters[c].refined));
      result.vertex_counts.push_back(static_cast<std::uint32_t>(clusters[c].vertex_count));
      result.index_counts.push_back(static_cast<std::uint32_t>(clusters[c].index_count));
      result.indices.insert(result.indices.end(), clusters[c].indices, clusters[c].indices + clusters[c].index_count);
    }
    return static_cast<int>(id);
  });
  return result;
}

}  // namespace

// MESH CLUSTERS MAX_TRIANGLES ROUNDS
int main(int argc, char** argv) {
  if (argc != 5) return std::fputs("usage: bench_clusterlod MESH CLUSTERS MAX_TRIANGLES ROUNDS\n", stderr), 1;
  RawMesh mesh;
  if (!occlod::bench::read_raw(argv[1], mesh)) return std::fputs("cannot read the mesh\n", stderr), 1;
  const clodConfig config = clodDefaultConfig(std::stoul(argv[3]));
  RawClusters clusters;
  std::vector<double> times;
  for (int round = 0; round < std::stoi(argv[4]); ++round) {
    const std::clock_t start = std::clock();
    clusters = build(mesh, config);
    times.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  std::sort(times.begin(), times.end());
  clusters.milliseconds = {times[times.size() / 2]};
  return occlod::bench::write_raw(argv[2], clusters) ? 0 : 1;
}
