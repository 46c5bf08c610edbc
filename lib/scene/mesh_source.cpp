#include "scene/mesh_source.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <variant>
#include <vector>

#include "occlod/base.h"
#include "occlod/mesh_file.h"
#include "scene/find_mesh.h"

namespace occlod {
namespace {

std::string describe(const RoughPlanetOptions& o) {
  return fmt::format("rough-planet level={} seed={} amplitude={} frequency={} octaves={}", o.level, o.seed, o.amplitude,
                     o.frequency, o.octaves);
}
std::string describe(const CityOptions& o) {
  return fmt::format("city blocks={} facade_cells={} seed={}", o.blocks, o.facade_cells, o.seed);
}
std::string describe(const PipesOptions& o) {
  return fmt::format("pipes pipes={} bends={} sides={} seed={}", o.pipes, o.bends, o.sides, o.seed);
}
std::string describe(const PlantOptions& o) {
  return fmt::format("plant storeys={} bays={} pipes={} bends={} sides={} seed={}", o.storeys, o.bays, o.pipes, o.bends,
                     o.sides, o.seed);
}
std::string describe(const SpheresBehindWallOptions& o) {
  return fmt::format("spheres-behind-wall spheres={} level={} wall_cells={} seed={}", o.spheres, o.level, o.wall_cells,
                     o.seed);
}

TriangleMesh generate(const RoughPlanetOptions& options) { return generate_rough_planet(options); }
TriangleMesh generate(const CityOptions& options) { return generate_city(options); }
TriangleMesh generate(const PipesOptions& options) { return generate_pipes(options); }
TriangleMesh generate(const PlantOptions& options) { return generate_plant(options); }
TriangleMesh generate(const SpheresBehindWallOptions& options) { return generate_spheres_behind_wall(options); }

void stream(const RoughPlanetOptions& options, const PartVisitor& visit) { stream_rough_planet(options, visit); }
void stream(const CityOptions& options, const PartVisitor& visit) { stream_city(options, visit); }
void stream(const PipesOptions& options, const PartVisitor& visit) { stream_pipes(options, visit); }
void stream(const PlantOptions& options, const PartVisitor& visit) { stream_plant(options, visit); }
void stream(const SpheresBehindWallOptions& options, const PartVisitor& visit) {
  stream_spheres_behind_wall(options, visit);
}

std::string find_file(const MeshFile& file, const std::filesystem::path& folder, Diagnosis missing) {
  for (const std::string& name : file.names)
    if (const std::filesystem::path path = find_mesh(name, folder); !path.empty()) return path.string();
  std::vector<std::string> searched;
  for (const std::filesystem::path& other : mesh_folders(folder))
    searched.push_back(other.empty() ? "." : other.string());
  missing.problem =
      fmt::format("there is no file {}; searched: {}", fmt::join(file.names, " or "), fmt::join(searched, ", "));
  missing.remedy = "put it into one of these folders, or set OCCLOD_MESHES to the one that holds it";
  throw Error(missing);
}

// Compares the extension, which includes the dot, ignoring case; `wanted` is in lower case.
bool has_extension(const std::filesystem::path& path, const char* wanted) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension == wanted;
}

CleanMesh read_file(const std::string& name,
                    const std::function<void(const std::string& what, double done)>& progress) {
  if (is_ohlod_file(name))
    throw Error({name, "", "is an HLOD, not a mesh",
                 "draw it with occlod hlod render, or name the mesh that it was built from"});
  return read_mesh(name, [&](double done) {
    if (progress) progress("reading " + name, done);
  });
}

}  // namespace

std::string name_of_source(const MeshSource& source, const SceneDescription& scene, std::size_t index,
                           const std::filesystem::path& folder) {
  if (const auto* file = std::get_if<MeshFile>(&source))
    return find_file(
        *file, folder,
        {scene.file.empty() ? scene.name : scene.file.string(), fmt::format("/objects/{}/mesh", index), "", ""});
  return std::visit(
      [](const auto& options) -> std::string {
        if constexpr (std::is_same_v<std::decay_t<decltype(options)>, MeshFile>)
          return "";
        else
          return describe(options);
      },
      source);
}

bool is_olod_file(const std::filesystem::path& path) { return has_extension(path, ".olod"); }

bool is_ohlod_file(const std::filesystem::path& path) { return has_extension(path, ".ohlod"); }

void stream_generated(const MeshSource& source, const std::function<void(const TriangleMesh& piece)>& take) {
  std::visit(
      [&](const auto& options) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(options)>, MeshFile>)
          stream(options, [&](const TriangleMesh& part, std::size_t) { take(part); });
      },
      source);
}

CleanMesh read_source(const MeshSource& source, const std::string& name,
                      const std::function<void(const std::string& what, double done)>& progress) {
  return std::visit(
      [&](const auto& options) {
        if constexpr (std::is_same_v<std::decay_t<decltype(options)>, MeshFile>)
          return read_file(name, progress);
        else
          return clean(generate(options), MeshReport{}, name);
      },
      source);
}

}  // namespace occlod
