#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "occlod/core/error.h"
#include "occlod/hierarchy/cut_mesh.h"
#include "occlod/io/olod.h"
#include "occlod/mesh/generate.h"
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

  [[nodiscard]] std::string name(std::size_t object) const {
    return name_of_source(scene_.objects[object].source, scene_, object, folder_);
  }

  // The same, with no other mesh in memory.
  const CleanMesh& read_alone(std::size_t object) {
    if (!read_.contains(name(object))) read_.clear();
    return read(object);
  }

  const CleanMesh& read(std::size_t object) {
    const MeshSource& source = scene_.objects[object].source;
    const std::string name = this->name(object);
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

// The materials and textures of all meshes, each mesh's once.
class SceneMaterials {
 public:
  // `all` gets them; names of image files become relative to `folder`, or absolute where they lie elsewhere.
  SceneMaterials(TriangleMesh& all, const std::filesystem::path& folder, const SceneDescription& scene)
      : all_(all), folder_(folder), scene_(scene) {}

  // Those of the triangles of a mesh, the last ones of `all`. `name`: of its source.
  void add_triangles(const TriangleMesh& mesh, const std::string& name) {
    const MaterialId first = first_of(mesh, name);
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
      all_.triangle_materials.push_back(static_cast<MaterialId>(first + mesh.material_of(t)));
  }

  // The first of the mesh's materials among those of all.
  MaterialId first_of(const TriangleMesh& mesh, const std::string& name) {
    const auto [found, is_new] = first_of_.try_emplace(mesh.materials.empty() ? std::string() : name, MaterialId{0});
    if (is_new) found->second = add_materials(mesh, name);
    return found->second;
  }

  // Whether any mesh so far has some.
  [[nodiscard]] bool any() const {
    return first_of_.size() > 1 || (first_of_.size() == 1 && !first_of_.begin()->first.empty());
  }

  // After all objects. A scene without materials says nothing of them.
  void finish() {
    if (any()) return;
    all_.materials.clear();
    all_.triangle_materials.clear();
  }

 private:
  MaterialId add_materials(const TriangleMesh& mesh, const std::string& name) {
    const std::size_t first = all_.materials.size(), first_texture = all_.textures.size();
    const std::size_t count = std::max<std::size_t>(mesh.materials.size(), 1);  // plain where it has none
    constexpr std::size_t most = std::numeric_limits<MaterialId>::max();
    if (first + count > most || first_texture + mesh.textures.size() > most)
      throw Error({scene_.name, name, "makes more than 65,535 materials or textures of all objects",
                   "use fewer objects that have their own"});
    all_.materials.insert(all_.materials.end(), mesh.materials.begin(), mesh.materials.end());
    all_.materials.resize(first + count);
    for (std::size_t m = first; m < all_.materials.size(); ++m)
      if (TextureId& texture = all_.materials[m].texture; texture != no_texture)
        texture = static_cast<TextureId>(texture + first_texture);
    for (Texture texture : mesh.textures) {
      texture.file = name_of_image(texture.file, std::filesystem::path(name).parent_path());
      all_.textures.push_back(std::move(texture));
    }
    return static_cast<MaterialId>(first);
  }

  [[nodiscard]] std::string name_of_image(std::string file, const std::filesystem::path& mesh_folder) const {
    if (file.empty()) return file;
    std::replace(file.begin(), file.end(), '\\', '/');  // in files made on other systems
    const auto absolute = [](const std::filesystem::path& path) {
      return std::filesystem::absolute(path).lexically_normal();
    };
    const std::filesystem::path image = absolute(mesh_folder / file);
    const std::filesystem::path near = image.lexically_relative(absolute(folder_ / "."));
    return (near.empty() || *near.begin() == ".." ? image : near).generic_string();
  }

  TriangleMesh& all_;
  std::filesystem::path folder_;
  const SceneDescription& scene_;
  std::map<std::string, MaterialId> first_of_;  // by the mesh's name; "": of those that have none
};

// Objects without any have (0, 0).
void append_texture_coordinates(TriangleMesh& all, const TriangleMesh& mesh, VertexId first) {
  if (mesh.texture_coordinates.empty()) return;
  all.texture_coordinates.resize(first, glm::vec2(0.0F));
  for (glm::vec2 at : mesh.texture_coordinates) {
    if (mesh.texture_origin != all.texture_origin) at.y = 1.0F - at.y;
    all.texture_coordinates.push_back(at);
  }
}

// A vertex for each wedge: clean() makes wedges of them again.
void append(TriangleMesh& all, const TriangleMesh& mesh, const glm::dmat4& object_to_world) {
  const auto first = static_cast<VertexId>(all.positions.size());
  for (const glm::vec3& p : mesh.positions) all.positions.emplace_back(object_to_world * glm::dvec4(p, 1.0));
  const glm::dmat3 linear(object_to_world);
  const glm::dmat3 normals_to_world = glm::transpose(glm::inverse(linear));
  for (const glm::vec3& normal : mesh.normals)
    all.normals.emplace_back(glm::normalize(normals_to_world * glm::dvec3(normal)));
  all.colors.insert(all.colors.end(), mesh.colors.begin(), mesh.colors.end());
  append_texture_coordinates(all, mesh, first);
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

constexpr std::size_t piece_triangles = std::size_t{1} << 18U;

// A run of triangles of a mesh and the vertices that they use.
class PieceCutter {
 public:
  explicit PieceCutter(const TriangleMesh& mesh) : mesh_(mesh), local_(mesh.wedge_count(), no_id) {}

  [[nodiscard]] TriangleMesh cut(std::size_t begin, std::size_t end) {
    TriangleMesh piece;
    std::vector<WedgeId> wedges;
    for (std::size_t t = begin; t < end; ++t) {
      Triangle triangle = mesh_.wedge_triangles()[t];
      for (int k = 0; k < 3; ++k) {
        VertexId& local = local_[triangle[k]];
        if (local == no_id) {
          local = static_cast<VertexId>(wedges.size());
          wedges.push_back(triangle[k]);
        }
        triangle[k] = local;
      }
      piece.triangles.push_back(triangle);
      if (!mesh_.triangle_materials.empty()) piece.triangle_materials.push_back(mesh_.triangle_materials[t]);
    }
    const auto gather = [&](const auto& from, auto& to) {
      if (from.empty()) return;
      for (const WedgeId wedge : wedges) to.push_back(from[wedge]);
    };
    gather(mesh_.positions, piece.positions);
    gather(mesh_.normals, piece.normals);
    gather(mesh_.colors, piece.colors);
    gather(mesh_.texture_coordinates, piece.texture_coordinates);
    piece.texture_origin = mesh_.texture_origin;
    for (const WedgeId wedge : wedges) local_[wedge] = no_id;
    return piece;
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<VertexId> local_;  // by wedge, of the piece that is cut
};

// Gives the objects of a scene to a sink, one mesh in memory at a time.
class SceneStreamer {
 public:
  SceneStreamer(const SceneDescription& scene, const std::filesystem::path& folder, const Progress& progress,
                hlod::TriangleSink& sink)
      : scene_(scene),
        progress_(progress),
        sink_(sink),
        reader_(scene, folder, progress),
        materials_(table_, folder, scene) {}

  void run() {
    const auto count = static_cast<double>(scene_.objects.size());
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
      if (progress_) progress_("reading " + scene_.name, static_cast<double>(i) / count);
      if (const auto* planet = std::get_if<RoughPlanetOptions>(&scene_.objects[i].source)) {
        const MaterialId material = materials_.first_of({}, reader_.name(i));
        stream_rough_planet(*planet, [&](const TriangleMesh& piece) { add(piece, i, material); });
        continue;
      }
      const TriangleMesh& mesh = reader_.read_alone(i).mesh;
      const MaterialId first = materials_.first_of(mesh, reader_.name(i));
      PieceCutter cutter(mesh);
      for (std::size_t begin = 0; begin < mesh.triangle_count(); begin += piece_triangles)
        add(cutter.cut(begin, std::min(mesh.triangle_count(), begin + piece_triangles)), i, first);
    }
  }

 private:
  void add(const TriangleMesh& piece, std::size_t object, MaterialId first) {
    TriangleMesh placed;
    if (!piece.texture_coordinates.empty() && !origin_) origin_ = piece.texture_origin;
    placed.texture_origin = origin_.value_or(TextureOrigin::bottom_left);
    append(placed, piece, scene_.objects[object].object_to_world);
    if (materials_.any()) {
      placed.materials = table_.materials;
      placed.textures = table_.textures;
      for (std::size_t t = 0; t < piece.triangle_count(); ++t)
        placed.triangle_materials.push_back(static_cast<MaterialId>(first + piece.material_of(t)));
    }
    sink_.add(placed);
  }

  const SceneDescription& scene_;
  const Progress& progress_;
  hlod::TriangleSink& sink_;
  MeshReader reader_;
  TriangleMesh table_;  // materials and textures so far
  SceneMaterials materials_;
  std::optional<TextureOrigin> origin_;
};

}  // namespace

CleanMesh flatten_scene(const SceneDescription& scene, const std::filesystem::path& folder, const Progress& progress) {
  MeshReader reader(scene, folder, progress);
  TriangleMesh all;
  SceneMaterials materials(all, folder, scene);
  LeftOut left_out;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const CleanMesh& object = reader.read(i);
    if (all.positions.size() + object.mesh.positions.size() > std::numeric_limits<VertexId>::max())
      throw Error({scene.name, fmt::format("/objects/{}", i), "makes 2^32 vertices or more of all objects",
                   "use fewer objects"});
    if (all.texture_coordinates.empty()) all.texture_origin = object.mesh.texture_origin;
    append(all, object.mesh, scene.objects[i].object_to_world);
    materials.add_triangles(object.mesh, reader.name(i));
    add(left_out, object.report.left_out);
  }
  if (all.normals.size() != all.positions.size()) all.normals.clear();
  if (all.colors.size() != all.positions.size()) all.colors.clear();
  if (!all.texture_coordinates.empty()) all.texture_coordinates.resize(all.positions.size(), glm::vec2(0.0F));
  materials.finish();
  CleanMesh result = clean(std::move(all), MeshReport{}, scene.name);
  result.report.left_out = left_out;
  return result;
}

hlod::TriangleSource stream_scene(SceneDescription scene, std::filesystem::path folder,
                                  std::function<void(const std::string& what, double done)> progress) {
  return [scene = std::move(scene), folder = std::move(folder), progress = std::move(progress)](
             hlod::TriangleSink& sink) { SceneStreamer(scene, folder, progress, sink).run(); };
}

}  // namespace occlod
