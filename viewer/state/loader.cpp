#include "loader.h"

#include <exception>
#include <utility>

#include "occlod/core/error.h"

namespace occlod::viewer {
namespace {

struct Cancelled {};

// "statue" of /folder/statue.ply; a generator's own description.
std::string short_name(const SceneObject& object, const LoadedObject& loaded) {
  if (!std::holds_alternative<MeshFile>(object.source)) return loaded.source_name;
  return std::filesystem::path(loaded.source_name).stem().string();
}

// With files by the path where they were found, so that the scene can be saved elsewhere.
MeshSource found_source(const SceneObject& object, const LoadedObject& loaded) {
  if (!std::holds_alternative<MeshFile>(object.source)) return object.source;
  return MeshFile{{std::filesystem::absolute(loaded.source_name).string()}};
}

}  // namespace

Loader::Loader(bool use_cache) : use_cache_(use_cache), thread_([this] { run(); }) {}

Loader::~Loader() {
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
    cancelled_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Loader::open(const std::filesystem::path& file) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(file);
  }
  changed_.notify_all();
}

void Loader::cancel() {
  const std::lock_guard lock(mutex_);
  for (; !waiting_.empty(); waiting_.pop_front()) {
    LoadedFile cancelled;
    cancelled.file = waiting_.front();
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
    const std::filesystem::path file = waiting_.front();
    waiting_.pop_front();
    working_ = true;
    cancelled_ = false;
    progress_ = {file.filename().string(), 0.0, 0};
    lock.unlock();
    LoadedFile result = load(file);
    lock.lock();
    progress_ = {};
    working_ = false;
    finished_.push_back(std::move(result));
  }
}

LoadedFile Loader::load(const std::filesystem::path& file) {
  LoadedFile result;
  result.file = file;
  try {
    const SceneDescription scene = describe_file(file);
    LoadOptions options;
    options.use_cache = use_cache_;
    options.progress = [this](const std::string& what, double done) { report(what, done); };
    const std::vector<LoadedObject> loaded = load_objects(scene, file.parent_path(), options);
    std::map<const Hierarchy*, std::shared_ptr<const ViewMesh>> meshes;  // objects may share a hierarchy
    for (std::size_t i = 0; i < loaded.size(); ++i) {
      auto& mesh = meshes[loaded[i].hierarchy.get()];
      report("preparing " + loaded[i].source_name, 1.0);
      if (!mesh) mesh = make_view_mesh(loaded[i].hierarchy);
      const glm::dmat4& matrix = loaded[i].object_to_world;
      result.objects.push_back({0, short_name(scene.objects[i], loaded[i]), found_source(scene.objects[i], loaded[i]),
                                mesh, matrix, placement_of(matrix), loaded[i].two_sided, true});
    }
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

void Loader::report(const std::string& what, double done) {
  if (cancelled_) throw Cancelled();
  const std::lock_guard lock(mutex_);
  const std::size_t slash = what.find_last_of('/');
  progress_.what = slash == std::string::npos ? what : what.substr(slash + 1);
  progress_.done = done;
}

}  // namespace occlod::viewer
