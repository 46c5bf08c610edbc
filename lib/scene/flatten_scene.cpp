#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mesh/materials.h"
#include "mesh/mesh_report.h"
#include "mesh/origin.h"
#include "mesh/stream_mesh.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "occlod/mesh.h"
#include "occlod/scene.h"
#include "scene/mesh_source.h"

namespace occlod {
namespace {

// Merges the materials and textures of meshes that become one.

// Collects the materials and textures of all meshes, each mesh's once.
class SceneMaterials {
 public:
  // Writes to `all`; names of image files become relative to `folder`, or absolute where they lie elsewhere. `name`
  // names the whole in errors.
  SceneMaterials(TriangleMesh& all, std::string name, std::filesystem::path folder);

  // Adds the materials of a mesh, whose triangles are the last ones of `all`. `name` names its source.
  void add_triangles(const TriangleMesh& mesh, const std::string& name);

  // Returns the id in the merged list of the mesh's first material. Throws Error when there would be too many.
  MaterialId first_of(const TriangleMesh& mesh, const std::string& name);

  // Returns whether any mesh so far has materials.
  [[nodiscard]] bool any() const;

  // Finishes after all objects. A scene without materials gets no material ids.
  void finish();

 private:
  MaterialId add_materials(const TriangleMesh& mesh, const std::string& name);
  [[nodiscard]] std::string name_of_image(std::string file, const std::filesystem::path& mesh_folder) const;

  TriangleMesh& all_;
  std::string name_;
  std::filesystem::path folder_;
  // by the mesh's name; nullopt: shared by meshes without materials
  std::map<std::optional<std::string>, MaterialId> first_of_;
};

SceneMaterials::SceneMaterials(TriangleMesh& all, std::string name, std::filesystem::path folder)
    : all_(all), name_(std::move(name)), folder_(std::move(folder)) {}

void SceneMaterials::add_triangles(const TriangleMesh& mesh, const std::string& name) {
  const MaterialId first = first_of(mesh, name);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    all_.triangle_materials.push_back(static_cast<MaterialId>(first + mesh.material_of(t)));
}

MaterialId SceneMaterials::first_of(const TriangleMesh& mesh, const std::string& name) {
  const std::optional<std::string> key = mesh.materials.empty() ? std::nullopt : std::optional(name);
  const auto [found, is_new] = first_of_.try_emplace(key, MaterialId{0});
  if (is_new) found->second = add_materials(mesh, name);
  return found->second;
}

bool SceneMaterials::any() const {
  return std::ranges::any_of(first_of_, [](const auto& entry) { return entry.first.has_value(); });
}

void SceneMaterials::finish() {
  if (any()) return;
  all_.materials.clear();
  all_.triangle_materials.clear();
}

MaterialId SceneMaterials::add_materials(const TriangleMesh& mesh, const std::string& name) {
  const std::size_t first = all_.materials.size(), first_texture = all_.textures.size();
  // meshes without materials get a plain one
  const std::size_t count = std::max<std::size_t>(mesh.materials.size(), 1);
  constexpr std::size_t most = std::numeric_limits<MaterialId>::max();
  if (first + count > most || first_texture + mesh.textures.size() > most)
    throw Error({name_, name, "makes more than 65,535 materials or textures of all objects",
                 "use fewer objects that have their own"});
  all_.materials.insert(all_.materials.end(), mesh.materials.begin(), mesh.materials.end());
  all_.materials.resize(first + count);
  for (std::size_t m = first; m < all_.materials.size(); ++m)
    change_textures(all_.materials[m], [&](TextureId id) { return static_cast<TextureId>(id + first_texture); });
  for (Texture texture : mesh.textures) {
    texture.file = name_of_image(texture.file, std::filesystem::path(name).parent_path());
    all_.textures.push_back(std::move(texture));
  }
  return static_cast<MaterialId>(first);
}

std::string SceneMaterials::name_of_image(std::string file, const std::filesystem::path& mesh_folder) const {
  if (file.empty()) return file;
  std::replace(file.begin(), file.end(), '\\', '/');  // paths in files made on other systems
  const auto absolute = [](const std::filesystem::path& path) {
    return std::filesystem::absolute(path).lexically_normal();
  };
  const std::filesystem::path image = absolute(mesh_folder / file);
  const std::filesystem::path near = image.lexically_relative(absolute(folder_ / "."));
  return (near.empty() || *near.begin() == ".." ? image : near).generic_string();
}

// Collects the features of the objects of a scene, each object's its own. Objects without share one without a name.
class SceneFeatures {
 public:
  // Adds to `names`, which outlives it.
  explicit SceneFeatures(std::vector<std::string>& names) : names_(names) {}

  // Begins the next object, whose mesh has these names.
  void begin(const std::vector<std::string>& of_object) {
    is_named_ = !of_object.empty();
    if (!is_named_) {
      if (!names_.empty()) unnamed();
      has_unnamed_ = true;
      return;
    }
    if (has_unnamed_) unnamed();  // becomes the first, which those before have
    first_ = static_cast<FeatureId>(names_.size());
    names_.insert(names_.end(), of_object.begin(), of_object.end());
  }
  // Appends the features of a mesh of the object to those of the `count` triangles before, unless all have the first.
  void append(const TriangleMesh& mesh, std::size_t count, std::vector<FeatureId>& all) const {
    if (names_.size() < 2) return;
    all.resize(count, 0);
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
      all.push_back(is_named_ ? first_ + mesh.feature_of(t) : *unnamed_);
  }

 private:
  void unnamed() {
    if (unnamed_) return;
    unnamed_ = static_cast<FeatureId>(names_.size());
    names_.emplace_back();
  }

  std::vector<std::string>& names_;
  std::optional<FeatureId> unnamed_;
  FeatureId first_ = 0;
  bool is_named_ = false, has_unnamed_ = false;
};

// Tells whether the positions of a mesh that is placed so are already relative to the origin, 0 not being one.
bool has_origin(const TriangleMesh& mesh, const glm::dmat4& object_to_world, const glm::dvec3& origin) {
  return origin != glm::dvec3(0.0) && mesh.origin == origin &&
         object_to_world == positions_to_world(glm::dmat4(1.0), origin);
}

void add_places(OriginChooser& chooser, const TriangleMesh& mesh, const glm::dmat4& object_to_world) {
  for (const glm::vec3& p : mesh.positions) {
    if (chooser.is_settled()) return;
    chooser.add(glm::dvec3(object_to_world * glm::dvec4(p, 1.0)));
  }
}

// Joins placed meshes into one, with a vertex for each wedge.

class MeshJoiner {
 public:
  // `name` names the whole in errors. `folder`: see SceneMaterials. `origin` is that of the whole.
  MeshJoiner(std::string name, const std::filesystem::path& folder, const Origin& origin);
  MeshJoiner(const MeshJoiner&) = delete;
  MeshJoiner& operator=(const MeshJoiner&) = delete;
  ~MeshJoiner() = default;

  // Adds a mesh. `source_name` is that of its file or generator; meshes of one name share their materials. Throws Error
  // when all together have 2^32 vertices or more, or too many materials.
  void add(const TriangleMesh& mesh, const glm::dmat4& object_to_world, const std::string& source_name);

  // Returns the joined mesh, without extra wedges. It has normals and colours only when every mesh has them.
  [[nodiscard]] TriangleMesh finish();

 private:
  std::string name_;
  Origin origin_;
  TriangleMesh all_;
  SceneMaterials materials_;  // of all_
  SceneFeatures features_;    // of all_
  std::size_t count_ = 0;     // number of meshes
};

// Appends texture coordinates; (0, 0) for objects without any.
void append_texture_coordinates(TriangleMesh& all, const TriangleMesh& mesh, VertexId first) {
  if (mesh.texture_coordinates.empty()) return;
  all.texture_coordinates.resize(first, glm::vec2(0.0F));
  for (glm::vec2 at : mesh.texture_coordinates) {
    if (mesh.texture_origin != all.texture_origin) at.y = 1.0F - at.y;
    all.texture_coordinates.push_back(at);
  }
}

// Appends everything except materials and features. Once any mesh has texture coordinates, earlier vertices without
// them get (0, 0). `object_to_world` is that of the mesh's positions, `origin` that of all.
void append_placed(TriangleMesh& all, const TriangleMesh& mesh, const glm::dmat4& object_to_world,
                   const Origin& origin) {
  const auto first = static_cast<VertexId>(all.positions.size());
  all.origin = origin.at;
  const glm::dmat3 linear(object_to_world);
  const bool stays = origin.at == glm::dvec3(0.0) && object_to_world == glm::dmat4(1.0);
  if (stays || has_origin(mesh, object_to_world, origin.at)) {  // to the bit, as when the mesh is read alone
    all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    all.normals.insert(all.normals.end(), mesh.normals.begin(), mesh.normals.end());
  } else {
    for (const glm::vec3& p : mesh.positions)
      all.positions.push_back(origin.position_of(glm::dvec3(object_to_world * glm::dvec4(p, 1.0))));
    const glm::dmat3 normals_to_world = glm::transpose(glm::inverse(linear));
    for (const glm::vec3& normal : mesh.normals)
      all.normals.emplace_back(glm::normalize(normals_to_world * glm::dvec3(normal)));
  }
  all.colors.insert(all.colors.end(), mesh.colors.begin(), mesh.colors.end());
  append_texture_coordinates(all, mesh, first);
  const bool is_mirrored = glm::determinant(linear) < 0.0;
  for (Triangle t : mesh.wedge_triangles()) {
    if (is_mirrored) std::swap(t.y, t.z);
    all.triangles.push_back(t + first);
  }
}

// Returns the axis that points up once a mesh is placed: y if the mesh's y is nearest to it. A mesh of another format
// does not say what its axes are.
UpAxis placed_up(UpAxis up, const glm::dmat4& object_to_world) {
  const glm::dvec3 y(object_to_world[1]);
  return up == UpAxis::y && y.y > std::max(std::abs(y.x), std::abs(y.z)) ? UpAxis::y : UpAxis::z;
}

MeshJoiner::MeshJoiner(std::string name, const std::filesystem::path& folder, const Origin& origin)
    : name_(std::move(name)), origin_(origin), materials_(all_, name_, folder), features_(all_.feature_names) {}

void MeshJoiner::add(const TriangleMesh& mesh, const glm::dmat4& object_to_world, const std::string& source_name) {
  if (all_.positions.size() + mesh.positions.size() > std::numeric_limits<VertexId>::max())
    throw Error(
        {name_, fmt::format("/objects/{}", count_), "makes 2^32 vertices or more of all objects", "use fewer objects"});
  if (all_.texture_coordinates.empty()) all_.texture_origin = mesh.texture_origin;
  features_.begin(mesh.feature_names);
  features_.append(mesh, all_.triangles.size(), all_.triangle_features);
  append_placed(all_, mesh, object_to_world, origin_);
  materials_.add_triangles(mesh, source_name);
  const UpAxis up = placed_up(mesh.up, object_to_world);
  all_.up = count_ == 0 || up == all_.up ? up : UpAxis::z;
  ++count_;
}

TriangleMesh MeshJoiner::finish() {
  const std::size_t vertices = all_.positions.size();
  if (all_.normals.size() != vertices) all_.normals.clear();
  if (all_.colors.size() != vertices) all_.colors.clear();
  if (!all_.texture_coordinates.empty()) all_.texture_coordinates.resize(vertices, glm::vec2(0.0F));
  materials_.finish();
  return std::move(all_);
}

// Joins meshes, with an origin where they need one.
TriangleMesh join(std::span<const PlacedMesh> meshes, const std::filesystem::path& folder, const std::string& name) {
  Origin origin;
  if (meshes.size() == 1 && has_origin(*meshes[0].mesh, meshes[0].object_to_world, meshes[0].mesh->origin)) {
    origin.at = meshes[0].mesh->origin;
  } else {
    OriginChooser chooser;
    for (const PlacedMesh& placed : meshes) add_places(chooser, *placed.mesh, placed.object_to_world);
    origin = chooser.choose();
  }
  MeshJoiner joiner(name, folder, origin);
  for (const PlacedMesh& placed : meshes) joiner.add(*placed.mesh, placed.object_to_world, placed.source_name);
  return joiner.finish();
}

using Progress = std::function<void(const std::string& what, double done)>;

CleanMesh read_finest(const std::string& file) {
  const OlodFile olod = read_olod(file);
  olod.hierarchy.require_all();
  CleanMesh finest{cut_mesh(olod.hierarchy, full_cut(olod.hierarchy)), olod.report};
  if (finest.report.vertices_read == 0) {  // whoever wrote the file told nothing of its mesh
    finest.report.vertices_read = finest.mesh.vertex_count();
    finest.report.polygons_read = finest.report.triangles_read = finest.mesh.triangle_count();
  }
  return finest;
}

// Reads the meshes of objects; reads the same mesh only once.
class MeshReader {
 public:
  MeshReader(const SceneDescription& scene, const std::filesystem::path& folder, const Progress& progress)
      : scene_(scene), folder_(folder), progress_(progress) {}

  [[nodiscard]] std::string name(std::size_t object) const {
    return name_of_source(scene_.objects[object].source, scene_, object, folder_);
  }

  // Reads an object's mesh after freeing all others.
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

// Excludes HLODs and hierarchies, which are not mesh files.
bool is_streamable_file(const std::string& name) {
  return !is_olod_file(name) && !is_ohlod_file(name) && is_streamable(name);
}

constexpr std::size_t piece_triangles = std::size_t{1} << 18U;

// Passes the objects of a scene to a sink, one mesh at a time; generated meshes and those of PLY and OBJ files are
// never completely in memory.
class SceneStreamer {
 public:
  SceneStreamer(const SceneDescription& scene, const std::filesystem::path& folder, const Progress& progress,
                hlod::TriangleSink& sink)
      : scene_(scene),
        progress_(progress),
        sink_(sink),
        reader_(scene, folder, progress),
        materials_(table_, scene.name, folder),
        features_(table_.feature_names) {}

  // `origin` is that of find_origin().
  void run(const Origin& origin) {
    whole_ = origin;
    const auto count = static_cast<double>(scene_.objects.size());
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
      if (progress_) progress_("reading " + scene_.name, static_cast<double>(i) / count);
      const std::string name = reader_.name(i);
      bool is_first = true;
      visit(i, [&](const TriangleMesh& piece, const TriangleMesh& look) {
        if (std::exchange(is_first, false)) features_.begin(look.feature_names);
        add(piece, i, materials_.first_of(look, name));
      });
      sink_.add_counts(counts_of(i));
    }
  }

  // Returns the origin of all objects together. Reads them, as far as needed: where the first ones show that none is
  // needed, no more than these.
  Origin find_origin() {
    if (scene_.objects.size() == 1 && scene_.objects[0].object_to_world == glm::dmat4(1.0))
      return {origin_of_first(), 0.0};
    OriginChooser chooser;
    for (std::size_t i = 0; i < scene_.objects.size() && !chooser.is_settled(); ++i)
      visit(i, [&](const TriangleMesh& piece, const TriangleMesh&) { add_places(chooser, piece, place_of(i, piece)); });
    return chooser.choose();
  }

 private:
  // Calls take(piece, look), where `look` has the materials of the object, and the names of its features.
  template <typename Take>
  void visit(std::size_t object, const Take& take) {
    const std::string name = reader_.name(object);
    if (const auto* mesh = std::get_if<GeneratedMesh>(&scene_.objects[object].source)) {
      const TriangleMesh plain;
      generated_ = {};
      stream_generated(mesh->generator, mesh->values, [&](const TriangleMesh& piece, std::size_t repeated) {
        generated_.vertices_read += piece.vertex_count() - repeated;
        generated_.polygons_read = generated_.triangles_read += piece.triangle_count();
        take(piece, plain);
      });
      return;
    }
    if (is_streamable_file(name)) {
      open_file(name);
      streamed_->visit(piece_triangles, [&](const TriangleMesh& piece) { take(piece, piece); });
      return;
    }
    streamed_.reset();
    const TriangleMesh& mesh = reader_.read_alone(object).mesh;
    PieceCutter cutter(arrays_of(mesh));
    for (std::size_t begin = 0; begin < mesh.triangle_count(); begin += piece_triangles)
      take(cutter.cut(begin, std::min(mesh.triangle_count(), begin + piece_triangles)), mesh);
  }

  // Returns what was counted when visit() read an object, which it has just done.
  const MeshReport& counts_of(std::size_t object) {
    if (std::holds_alternative<GeneratedMesh>(scene_.objects[object].source)) return generated_;
    return is_streamable_file(reader_.name(object)) ? streamed_->report() : reader_.read(object).report;
  }

  glm::dvec3 origin_of_first() {
    if (std::holds_alternative<GeneratedMesh>(scene_.objects[0].source)) return glm::dvec3(0.0);
    if (!is_streamable_file(reader_.name(0))) return reader_.read_alone(0).mesh.origin;
    open_file(reader_.name(0));
    return streamed_->origin();
  }

  // Reads consecutive copies of a file once.
  void open_file(const std::string& name) {
    reader_.forget();
    if (!streamed_ || streamed_name_ != name) {
      streamed_.reset();
      streamed_ = std::make_unique<StreamedMesh>(name, [&](double done) {
        if (progress_) progress_("reading " + name, done);
      });
      streamed_name_ = name;
    }
  }

  [[nodiscard]] glm::dmat4 place_of(std::size_t object, const TriangleMesh& piece) const {
    return positions_to_world(scene_.objects[object].object_to_world, piece.origin);
  }

  void add(const TriangleMesh& piece, std::size_t object, MaterialId first) {
    TriangleMesh placed;
    if (!piece.texture_coordinates.empty() && !origin_) origin_ = piece.texture_origin;
    placed.texture_origin = origin_.value_or(piece.texture_origin);
    append_placed(placed, piece, place_of(object, piece), whole_);
    const UpAxis up = placed_up(piece.up, scene_.objects[object].object_to_world);
    up_ = !up_ || *up_ == up ? up : UpAxis::z;
    placed.up = *up_;
    if (materials_.any()) {
      placed.materials = table_.materials;
      placed.textures = table_.textures;
      for (std::size_t t = 0; t < piece.triangle_count(); ++t)
        placed.triangle_materials.push_back(static_cast<MaterialId>(first + piece.material_of(t)));
    }
    features_.append(piece, 0, placed.triangle_features);
    placed.feature_names = table_.feature_names;
    sink_.add(placed);
  }

  const SceneDescription& scene_;
  const Progress& progress_;
  hlod::TriangleSink& sink_;
  MeshReader reader_;
  TriangleMesh table_;  // materials, textures and names of features so far
  SceneMaterials materials_;
  SceneFeatures features_;
  std::optional<TextureOrigin> origin_;
  Origin whole_;
  std::optional<UpAxis> up_;                // of all so far
  MeshReport generated_;                    // of the most recent generated mesh
  std::unique_ptr<StreamedMesh> streamed_;  // the most recent file
  std::string streamed_name_;
};

}  // namespace

CleanMesh flatten_scene(const SceneDescription& scene, const std::filesystem::path& folder, const Progress& progress) {
  MeshReader reader(scene, folder, progress);
  std::vector<PlacedMesh> placed;
  MeshReport read;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const CleanMesh& object = reader.read(i);
    placed.push_back(
        {&object.mesh, positions_to_world(scene.objects[i].object_to_world, object.mesh.origin), reader.name(i)});
    add_counts_of_reading(read, object.report);
  }
  CleanMesh result = clean(join(placed, folder, scene.name), MeshReport{}, scene.name);
  result.report = report_of(read, result);
  return result;
}

hlod::TriangleSource stream_scene(SceneDescription scene, std::filesystem::path folder,
                                  std::function<void(const std::string& what, double done)> progress) {
  auto origin = std::make_shared<std::optional<Origin>>();  // found when triangles are first asked for
  return [scene = std::move(scene), folder = std::move(folder), progress = std::move(progress),
          origin = std::move(origin)](hlod::TriangleSink& sink) {
    SceneStreamer streamer(scene, folder, progress, sink);
    if (!*origin) *origin = streamer.find_origin();
    streamer.run(**origin);
  };
}

namespace {

// Maps each wedge of a joined mesh, by its number among all wedges, to a vertex.
std::vector<WedgeId> first_wedges(std::span<const PlacedMesh> meshes) {
  std::vector<WedgeId> first;
  for (const PlacedMesh& placed : meshes) {
    const auto begin = static_cast<WedgeId>(first.size());
    for (WedgeId wedge = 0; wedge < placed.mesh->wedge_count(); ++wedge)
      first.push_back(begin + placed.mesh->vertex_of(wedge));
  }
  return first;
}

template <typename T>
void reorder(std::vector<T>& values, const std::vector<WedgeId>& order) {
  if (values.empty()) return;
  std::vector<T> result;
  result.reserve(values.size());
  for (const WedgeId wedge : order) result.push_back(values[wedge]);
  values = std::move(result);
}

// Moves vertices that are not their own first wedge to the end and makes them extra wedges.
void make_wedges(TriangleMesh& mesh, const std::vector<WedgeId>& first) {
  std::vector<WedgeId> order, extra, new_ids(first.size());
  for (WedgeId wedge = 0; wedge < first.size(); ++wedge) (first[wedge] == wedge ? order : extra).push_back(wedge);
  if (extra.empty()) return;
  order.insert(order.end(), extra.begin(), extra.end());
  for (WedgeId i = 0; i < order.size(); ++i) new_ids[order[i]] = i;
  reorder(mesh.positions, order);
  reorder(mesh.normals, order);
  reorder(mesh.colors, order);
  reorder(mesh.texture_coordinates, order);
  for (const WedgeId wedge : extra) mesh.extra_wedges.push_back(new_ids[first[wedge]]);
  mesh.corners = mesh.triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      mesh.corners[t][k] = new_ids[mesh.triangles[t][k]];
      mesh.triangles[t][k] = new_ids[first[mesh.triangles[t][k]]];
    }
}

}  // namespace

TriangleMesh join_meshes(std::span<const PlacedMesh> meshes, const std::filesystem::path& folder,
                         const std::string& name) {
  TriangleMesh all = join(meshes, folder, name);
  make_wedges(all, first_wedges(meshes));
  return all;
}

}  // namespace occlod
