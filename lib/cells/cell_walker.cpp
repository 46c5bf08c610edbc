#include "occlod/cell_walker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "base/threads.h"
#include "cells/cell_loads.h"
#include "cells/vlod_format.h"
#include "occlod/base.h"

namespace occlod {
namespace {

constexpr std::size_t max_expected = 64;  // cells
constexpr int max_tries = 3;
constexpr double retry_seconds = 1.0;
// Sets how far ahead cells are loaded: several times the recent duration of a load, within limits in seconds.
constexpr double shortest_horizon = 0.5, longest_horizon = 2.0, loads_ahead = 4.0;

bool is_outside(const Box& box, const ObjectView& view) {
  const glm::vec3 center = 0.5F * (box.min + box.max), half = 0.5F * (box.max - box.min);
  return std::ranges::any_of(view.planes(), [&](const glm::vec4& plane) {
    const glm::vec3 normal(plane);
    // Bounds the rounding error of a plane, which grows with the coordinates.
    const float slack = 1e-5F * (std::abs(plane.w) + glm::dot(glm::abs(normal), glm::abs(center)));
    return glm::dot(normal, center) + plane.w + glm::dot(glm::abs(normal), half) < -slack;
  });
}

}  // namespace

std::vector<RefineObject> placements(const VlodFile& file) {
  std::vector<RefineObject> objects;
  for (const vlod::StoredObject& object : file.objects())
    objects.push_back({.object_to_world = object.object_to_world, .two_sided = object.two_sided != 0});
  return objects;
}

void ranges_in_view(const WalkedFrame& frame, std::span<const RefineObject> objects, const View& view,
                    std::vector<ObjectRange>& out) {
  out.clear();
  for (std::uint32_t i = 0; i < objects.size(); ++i) {
    const ObjectView object(view, objects[i].object_to_world);
    for (const TriangleBlock& block : frame.objects[i].blocks) {
      if (is_outside(block.box, object)) continue;
      if (!out.empty() && out.back().object == i && out.back().first + out.back().count == block.first)
        out.back().count += block.count;
      else
        out.push_back({i, block.first, block.count});
    }
  }
}

class CellWalker::Work {
 public:
  // Without objects, the file must be packed.
  Work(std::shared_ptr<const VlodFile> file, std::span<const RefineObject> objects, const WalkOptions& options)
      : file_(std::move(file)),
        objects_(objects.begin(), objects.end()),
        options_(options),
        loads_(*file_),
        residents_(*file_, base_triangles(*file_, objects)),
        motion_(file_->options().root_cell),
        forecast_(file_->tree()) {
    if (options.loaders < 0 || options.loaders > 64)
      throw Error({"walk options", "loaders", "is out of its range", "give a number from 0 to 64"});
    if (!objects.empty() && objects.size() != file_->object_count())
      throw Error({"cell walker", "",
                   fmt::format("the cells are of {} objects, not {}", file_->object_count(), objects.size()),
                   "give the objects that the file was opened with"});
    if (objects.empty() && !file_->objects().empty()) use_geometry();
    load_root();
    for (int i = 0; i < options.loaders; ++i) threads_.emplace_back([this] { run_loader(); });
  }

  ~Work() {
    loads_.stop();
    for (std::thread& thread : threads_) thread.join();
  }
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

  const WalkedFrame& step(const glm::dvec3& eye, double seconds) {
    clock_ += seconds;
    motion_.step(eye, seconds);
    take_loads();
    locate(eye);
    choose_target();
    plan(eye);
    show();
    return frame_;
  }

  void set_trial(WalkTrial trial) {
    prefetch_ = trial.prefetch;
    loads_.set_reader(std::move(trial.reader));
    if (geometry_) geometry_->set_before_read(std::move(trial.before_geometry));
  }

  // True in a process that was forked since: its loaders are not there, and may hold locks for ever.
  [[nodiscard]] bool is_lost() const { return !threads_.empty() && began_.is_in_child(); }
  void require_loaders() const {
    if (is_lost())
      throw Error({"cell walker", "", "was made before this process was forked, and its loaders are not here",
                   "make another in this process, or give it no loaders"});
  }

  [[nodiscard]] CellLoads& loads() { return loads_; }
  // Returns a mesh maker for one loader.
  [[nodiscard]] CellMeshMaker maker() { return maker(options_.memory); }

 private:
  struct Failure {
    int tries = 0;
    double retry_at = 0.0;
  };

  static std::size_t base_triangles(const VlodFile& file, std::span<const RefineObject> objects) {
    std::size_t triangles = 0;
    for (const RefineObject& object : objects) triangles += object.hierarchy->base_triangle_count();
    if (!objects.empty() || !file.is_packed()) return triangles;
    for (std::uint32_t i = 0; i < file.object_count(); ++i)
      triangles += file.geometry()->mesh(file.geometry()->mesh_of(i)).base_faces;
    return triangles;
  }

  void use_geometry() {
    if (!file_->is_packed() || file_->has_objects())
      throw Error({"cell walker", "", "has no objects, and the file is not packed or was opened with objects",
                   "give the objects, or a packed file that was opened without"});
    geometry_.emplace(*file_->geometry());
    fixed_bytes_ = file_->geometry()->bytes();
  }

  [[nodiscard]] CellMeshMaker maker(std::size_t max_bytes) {
    return geometry_ ? CellMeshMaker(*file_, *geometry_, max_bytes) : CellMeshMaker(*file_, objects_);
  }

  void load_root() {
    if (geometry_) geometry_->limit(options_.memory / 4);
    CellMeshMaker maker = this->maker(std::numeric_limits<std::size_t>::max());
    CellLoad root = loads_.load(0, maker);
    if (!root.mesh) throw Error({"cell walker", "", root.problem, "walk with the file that the cells were built into"});
    residents_.add(0, root.mesh);
    loads_.finish(std::move(root));
    loads_.collect(ended_);
    const std::size_t least = fixed_bytes_ + residents_.bytes() + loads_.addition_bytes();
    if (least > options_.memory)
      throw Error({"walk options", "memory",
                   fmt::format("is {} bytes; what all cells have in common needs {}", options_.memory, least),
                   "give more"});
    options_.memory -= fixed_bytes_;
  }

  void run_loader() {
    CellMeshMaker maker = this->maker();
    while (const auto cell = loads_.take_or_wait()) loads_.finish(loads_.load(*cell, maker));
  }

  void take_loads() {
    loads_.collect(ended_);
    frame_.bytes_read = 0;
    frame_.notes.clear();
    frame_.loads = ended_.size();
    for (CellLoad& load : ended_) {
      frame_.bytes_read += load.bytes_read;
      if (load.mesh) {
        for (CellId node = load.cell; node != no_id; node = file_->tree().node(node).parent) failures_.erase(node);
        residents_.add(load.cell, std::move(load.mesh));
      } else {
        Failure& failure = failures_[load.failed];
        failure = {failure.tries + 1, clock_ + retry_seconds};
        frame_.notes.push_back(fmt::format(
            "{}; {}", load.problem, failure.tries < max_tries ? "trying again in a second" : "going on without it"));
      }
      if (const auto since = wanted_since_.find(load.cell); since != wanted_since_.end()) {
        waited_ = std::max(clock_ - since->second, 0.9 * waited_);
        wanted_since_.erase(since);
      }
    }
  }

  void locate(const glm::dvec3& eye) {
    const CellTree& tree = file_->tree();
    const CellId before = frame_.cell;
    frame_.cell = tree.leaf_of(eye);
    frame_.outside = frame_.cell == no_id;
    if (frame_.outside) frame_.cell = tree.nearest_leaf(eye);
    frame_.crossed = before != no_id && before != frame_.cell;
    if (frame_.cell == before) return;
    tree.path_to(frame_.cell, path_);
    std::ranges::reverse(path_);
  }

  // Returns whether the cell may be requested now. `forever` is set when it can never be loaded again.
  [[nodiscard]] bool can_load(CellId cell, bool* forever = nullptr) const {
    if (failures_.empty()) return true;
    for (CellId node = cell; node != no_id; node = file_->tree().node(node).parent) {
      const auto found = failures_.find(node);
      if (found == failures_.end()) continue;
      const bool is_lost = found->second.tries >= max_tries;
      if (is_lost && forever != nullptr) *forever = true;
      if (is_lost || clock_ < found->second.retry_at) return false;
    }
    return true;
  }

  // Chooses the deepest node of the path that can be loaded.
  void choose_target() {
    frame_.missing = false;
    target_ = 0;
    for (auto at = path_.begin(); at != path_.end() && *at != 0; ++at) {
      bool forever = false;
      const std::size_t needed = needed_for(*at);
      if (needed > options_.memory) {
        forever = true;
        if (*at == frame_.cell && told_too_large_.insert(*at).second)
          frame_.notes.push_back(
              fmt::format("cell {} needs {} bytes in memory, which may hold {}: a coarser one is drawn", *at, needed,
                          options_.memory));
      } else if (residents_.find(*at) || can_load(*at, &forever)) {
        target_ = *at;
        break;
      }
      if (*at == frame_.cell) frame_.missing = forever;
    }
    if (loads_.addition_bytes() > options_.memory / 4) {
      file_->tree().path_to(target_, target_path_);
      loads_.keep_additions(target_path_);
    }
    if (geometry_) limit_geometry();
  }

  // Limits geometry to a quarter of the memory, minus what showing the target takes.
  void limit_geometry() {
    const std::size_t others = residents_.bytes_of(0) + residents_.bytes_of(target_) + loads_.addition_bytes();
    geometry_bytes_ = std::min(options_.memory / 4, options_.memory - std::min(options_.memory, others));
    geometry_->limit(geometry_bytes_);
  }

  // Returns the bytes that are not available for prepared cells: what nodes add, and the limit of the geometry.
  [[nodiscard]] std::size_t other_bytes() const { return loads_.addition_bytes() + geometry_bytes_; }

  // Estimates the bytes of memory needed to show the cell: the cell, the root, and what the nodes above it add.
  [[nodiscard]] std::size_t needed_for(CellId cell) const {
    std::size_t bytes = residents_.bytes_of(0) + residents_.bytes_of(cell);
    const CellTree& tree = file_->tree();
    for (CellId node = tree.node(cell).parent; node != no_id; node = tree.node(node).parent)
      bytes += 2 * (tree.node(node).splits * sizeof(SplitId) + tree.node(node).hidden_faces * sizeof(FaceRef));
    return bytes;
  }

  // Decides what is kept and requested, as far as memory allows: what is drawn, what may be entered, what is above.
  void plan(const glm::dvec3& eye) {
    kept_.clear();
    wanted_.clear();
    left_ = options_.memory - std::min(options_.memory, residents_.bytes_of(0) + other_bytes());
    for (const CellId node : path_)
      if (node == target_ || (residents_.find(node) && kept_.size() < 2)) consider(node);
    if (prefetch_) {
      const double horizon = std::clamp(loads_ahead * waited_, shortest_horizon, longest_horizon);
      for (const ExpectedCell& cell : forecast_.expect(frame_.cell, eye, motion_.velocity(), horizon, max_expected))
        if (can_load(cell.leaf) && !consider(cell.leaf)) break;
      for (const CellId node : path_)
        if (can_load(node) && !consider(node)) break;
    }
    std::size_t coming = 0;
    for (const CellId cell : wanted_) coming += residents_.bytes_of(cell);
    const std::size_t others = other_bytes() + coming;
    residents_.shrink(kept_, options_.memory - std::min(options_.memory, others));
    loads_.want(wanted_);
    std::erase_if(wanted_since_,
                  [&](const auto& entry) { return std::ranges::find(wanted_, entry.first) == wanted_.end(); });
    for (const CellId cell : wanted_) wanted_since_.try_emplace(cell, clock_);
  }

  // Returns false when there is no memory left for the cell.
  bool consider(CellId cell) {
    if (cell == 0 || std::ranges::find(kept_, cell) != kept_.end()) return true;
    const std::size_t bytes = residents_.bytes_of(cell);
    if (bytes > left_) return false;
    left_ -= bytes;
    kept_.push_back(cell);
    if (!residents_.find(cell)) wanted_.push_back(cell);
    return true;
  }

  void show() {
    std::shared_ptr<const CellMesh> mesh;
    for (auto at = path_.begin(); !mesh; ++at) {
      mesh = residents_.find(*at);
      frame_.shown = *at;
    }
    frame_.late = frame_.shown != frame_.cell;
    frame_.missing = frame_.missing && frame_.late;
    frame_.changed = mesh != shown_;
    frame_.error_px = mesh->error_px;
    frame_.drawn_triangles = mesh->triangles.size();
    frame_.resident_bytes =
        fixed_bytes_ + residents_.bytes() + loads_.addition_bytes() + (geometry_ ? geometry_->bytes() : 0);
    show_objects(*mesh);
    frame_.owner = mesh;
    shown_ = std::move(mesh);
  }

  void show_objects(const CellMesh& mesh) {
    frame_.objects.clear();
    for (const CellMesh::Object& object : mesh.objects) {
      WalkedObject shown;
      shown.triangles = std::span(mesh.triangles).subspan(object.first_triangle, object.triangles);
      shown.blocks = std::span(mesh.blocks).subspan(object.first_block, object.blocks);
      const auto i = static_cast<std::uint32_t>(frame_.objects.size());
      const auto part = [](const auto& values, const CellMesh::Object::Part& of_object) {
        return std::span(values).subspan(of_object.first, of_object.count);
      };
      if (geometry_) {
        shown.positions = part(mesh.positions, object.positions);
        shown.normals = part(mesh.normals, object.normals);
        shown.colors = part(mesh.colors, object.colors);
        shown.texture_coordinates = part(mesh.coordinates, object.coordinates);
        shown.wedge_materials = part(mesh.materials, object.materials);
        shown.surface = file_->materials(i);
      } else {
        const HierarchyView& hierarchy = objects_[i].hierarchy->data();
        shown.positions = hierarchy.positions;
        shown.normals = hierarchy.normals;
        shown.colors = hierarchy.colors;
        shown.texture_coordinates = hierarchy.texture_coordinates;
        shown.wedge_materials = hierarchy.wedge_materials;
        shown.surface = {hierarchy.materials, hierarchy.textures, hierarchy.texture_origin};
      }
      frame_.objects.push_back(shown);
    }
  }

  std::shared_ptr<const VlodFile> file_;
  std::vector<RefineObject> objects_;
  WalkOptions options_;
  bool prefetch_ = true;
  CellLoads loads_;
  std::optional<vlod::GeometryCache> geometry_;  // of a packed file
  std::size_t fixed_bytes_ = 0;                  // geometry that is always in memory; not part of options_.memory
  std::size_t geometry_bytes_ = 0;               // limit for its frames
  CellResidents residents_;
  WalkMotion motion_;
  CellForecast forecast_;
  double clock_ = 0.0;   // seconds, of all steps
  double waited_ = 0.0;  // seconds: the longest recent wait for a load
  std::map<CellId, double> wanted_since_;
  std::map<CellId, Failure> failures_;  // by the node that could not be read
  std::set<CellId> told_too_large_;
  std::vector<CellId> path_;  // from the cell of the eye up
  std::vector<CellId> target_path_;
  CellId target_ = 0;                  // the node of the path to draw
  std::vector<CellId> kept_, wanted_;  // the most urgent first
  std::size_t left_ = 0;               // in bytes
  std::vector<CellLoad> ended_;
  std::shared_ptr<const CellMesh> shown_;
  WalkedFrame frame_;
  ForkMark began_;
  std::vector<std::thread> threads_;
};

CellWalker::CellWalker(std::shared_ptr<const VlodFile> file, std::span<const RefineObject> objects,
                       const WalkOptions& options)
    : work_(std::make_unique<Work>(std::move(file), objects, options)) {}
CellWalker::CellWalker(std::shared_ptr<const VlodFile> file, const WalkOptions& options)
    : work_(std::make_unique<Work>(std::move(file), std::span<const RefineObject>(), options)) {}

CellWalker::~CellWalker() {
  if (work_->is_lost()) static_cast<void>(work_.release());
}

const WalkedFrame& CellWalker::step(const glm::dvec3& eye, double seconds) {
  work_->require_loaders();
  return work_->step(eye, seconds);
}

void CellWalker::set_trial(WalkTrial trial) {
  work_->require_loaders();
  work_->set_trial(std::move(trial));
}

class CellLoader::Work {
 public:
  explicit Work(CellWalker::Work& walker) : walker_(walker), maker_(walker.maker()) {}

  bool begin() {
    walker_.require_loaders();
    const auto cell = walker_.loads().take();
    if (!cell) return false;
    load_ = walker_.loads().load(*cell, maker_);
    return true;
  }
  void finish() { walker_.loads().finish(std::move(load_)); }

 private:
  CellWalker::Work& walker_;
  CellMeshMaker maker_;
  CellLoad load_;
};

CellLoader::CellLoader(CellWalker& walker) : work_(std::make_unique<Work>(*walker.work_)) {}
CellLoader::~CellLoader() = default;
bool CellLoader::begin() { return work_->begin(); }
void CellLoader::finish() { work_->finish(); }

}  // namespace occlod
