// Meshes and clusters as files, between programs that cannot be linked together.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace occlod::bench {

struct RawMesh {
  std::vector<float> positions;  // three for each vertex
  std::vector<std::uint32_t> indices;

  template <typename Visit>
  void visit_arrays(const Visit& visit) {
    visit(positions), visit(indices);
  }
};

// Clusters as clusterlod.h gives them.
struct RawClusters {
  std::vector<double> milliseconds;                        // one: the median of the rounds
  std::vector<float> group_errors;                         // the largest float: nothing replaces the group
  std::vector<std::uint32_t> groups;                       // by cluster
  std::vector<std::uint32_t> refined;                      // by cluster; the largest integer: of the input
  std::vector<std::uint32_t> vertex_counts, index_counts;  // by cluster
  std::vector<std::uint32_t> indices;                      // cluster by cluster

  template <typename Visit>
  void visit_arrays(const Visit& visit) {
    visit(milliseconds), visit(group_errors), visit(groups), visit(refined), visit(vertex_counts), visit(index_counts),
        visit(indices);
  }
};

// Writes an array after the other, each behind its length. Returns whether that went well.
template <typename Arrays>
bool write_raw(const std::string& path, Arrays& arrays) {
  std::ofstream file(path, std::ios::binary);
  arrays.visit_arrays([&](const auto& values) {
    const std::uint64_t count = values.size();
    file.write(reinterpret_cast<const char*>(&count), sizeof(count));
    file.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(count * sizeof(values[0])));
  });
  return static_cast<bool>(file.flush());
}

template <typename Arrays>
bool read_raw(const std::string& path, Arrays& arrays) {
  std::ifstream file(path, std::ios::binary);
  arrays.visit_arrays([&](auto& values) {
    std::uint64_t count = 0;
    if (!file.read(reinterpret_cast<char*>(&count), sizeof(count))) return;
    values.resize(count);
    file.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(values[0])));
  });
  return static_cast<bool>(file);
}

}  // namespace occlod::bench
