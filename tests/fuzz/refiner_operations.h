// A refiner driven by bytes: whatever they ask for, its meshes are valid and within the budget.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "occlod/refiner.h"
#include "occlod/visibility.h"
#include "refine/tuning.h"
#include "splits/star.h"

namespace occlod::fuzz {

// Bytes as numbers; zeros when they are used up.
class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> bytes) : left_(bytes) {}

  [[nodiscard]] bool empty() const noexcept { return left_.empty(); }
  std::uint32_t number(std::uint32_t below) {
    std::uint16_t value = 0;
    const std::size_t size = std::min(sizeof value, left_.size());
    std::memcpy(&value, left_.data(), size);
    left_ = left_.subspan(size);
    return value % below;
  }
  double real(double low, double high) { return low + (high - low) * number(65536) / 65535.0; }

 private:
  std::span<const std::uint8_t> left_;
};

class RefinerOperations {
 public:
  RefinerOperations()
      : objects_{{&planet(), glm::dmat4(1.0), false},
                 {&planet(), glm::scale(glm::translate(glm::dmat4(1.0), {0.0, 0.5, 2.5}), {-1.0, 0.7, 1.0}), true}},
        refiner_(objects_),
        buffers_(objects_.size()) {}

  static constexpr int max_operations = 128;  // a second or two under sanitizers

  // What went wrong, or nothing. Bytes beyond max_operations are not read.
  std::string run(Bytes bytes) {
    for (int operation = 0; operation < max_operations && !bytes.empty(); ++operation) {
      change(bytes);
      std::string fault = bytes.number(8) == 0 ? call(false) : call(true);
      if (!fault.empty()) return fault;
    }
    return {};
  }

 private:
  static const Hierarchy& planet() {
    static const Hierarchy hierarchy = build_hierarchy(generate("rough-planet", {{"level", 4}}));
    return hierarchy;
  }

  void change(Bytes& bytes) {
    switch (bytes.number(14)) {
      case 0:
        options_.budget = refiner_.base_triangles() + bytes.number(5000);
        break;
      case 1:
        tune(options_).culling = bytes.number(2) == 0 ? Culling::subtree : Culling::star;
        break;
      case 2:
        occlusion_ = bytes.number(2) == 0;
        break;
      case 3:
        options_.max_changes = bytes.number(100);
        break;
      case 4:
        options_.tolerance_px = bytes.number(2) == 0 ? 0.0 : bytes.real(0.0, 20.0);
        break;
      case 5:
        options_.mode = bytes.number(2) == 0 ? OccluderMode::paper : OccluderMode::conservative;
        break;
      case 6:
        tune(options_).proxy = static_cast<Proxy>(bytes.number(3));
        tune(options_).level_step = 1 + bytes.number(4);
        break;
      case 7:
        tune(options_).hysteresis = bytes.real(0.0, 0.99);
        options_.geomorph_frames = bytes.number(5);
        break;
      case 8:
        camera_.eye = {bytes.real(-6.0, 6.0), bytes.real(-6.0, 6.0), bytes.real(-6.0, 6.0)};
        break;
      case 9:
        camera_.fov_y_deg = bytes.real(1.0, 179.0);
        camera_.width = 1 + static_cast<int>(bytes.number(300));
        camera_.height = 1 + static_cast<int>(bytes.number(300));
        if (!camera_.orthographic_height) camera_.principal_point = {bytes.real(-1.5, 1.5), bytes.real(-1.5, 1.5)};
        break;
      case 10:
        camera_.target = {bytes.real(-2.0, 2.0), bytes.real(-2.0, 2.0), bytes.real(-2.0, 4.0)};
        break;
      case 11:
        camera_.principal_point = glm::dvec2(0.0);
        if (bytes.number(2) == 0)
          camera_.orthographic_height.reset();
        else
          camera_.orthographic_height = bytes.real(0.0, 8.0);  // 0: no camera
        break;
      case 12:
        place(bytes);
        break;
      default:
        camera_.eye += glm::dvec3(bytes.real(-0.2, 0.2), bytes.real(-0.2, 0.2), bytes.real(-0.2, 0.2));
    }
  }

  void place(Bytes& bytes) {
    const std::uint32_t object = bytes.number(2);
    const glm::dvec3 at(bytes.real(-2.0, 2.0), bytes.real(-2.0, 2.0), bytes.real(-2.0, 4.0));
    const glm::dmat4 turned = glm::rotate(glm::translate(glm::dmat4(1.0), at), bytes.real(-3.2, 3.2), {0.6, 0.8, 0.0});
    const double size = bytes.number(4) == 0 ? bytes.real(-2.0, 2.0) : 1.0;
    try {
      refiner_.set_transform(object, glm::scale(turned, {size, 1.0, 1.0}));
    } catch (const Error&) {
      return;  // a size of 0
    }
  }

  std::string call(bool goes_on) {
    Visibility& visibility = occlusion_ ? *software_ : static_cast<Visibility&>(none_);
    try {
      const View view(camera_);
      const Refinement& refined =
          goes_on ? refiner_.update(view, options_, visibility) : refiner_.refine(view, options_, visibility);
      return fault_of(refined);
    } catch (const Error&) {
      return {};  // a camera that is none
    }
  }

  std::string fault_of(const Refinement& refined) {
    std::size_t triangles = 0;
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      const RefinedObject& object = refined.objects[i];
      triangles += object.triangles.size();
      std::vector<Triangle>& buffer = buffers_[i];
      buffer.resize(object.triangles.size());
      for (const TriangleRange& range : object.changes)
        std::copy_n(object.triangles.begin() + range.first, range.count, buffer.begin() + range.first);
      if (buffer != object.triangles) return "changes leave out a triangle";
      if (std::string fault = fault_of(object); !fault.empty()) return fault;
    }
    if (triangles > options_.budget) return "more triangles than the budget";
    const RefineStats& stats = refined.stats;
    if (triangles != stats.triangles) return "a wrong number of triangles";
    if (stats.culled_frustum + stats.culled_backface + stats.culled_occlusion > stats.nodes)
      return "more nodes culled than reached";
    if (stats.forced_splits > stats.new_splits || stats.forced_unseen_splits > stats.forced_splits)
      return "more splits forced than applied";
    return {};
  }

  // Splits closed under dependency; as many triangles as they add to the base mesh.
  static std::string fault_of(const RefinedObject& object) {
    std::vector<bool> applied(planet().split_count(), false);
    std::size_t triangles = planet().base_triangle_count();
    for (const SplitId s : object.splits) {
      const SplitStar star = star_of(planet(), s);
      for (const SplitId needed : star.dependencies())
        if (!applied[needed]) return "a split without one that it needs";
      applied[s] = true;
      triangles = triangles + star.inserted_count() - star.removed_count();
    }
    return triangles == object.triangles.size() ? "" : "triangles that the splits do not make";
  }

  std::vector<RefineObject> objects_;
  Refiner refiner_;
  std::vector<std::vector<Triangle>> buffers_;  // kept by what changes tell
  Camera camera_;
  RefineOptions options_;
  bool occlusion_ = false;
  NoOcclusion none_;
  std::unique_ptr<Visibility> software_ = make_software_occlusion();
};

}  // namespace occlod::fuzz
