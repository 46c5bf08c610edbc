#include "loader.h"

#include <exception>
#include <utility>

#include "mesh/mesh_files.h"
#include "occlod/base.h"
#include "occlod/scene.h"
#include "scene/mesh_source.h"
#include "standard_streams.h"

namespace occlod::viewer {
namespace {

struct Cancelled {};

// Returns "statue" for /folder/statue.ply, and a generator's own description.
std::string short_name(const MeshSource& source, const std::string& source_name) {
  if (!std::holds_alternative<MeshFile>(source)) return source_name;
  return std::filesystem::path(source_name).stem().string();
}

// Names files by the path where they were found, so that the scene can be saved elsewhere.
SceneObject found_part(const SceneObject& object, const std::string& source_name, const glm::dmat4& object_to_world) {
  SceneObject part = object;
  part.object_to_world = object_to_world;
  if (std::holds_alternative<MeshFile>(object.source))
    part.source = MeshFile{{std::filesystem::absolute(source_name).string()}};
  return part;
}

// Moves parts into the space of the positions of their object, which are relative to its origin.
void move_to_positions(std::vector<SceneObject>& parts, const glm::dvec3& origin) {
  for (SceneObject& part : parts) part.object_to_world[3] -= glm::dvec4(origin, 0.0);
}

// Returns what each of the HLODs of load_hlods() consists of: first all meshes together, if any, then each .ohlod file.
std::vector<std::vector<SceneObject>> parts_of_hlods(const SceneDescription& scene,
                                                     const std::filesystem::path& folder) {
  std::vector<SceneObject> meshes;
  std::vector<std::vector<SceneObject>> parts;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    const std::string source = name_of_source(object.source, scene, i, folder);
    if (is_ohlod_file(source))
      parts.push_back({found_part(object, source, glm::dmat4(1.0))});
    else
      meshes.push_back(found_part(object, source, object.object_to_world));
  }
  if (!meshes.empty()) parts.insert(parts.begin(), meshes);
  return parts;
}

bool has_hlods(const SceneDescription& scene, const std::filesystem::path& folder) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    if (is_ohlod_file(name_of_source(scene.objects[i].source, scene, i, folder))) return true;
  return false;
}

// Keeps notes for the window, and prints them.
ImageNote note_in(LoadedFile& result) {
  return [&result](const std::string& line) {
    tool::print_note(line);
    result.notes.push_back(line);
  };
}

void check_name(const std::filesystem::path& file) {
  if (std::filesystem::is_regular_file(file) && !can_be_opened(file))
    throw Error(
        {file.string(), "", "is not named like anything that can be opened",
         "give it the ending of a mesh (.ply .obj .off .stl .gltf .glb), hierarchy (.olod), HLOD (.ohlod), scene "
         "(.json) or view cells (.vlod)"});
}

}  // namespace

bool can_be_opened(const std::filesystem::path& file) {
  return find_format(file) || is_olod_file(file) || is_ohlod_file(file) || is_scene_file(file) || is_vlod_file(file);
}

Loader::Loader(bool use_cache, const std::optional<hlod::CacheOptions>& paged)
    : use_cache_(use_cache), paged_(paged), thread_([this] { run(); }) {}

Loader::~Loader() {
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
    cancelled_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Loader::open(const std::filesystem::path& file, LoadAs as) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back({file, as, nullptr, nullptr});
  }
  changed_.notify_all();
}

void Loader::open(const Example& example) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back({example.label, example.as, nullptr, &example});
  }
  changed_.notify_all();
}

void Loader::open_cells(const std::filesystem::path& file, std::shared_ptr<const Objects> objects) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back({file, LoadAs::hierarchy, std::move(objects), nullptr});
  }
  changed_.notify_all();
}

void Loader::cancel() {
  const std::lock_guard lock(mutex_);
  for (; !waiting_.empty(); waiting_.pop_front()) {
    LoadedFile cancelled;
    cancelled.file = waiting_.front().file;
    cancelled.cancelled = true;
    finished_.push_back(std::move(cancelled));
  }
  if (working_) cancelled_ = true;
}

LoadProgress Loader::progress() const {
  const std::lock_guard lock(mutex_);
  LoadProgress progress = progress_;
  progress.waiting = static_cast<int>(waiting_.size());
  return progress;
}

bool Loader::busy() const {
  const std::lock_guard lock(mutex_);
  return working_ || !waiting_.empty() || !finished_.empty();
}

std::optional<LoadedFile> Loader::take() {
  const std::lock_guard lock(mutex_);
  if (finished_.empty()) return std::nullopt;
  LoadedFile file = std::move(finished_.front());
  finished_.pop_front();
  return file;
}

void Loader::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return end_ || !waiting_.empty(); });
    if (end_) return;
    const Wanted wanted = waiting_.front();
    waiting_.pop_front();
    working_ = true;
    cancelled_ = false;
    progress_ = {wanted.file.filename().string(), 0.0, 0};
    lock.unlock();
    LoadedFile result = load(wanted);
    lock.lock();
    progress_ = {};
    working_ = false;
    finished_.push_back(std::move(result));
  }
}

LoadedFile Loader::load(const Wanted& wanted) {
  LoadedFile result;
  result.file = wanted.file;
  result.is_example = wanted.example != nullptr;
  try {
    if (wanted.cells_of) {
      result.cells = open_view_cells(wanted.file, wanted.cells_of);
      return result;
    }
    if (wanted.example == nullptr) check_name(wanted.file);
    const SceneDescription scene = wanted.example != nullptr ? scene_of(*wanted.example) : describe_file(wanted.file);
    if (wanted.as == LoadAs::hlod || has_hlods(scene, wanted.file.parent_path()))
      load_as_hlods(scene, result);
    else
      load_meshes(scene, result);
    result.cameras = scene.cameras;
    result.paths = scene.paths;
    result.about = scene.about;
  } catch (const Cancelled&) {
    result.objects.clear();
    result.cancelled = true;
  } catch (const std::exception& error) {
    result.objects.clear();
    result.error = error.what();
  }
  return result;
}

void Loader::load_meshes(const SceneDescription& scene, LoadedFile& result) {
  LoadOptions options;
  options.use_cache = use_cache_;
  options.progress = [this](const std::string& what, double done) { report(what, done); };
  const std::vector<LoadedObject> loaded = load_objects(scene, result.file.parent_path(), options);
  std::map<const Hierarchy*, std::shared_ptr<const ViewMesh>> meshes;  // objects may share a hierarchy
  for (std::size_t i = 0; i < loaded.size(); ++i) {
    auto& mesh = meshes[loaded[i].hierarchy.get()];
    report("preparing " + loaded[i].source_name, 1.0);
    if (!mesh)
      mesh = make_view_mesh(loaded[i].hierarchy, std::filesystem::path(loaded[i].source_name).parent_path(),
                            note_in(result));
    const std::string& source = loaded[i].source_name;
    PlacedObject& object = result.objects.emplace_back();
    object.name = short_name(scene.objects[i].source, source);
    object.parts = {found_part(scene.objects[i], source, glm::dmat4(1.0))};
    move_to_positions(object.parts, loaded[i].hierarchy->data().origin);
    object.mesh = mesh;
    object.object_to_world = loaded[i].object_to_world;
    object.placement = placement_of(object.object_to_world);
    object.two_sided = loaded[i].two_sided;
    object.attributes = loaded[i].attributes;
  }
}

void Loader::load_as_hlods(const SceneDescription& scene, LoadedFile& result) {
  const std::filesystem::path folder = result.file.parent_path();
  LoadOptions options;
  options.use_cache = use_cache_;
  if (has_hlods(scene, folder)) options.paged = paged_;
  options.progress = [this](const std::string& what, double done) { report(what, done); };
  const std::vector<LoadedHlod> loaded = load_hlods(scene, folder, options);
  const std::vector<std::vector<SceneObject>> parts = parts_of_hlods(scene, folder);
  std::map<const hlod::Hlod*, std::shared_ptr<const ViewHlod>> hlods;  // objects may share a file
  for (std::size_t i = 0; i < loaded.size(); ++i) {
    auto& hlod = hlods[loaded[i].hlod.get()];
    report("preparing " + loaded[i].source_name, 1.0);
    if (!hlod) {
      const std::filesystem::path source = loaded[i].source_name;
      hlod = make_view_hlod(loaded[i].hlod, is_ohlod_file(source) ? source.parent_path() : folder, note_in(result));
    }
    PlacedObject& object = result.objects.emplace_back();
    object.name = std::filesystem::path(loaded[i].source_name).stem().string();
    object.parts = parts[i];
    move_to_positions(object.parts, loaded[i].hlod->data().origin);
    object.hlod = hlod;
    object.object_to_world = loaded[i].object_to_world;
    object.placement = placement_of(object.object_to_world);
    object.two_sided = loaded[i].two_sided;
  }
}

void Loader::report(const std::string& what, double done) {
  if (cancelled_) throw Cancelled();
  const std::lock_guard lock(mutex_);
  const std::size_t slash = what.find_last_of('/');
  progress_.what = slash == std::string::npos ? what : what.substr(slash + 1);
  progress_.done = done;
}

}  // namespace occlod::viewer
