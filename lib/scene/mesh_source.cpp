#include "scene/mesh_source.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <variant>
#include <vector>

#include "mesh/generators.h"
#include "occlod/base.h"
#include "occlod/mesh_file.h"
#include "scene/find_mesh.h"

namespace occlod {
namespace {

// "city blocks=16 facade_cells=8 seed=1": caches know meshes by it.
std::string describe(const GeneratedMesh& mesh) {
  const Generator& generator = generator_of(mesh.generator);
  const GeneratorValues values = complete_values(generator, mesh.values);
  std::string text(generator.name);
  for (const GeneratorParameter& parameter : generator.parameters)
    text += fmt::format(" {}={}", parameter.name, values.find(parameter.name)->second);
  return text;
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
  if (const auto* mesh = std::get_if<GeneratedMesh>(&source)) return describe(*mesh);
  return find_file(
      std::get<MeshFile>(source), folder,
      {scene.file.empty() ? scene.name : scene.file.string(), fmt::format("/objects/{}/mesh", index), "", ""});
}

bool is_olod_file(const std::filesystem::path& path) { return has_extension(path, ".olod"); }

bool is_ohlod_file(const std::filesystem::path& path) { return has_extension(path, ".ohlod"); }

CleanMesh read_source(const MeshSource& source, const std::string& name,
                      const std::function<void(const std::string& what, double done)>& progress) {
  if (const auto* mesh = std::get_if<GeneratedMesh>(&source))
    return clean(generate(mesh->generator, mesh->values), MeshReport{}, name);
  return read_file(name, progress);
}

}  // namespace occlod
