#include "mesh_names.h"

#include <iterator>
#include <system_error>

#include "occlod/scene.h"

namespace occlod::viewer {
namespace {

namespace fs = std::filesystem;

bool finds(const fs::path& name, const fs::path& folder, const fs::path& mesh) {
  const fs::path found = find_mesh(name.string(), folder);
  std::error_code missing;
  return !found.empty() && fs::equivalent(found, mesh, missing);
}

std::ptrdiff_t steps_up(const fs::path& relative) {
  std::ptrdiff_t steps = 0;
  for (const fs::path& step : relative) steps += step == ".." ? 1 : 0;
  return steps;
}

}  // namespace

std::string name_in_scene(const fs::path& mesh, const fs::path& folder) {
  const fs::path from = (folder.empty() ? fs::current_path() : fs::absolute(folder)).lexically_normal();
  const fs::path to = fs::absolute(mesh).lexically_normal();
  const fs::path relative = to.lexically_relative(from);
  if (steps_up(relative) == 0 && finds(relative, from, to)) return relative.string();

  fs::path end;
  for (auto step = to.end(); std::prev(step) != to.begin();) {
    --step;
    end = end.empty() ? *step : *step / end;
    if (finds(end, from, to)) return end.string();
  }
  if (steps_up(relative) == 1 && from.parent_path() != from.root_path() && finds(relative, from, to))
    return relative.string();
  return to.string();
}

}  // namespace occlod::viewer
