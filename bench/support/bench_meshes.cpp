#include "support/bench_meshes.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "occlod/generate.h"
#include "occlod/mesh_file.h"
#include "occlod/scene.h"

namespace occlod::bench {
namespace {

std::optional<int> planet_level(const std::string& name) {
  const std::string prefix = "planet:";
  if (!name.starts_with(prefix)) return {};
  int level = 0;
  const char* end = name.data() + name.size();
  const auto read = std::from_chars(name.data() + prefix.size(), end, level);
  if (read.ec != std::errc() || read.ptr != end) return {};
  return level;
}

}  // namespace

std::vector<std::string> available(const std::vector<std::string>& names) {
  std::vector<std::string> found;
  for (const std::string& name : names) {
    if (planet_level(name) || !find_mesh(name, {}).empty())
      found.push_back(name);
    else
      fmt::print(stderr, "SKIPPED: {} is in no folder of OCCLOD_MESHES\n", name);
  }
  return found;
}

TriangleMesh load_bench_mesh(const std::string& name) {
  if (const auto level = planet_level(name)) return generate("rough-planet", {{"level", *level}});
  return read_mesh(find_mesh(name, {})).mesh;
}

}  // namespace occlod::bench
