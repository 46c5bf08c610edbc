#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "mesh/stream_mesh.h"
#include "mesh/piece_cutter.h"
#include "occlod/hierarchy/cut_mesh.h"
#include "occlod/io/olod.h"
#include "occlod/mesh/generate.h"
#include "occlod/scene/scene.h"
#include "scene/mesh_joiner.h"
#include "scene/mesh_source.h"
#include "scene/scene_materials.h"

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

  void forget() { read_.clear(); }

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

void add(LeftOut& sum, const LeftOut& more) {
  sum.texture_coordinates += more.texture_coordinates;
  sum.normals += more.normals;
  sum.colors += more.colors;
  sum.materials += more.materials;
  sum.groups += more.groups;
}

// HLODs and hierarchies are no mesh files.
bool is_streamable_file(const std::string& name) {
  return !is_olod_file(name) && !is_ohlod_file(name) && is_streamable(name);
}

constexpr std::size_t piece_triangles = std::size_t{1} << 18U;

// Gives the objects of a scene to a sink, one mesh at a time; generated ones and those of PLY and OBJ files are never
// whole in memory.
class SceneStreamer {
 public:
  SceneStreamer(const SceneDescription& scene, const std::filesystem::path& folder, const Progress& progress,
                hlod::TriangleSink& sink)
      : scene_(scene),
        progress_(progress),
        sink_(sink),
        reader_(scene, folder, progress),
        materials_(table_, scene.name, folder) {}

  void run() {
    const auto count = static_cast<double>(scene_.objects.size());
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
      if (progress_) progress_("reading " + scene_.name, static_cast<double>(i) / count);
      const std::string name = reader_.name(i);
      if (!std::holds_alternative<MeshFile>(scene_.objects[i].source)) {
        const MaterialId material = materials_.first_of({}, name);
        stream_generated(scene_.objects[i].source, [&](const TriangleMesh& piece) { add(piece, i, material); });
        continue;
      }
      if (is_streamable_file(name)) {
        add_file(i, name);
        continue;
      }
      streamed_.reset();
      const TriangleMesh& mesh = reader_.read_alone(i).mesh;
      const MaterialId first = materials_.first_of(mesh, name);
      PieceCutter cutter(arrays_of(mesh));
      for (std::size_t begin = 0; begin < mesh.triangle_count(); begin += piece_triangles)
        add(cutter.cut(begin, std::min(mesh.triangle_count(), begin + piece_triangles)), i, first);
    }
  }

 private:
  // Copies that follow each other are read once.
  void add_file(std::size_t object, const std::string& name) {
    reader_.forget();
    if (!streamed_ || streamed_name_ != name) {
      streamed_.reset();
      streamed_ = std::make_unique<StreamedMesh>(name, [&](double done) {
        if (progress_) progress_("reading " + name, done);
      });
      streamed_name_ = name;
    }
    streamed_->visit(piece_triangles,
                     [&](const TriangleMesh& piece) { add(piece, object, materials_.first_of(piece, name)); });
  }

  void add(const TriangleMesh& piece, std::size_t object, MaterialId first) {
    TriangleMesh placed;
    if (!piece.texture_coordinates.empty() && !origin_) origin_ = piece.texture_origin;
    placed.texture_origin = origin_.value_or(TextureOrigin::bottom_left);
    append_placed(placed, piece, scene_.objects[object].object_to_world);
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
  std::unique_ptr<StreamedMesh> streamed_;  // the newest file
  std::string streamed_name_;
};

}  // namespace

CleanMesh flatten_scene(const SceneDescription& scene, const std::filesystem::path& folder, const Progress& progress) {
  MeshReader reader(scene, folder, progress);
  MeshJoiner joiner(scene.name, folder);
  LeftOut left_out;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const CleanMesh& object = reader.read(i);
    joiner.add(object.mesh, scene.objects[i].object_to_world, reader.name(i));
    add(left_out, object.report.left_out);
  }
  CleanMesh result = clean(joiner.finish(), MeshReport{}, scene.name);
  result.report.left_out = left_out;
  return result;
}

hlod::TriangleSource stream_scene(SceneDescription scene, std::filesystem::path folder,
                                  std::function<void(const std::string& what, double done)> progress) {
  return [scene = std::move(scene), folder = std::move(folder), progress = std::move(progress)](
             hlod::TriangleSink& sink) { SceneStreamer(scene, folder, progress, sink).run(); };
}

}  // namespace occlod
