#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <map>
#include <utility>

#include "occlod/core/error.h"
#include "occlod/hierarchy/cut_mesh.h"
#include "occlod/io/olod.h"
#include "occlod/scene/scene.h"
#include "scene/mesh_source.h"

namespace occlod {
namespace {

using Progress = std::function<void(const std::string& what, double done)>;

CleanMesh read_finest(const std::string& file) {
  const OlodFile olod = read_olod(file);
  olod.hierarchy.require_all();
  return {cut_mesh(olod.hierarchy, full_cut(olod.hierarchy)), olod.report};
}

// What the object is made of; the same mesh only once.
class MeshReader {
 public:
  MeshReader(const SceneDescription& scene, const std::filesystem::path& folder, const Progress& progress)
      : scene_(scene), folder_(folder), progress_(progress) {}

  const CleanMesh& read(std::size_t object) {
    const MeshSource& source = scene_.objects[object].source;
    const std::string name = name_of_source(source, scene_, object, folder_);
    const auto found = read_.find(name);
    if (found != read_.end()) return found->second;
    return read_.emplace(name, is_olod_file(name) ? read_finest(name) : read_source(source, name, progress_))
        .first->second;
  }

 private:
  const SceneDescription& scene_;
  const std::filesystem::path& folder_;
  const Progress& progress_;
  std::map<std::string, CleanMesh> read_;  // by name
};

// A vertex for each wedge: clean() makes wedges of them again.
void append(TriangleMesh& all, const TriangleMesh& mesh, const glm::dmat4& object_to_world) {
  const auto first = static_cast<VertexId>(all.positions.size());
  for (const glm::vec3& p : mesh.positions) all.positions.emplace_back(object_to_world * glm::dvec4(p, 1.0));
  const glm::dmat3 linear(object_to_world);
  const glm::dmat3 normals_to_world = glm::transpose(glm::inverse(linear));
  for (const glm::vec3& normal : mesh.normals)
    all.normals.emplace_back(glm::normalize(normals_to_world * glm::dvec3(normal)));
  all.colors.insert(all.colors.end(), mesh.colors.begin(), mesh.colors.end());
  const bool is_mirrored = glm::determinant(linear) < 0.0;
  for (Triangle t : mesh.wedge_triangles()) {
    if (is_mirrored) std::swap(t.y, t.z);
    all.triangles.push_back(t + first);
  }
}

void add(LeftOut& sum, const LeftOut& more) {
  sum.texture_coordinates += more.texture_coordinates;
  sum.normals += more.normals;
  sum.colors += more.colors;
  sum.materials += more.materials;
  sum.groups += more.groups;
}

}  // namespace

CleanMesh flatten_scene(const SceneDescription& scene, const std::filesystem::path& folder, const Progress& progress) {
  MeshReader reader(scene, folder, progress);
  TriangleMesh all;
  LeftOut left_out;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const CleanMesh& object = reader.read(i);
    if (all.positions.size() + object.mesh.positions.size() > std::numeric_limits<VertexId>::max())
      throw Error({scene.name, fmt::format("/objects/{}", i), "makes 2^32 vertices or more of all objects",
                   "use fewer objects"});
    append(all, object.mesh, scene.objects[i].object_to_world);
    add(left_out, object.report.left_out);
  }
  if (all.normals.size() != all.positions.size()) all.normals.clear();
  if (all.colors.size() != all.positions.size()) all.colors.clear();
  CleanMesh result = clean(std::move(all), MeshReport{}, scene.name);
  result.report.left_out = left_out;
  return result;
}

}  // namespace occlod
