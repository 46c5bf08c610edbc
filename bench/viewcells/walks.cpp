// bench_cell_walks FILE.vlod SCENE.json: along the paths of a scene, the triangles of frames by several ways to draw
// them, and how much changes where the eye goes from cell to cell (vLOD 2003, figures 11 and 10), as one JSON object
// for scripts/cells_report.sh.
#include <fmt/format.h>
#include <xxhash.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "cell_walk.h"
#include "drawing.h"
#include "full_scene.h"
#include "json_output.h"
#include "occlod/base.h"
#include "occlod/cell_builder.h"
#include "occlod/visibility.h"

namespace occlod::bench {
namespace {

using tool::Json;

constexpr std::size_t most_refined = 1'000'000;  // triangles by refinement, where the tolerance needs more

struct Subject {
  SceneDescription description;
  std::vector<LoadedObject> loaded;
  std::vector<RefineObject> objects;
  std::shared_ptr<const VlodFile> file;
};

Subject load(const std::filesystem::path& file, const std::filesystem::path& scene) {
  Subject subject;
  subject.description = read_scene(scene);
  subject.loaded = load_objects(subject.description, scene.parent_path());
  subject.objects = tool::refine_objects(subject.loaded);
  subject.file = open_vlod(file, subject.objects);
  return subject;
}

// Counts triangles of one object that are not wholly outside one side of the frustum.
class FrustumCount {
 public:
  FrustumCount(const View& view, const RefineObject& object)
      : view_(view, object.object_to_world), positions_(object.hierarchy->positions()) {}

  [[nodiscard]] bool may_be_inside(const Triangle& t) const {
    const auto is_outside = [&](const glm::vec4& plane) {
      for (int k = 0; k < 3; ++k)
        if (glm::dot(glm::vec3(plane), positions_[t[k]]) + plane.w >= 0.0F) return false;
      return true;
    };
    return std::none_of(view_.planes().begin(), view_.planes().end(), is_outside);
  }

 private:
  ObjectView view_;
  std::span<const glm::vec3> positions_;
};

std::size_t count_in_view(const Subject& subject, const View& view, std::span<const CellObjectCut> cut) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < cut.size(); ++i) {
    const FrustumCount frustum(view, subject.objects[i]);
    for (const Triangle& t : cut[i].triangles) count += frustum.may_be_inside(t) ? 1U : 0U;
  }
  return count;
}

std::size_t count_full_in_view(const Subject& subject, const View& view, const tool::FullScene& full) {
  std::vector<FrustumCount> frusta;
  for (const RefineObject& object : subject.objects) frusta.emplace_back(view, object);
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < full.triangle_count(); ++i) {
    const tool::FullScene::Item item = full.item(i);
    count += frusta[item.object].may_be_inside(item.triangle) ? 1U : 0U;
  }
  return count;
}

std::size_t drawn_triangles(std::span<const CellObjectCut> cut) {
  std::size_t count = 0;
  for (const CellObjectCut& object : cut) count += object.triangles.size();
  return count;
}

bool before(const Triangle& a, const Triangle& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

// How many triangles of `a` are not in `b`; both are sorted.
std::size_t count_missing(std::span<const CellObjectCut> a, std::span<const CellObjectCut> b) {
  std::size_t count = 0;
  std::vector<Triangle> only;
  for (std::size_t i = 0; i < a.size(); ++i) {
    only.clear();
    std::set_difference(a[i].triangles.begin(), a[i].triangles.end(), b[i].triangles.begin(), b[i].triangles.end(),
                        std::back_inserter(only), before);
    count += only.size();
  }
  return count;
}

// The cell of the eye, with its cut and the one without occlusion, which is found only where it is asked for.
class Cells {
 public:
  explicit Cells(const Subject& subject)
      : subject_(subject), without_(subject.objects, nullptr, subject.file->options().cell) {}

  // Gives what changes, if the cell does.
  Json go_to(const glm::dvec3& eye, int frame) {
    const CellTree& tree = subject_.file->tree();
    const CellId inside = tree.leaf_of(eye), cell = inside != no_id ? inside : tree.nearest_leaf(eye);
    if (cell == cell_) return {};
    std::vector<CellObjectCut> cut = read_cell(*subject_.file, subject_.objects, cell);
    for (CellObjectCut& object : cut) std::sort(object.triangles.begin(), object.triangles.end(), before);
    Json change;
    if (cell_ != no_id)
      change = {{"frame", frame},
                {"from", cell_},
                {"to", cell},
                {"added", count_missing(cut, cut_)},
                {"removed", count_missing(cut_, cut)},
                {"drawn", drawn_triangles(cut)}};
    cut_ = std::move(cut);
    cell_ = cell;
    return change;
  }
  [[nodiscard]] CellId cell() const { return cell_; }
  [[nodiscard]] std::span<const CellObjectCut> cut() const { return cut_; }
  std::span<const CellObjectCut> cut_without_occlusion() {
    if (cell_ != without_cell_) {
      without_cut_ = without_.build(subject_.file->tree().node(cell_).box).objects;
      without_cell_ = cell_;
    }
    return without_cut_;
  }

 private:
  const Subject& subject_;
  CellBuilder without_;
  CellId cell_ = no_id, without_cell_ = no_id;
  std::vector<CellObjectCut> cut_, without_cut_;
};

Json walk(const Subject& subject, const CameraPath& path, int compared, const tool::FullScene& full) {
  Cells cells(subject);
  Refiner refiner(subject.objects);
  const auto visibility = make_software_occlusion();
  RefineOptions options;
  options.budget = most_refined;
  options.tolerance_px = subject.file->options().cell.tolerance_px;
  Json frames = Json::array(), crossings = Json::array();
  const int every = std::max(1, path.frames / compared);
  for (int i = 0; i < path.frames; ++i) {
    const View view(camera_at(path, i));
    if (Json change = cells.go_to(view.camera().eye, i); !change.empty()) crossings.push_back(std::move(change));
    if (i % every == every - 2) static_cast<void>(refiner.update(view, options, *visibility));
    if (i % every != every - 1) continue;
    frames.push_back({{"frame", i},
                      {"cell", cells.cell()},
                      {"full_in_view", count_full_in_view(subject, view, full)},
                      {"lod_in_view", count_in_view(subject, view, cells.cut_without_occlusion())},
                      {"vlod", drawn_triangles(cells.cut())},
                      {"vlod_in_view", count_in_view(subject, view, cells.cut())},
                      {"update", refiner.update(view, options, *visibility).stats.triangles}});
  }
  return {{"frames", path.frames}, {"frame", std::move(frames)}, {"crossings", std::move(crossings)}};
}

void run(const std::filesystem::path& file, const std::filesystem::path& scene, int compared) {
  const Subject subject = load(file, scene);
  const tool::FullScene full(subject.objects);
  const CellTreeOptions& options = subject.file->options();
  Json paths = Json::object();
  for (const auto& [name, path] : subject.description.paths)
    if (!path.jump) paths[name] = walk(subject, path, compared, full);
  const std::string counted = paths.dump();
  tool::print_json({{"scene", subject.description.name},
                    {"triangles", full.triangle_count()},
                    {"cells", subject.file->tree().leaf_count()},
                    {"tolerance_px", options.cell.tolerance_px},
                    {"max_triangles", options.max_triangles},
                    {"paths", std::move(paths)},
                    {"hash", fmt::format("{:016x}", XXH3_64bits(counted.data(), counted.size()))}});
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) {
  CLI::App app("Triangles of frames along the paths of a scene, and what changes from cell to cell");
  std::filesystem::path file, scene;
  int compared = 60;
  app.add_option("FILE", file, "Cells, .vlod")->required();
  app.add_option("SCENE", scene, "Scene that they were built of, .json")->required();
  app.add_option("--frames", compared, "Frames of each path to count in")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    occlod::bench::run(file, scene, compared);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_cell_walks: {}\n", error.what());
    return 1;
  }
}
