// Frames at random: the eye moves and jumps, objects move, budgets and options change. In every frame the budget is
// kept, a copy that takes over `changes` is the new mesh, the mesh is that of the splits, each of which has all that it
// needs, and any number of threads finds the same; also when the backend is shown pictures of anything.
#include <array>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>
#include <memory>
#include <random>
#include <span>
#include <string>

#include "base/timing.h"
#include "occlod/visibility.h"
#include "refine/refine_support.h"
#include "refine/tuning.h"

namespace occlod {
namespace {

constexpr std::array<int, 4> thread_counts = {1, 2, 3, 8};

// Returns a number that tells nearly all triangles apart, so that the sum of a mesh's tells nearly all meshes apart.
std::uint64_t number_of(const Triangle& t) {
  std::uint64_t number = 0;
  for (int k = 0; k < 3; ++k) number = (number + t[k] + 1) * 0x9e3779b97f4a7c15ULL ^ number >> 29U;
  return number ^ number >> 32U;
}

std::uint64_t sum_of(std::span<const Triangle> triangles) {
  std::uint64_t sum = 0;
  for (const Triangle& t : triangles) sum += number_of(t);
  return sum;
}

// Returns the face with the corners as its split, or the base mesh, has them.
Triangle inserted_face(const Hierarchy& hierarchy, const FaceRef& face) {
  return face.split == no_id ? hierarchy.data().base_faces[face.slot]
                             : star_of(hierarchy, face.split).inserted(face.slot);
}

// Applies the splits to the base mesh one after the other, and says what is wrong.
std::string fault_of(const Hierarchy& hierarchy, const RefinedObject& object) {
  std::vector<bool> applied(hierarchy.split_count(), false);
  std::uint64_t sum = sum_of(hierarchy.data().base_faces);
  std::size_t triangles = hierarchy.base_triangle_count();
  for (std::size_t i = 0; i < object.splits.size(); ++i) {
    const SplitId s = object.splits[i];
    if (i > 0 && object.splits[i - 1] >= s) return "splits that do not ascend";
    const SplitStar star = star_of(hierarchy, s);
    for (const SplitId needed : star.dependencies())
      if (!applied[needed]) return "a split without one that it needs";
    applied[s] = true;
    star.for_each_inserted([&](const Triangle& t) { sum += number_of(t); });
    star.for_each_removed_ref([&](const FaceRef& face) { sum -= number_of(inserted_face(hierarchy, face)); });
    triangles = triangles + star.inserted_count() - star.removed_count();
  }
  if (triangles != object.triangles.size()) return "a wrong number of triangles";
  return sum == sum_of(object.triangles) ? "" : "triangles that the splits do not make";
}

// Does `changes` tell all? `copy` is the mesh of the frame before, and is that of this frame afterwards.
bool take_over(const RefinedObject& object, std::vector<Triangle>& copy) {
  copy.resize(object.triangles.size());
  for (const TriangleRange& range : object.changes)
    std::copy_n(object.triangles.begin() + range.first, range.count, copy.begin() + range.first);
  return copy == object.triangles;
}

bool same_geomorphs(const std::vector<Geomorph>& a, const std::vector<Geomorph>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Geomorph& x, const Geomorph& y) {
    return x.vertex == y.vertex && x.parent == y.parent && x.t == y.t;
  });
}

bool same_ranges(const std::vector<TriangleRange>& a, const std::vector<TriangleRange>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const TriangleRange& x, const TriangleRange& y) {
    return x.first == y.first && x.count == y.count;
  });
}

// Says what differs but for times.
std::string difference(const Refinement& a, const Refinement& b) {
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    const RefinedObject &of_a = a.objects[i], &of_b = b.objects[i];
    if (of_a.splits != of_b.splits) return "other splits";
    if (of_a.triangles != of_b.triangles) return "other triangles";
    if (!same_ranges(of_a.changes, of_b.changes)) return "other changes";
    if (!same_geomorphs(of_a.geomorphs, of_b.geomorphs)) return "other geomorphs";
  }
  const auto counts = [](const RefineStats& s) {
    return std::array{s.triangles,       s.splits,         s.nodes,         s.culled_frustum,       s.culled_backface,
                      s.visits,          s.new_splits,     s.forced_splits, s.forced_unseen_splits, s.merged_splits,
                      s.queries,         s.queries_hidden, s.taken_back,    s.rejected_splits,      s.readmitted,
                      s.culled_occlusion};
  };
  if (counts(a.stats) != counts(b.stats)) return "other counts";
  if (a.stats.level_px != b.stats.level_px || a.stats.max_error_px != b.stats.max_error_px ||
      a.stats.max_quadric_error_px != b.stats.max_quadric_error_px)
    return "other errors";
  return {};
}

const std::vector<Hierarchy>& hierarchies() {
  static const std::vector<Hierarchy> all = [] {
    std::vector<Hierarchy> built;
    built.push_back(build_hierarchy(test::noisy_sphere(4, 1)));
    built.push_back(build_hierarchy(test::torus(60, 30)));
    built.push_back(build_hierarchy(test::grid(40, 40)));
    built.push_back(build_hierarchy(test::many_tetrahedra(200)));
    return built;
  }();
  return all;
}

// Some objects, a refiner for each number of threads, and what they are asked for, which changes from frame to frame.
class RandomFrames {
 public:
  explicit RandomFrames(unsigned seed) : random_(seed) {
    for (const Hierarchy& hierarchy : hierarchies()) add_object(hierarchy);
    add_object(hierarchies()[0]);  // two objects share it
    for (std::size_t i = 0; i < thread_counts.size(); ++i) {
      refiners_.emplace_back(objects_);
      software_.push_back(make_software_occlusion());
    }
    copies_.resize(objects_.size());
    camera_.width = 200;
    camera_.height = 150;
    camera_.near = 0.01;
    camera_.far = 100.0;
    options_.budget = refiners_[0].base_triangles() + 3000;
    occlusion_ = chance(4) != 0;
    jump();
  }

  // Returns what is wrong with the next frame, or nothing.
  std::string next() {
    change();
    show_anything();
    std::string fault;
    for (std::size_t i = 0; i < refiners_.size() && fault.empty(); ++i) {
      options_.threads = thread_counts[i];
      const Refinement& refined = update(i);
      fault = i == 0 ? fault_of_frame(refined) : difference(first_, refined);
      if (!fault.empty()) fault += " with " + std::to_string(options_.threads) + " threads";
      if (i == 0) first_ = refined;
    }
    return fault;
  }

 private:
  void add_object(const Hierarchy& hierarchy) {
    const bool mirrored = objects_.size() == 1;
    objects_.push_back({&hierarchy, glm::dmat4(1.0), objects_.size() == 2});
    const glm::dvec3 at(real(-2.0, 2.0), real(-2.0, 2.0), real(-2.0, 2.0));
    objects_.back().object_to_world =
        glm::scale(glm::translate(glm::dmat4(1.0), at), {mirrored ? -1.0 : 1.0, 1.0, 1.0});
  }

  const Refinement& update(std::size_t i) {
    return refiners_[i].update(View(camera_), options_, occlusion_ ? *software_[i] : static_cast<Visibility&>(none_));
  }

  // Shows all backends the same picture: noise, or one depth with holes. It may be of any view.
  void show_anything() {
    if (!shows_pictures_ || chance(4) == 0) return;
    Camera camera = camera_;
    if (chance(3) == 0) camera.eye = {real(-5.0, 5.0), real(-5.0, 5.0), real(-5.0, 5.0)};
    const View view(camera);
    std::vector<ObjectView> objects;
    for (const RefineObject& object : objects_) objects.emplace_back(view, object.object_to_world);
    picture_.reset(camera.width, camera.height);
    const bool is_noise = chance(2) == 0;
    const auto depth = static_cast<float>(real(0.0, 3.0));
    for (float& nearness : picture_.nearness)
      nearness = chance(is_noise ? 2 : 1000) == 0 ? static_cast<float>(real(0.0, 10.0)) : depth;
    for (const auto& software : software_) software->show(picture_, view, objects);
  }

  std::string fault_of_frame(const Refinement& refined) {
    std::size_t triangles = 0;
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      const RefinedObject& object = refined.objects[i];
      triangles += object.triangles.size();
      if (!take_over(object, copies_[i])) return "changes that leave out a triangle";
      if (std::string fault = fault_of(*objects_[i].hierarchy, object); !fault.empty()) return fault;
    }
    if (triangles > options_.budget) return "more triangles than the budget";
    return triangles == refined.stats.triangles ? "" : "a wrong number of triangles in the statistics";
  }

  void change() {
    move();
    if (chance(60) == 0) jump();
    if (chance(10) == 0) move_object(0.1, 0.1);
    if (chance(100) == 0) move_object(4.0, 3.0);
    if (chance(15) == 0) options_.budget = refiners_[0].base_triangles() + chance(6000);
    if (chance(300) == 0) occlusion_ = !occlusion_;
    if (chance(100) == 0) shows_pictures_ = !shows_pictures_;
    if (chance(200) == 0) options_.max_changes = chance(2) * chance(300);
    if (chance(200) == 0) options_.tolerance_px = chance(2) == 0 ? 0.0 : real(0.0, 4.0);
    if (chance(200) == 0) options_.geomorph_frames = chance(5);
    if (chance(400) == 0) tune(options_).culling = chance(4) == 0 ? Culling::subtree : Culling::star;
    if (chance(400) == 0) tune(options_).hysteresis = real(0.0, 0.5);
    if (chance(400) == 0) options_.mode = chance(4) == 0 ? OccluderMode::conservative : OccluderMode::paper;
  }

  // Goes on the way it goes, and turns a little; sometimes it rests.
  void move() {
    if (chance(40) == 0) rests_ = chance(6);
    if (rests_ > 0) {
      --rests_;
      return;
    }
    if (chance(20) == 0) way_ = {real(-0.05, 0.05), real(-0.05, 0.05), real(-0.05, 0.05)};
    camera_.eye += way_;
    if (glm::dot(camera_.eye, camera_.eye) > 64.0) jump();
  }

  void jump() {
    camera_.eye = {real(-5.0, 5.0), real(-5.0, 5.0), real(-5.0, 5.0)};
    camera_.target = {real(-1.0, 1.0), real(-1.0, 1.0), real(-1.0, 1.0)};
    camera_.fov_y_deg = real(20.0, 90.0);
  }

  void move_object(double far, double turn_rad) {
    const std::size_t i = chance(static_cast<std::uint32_t>(objects_.size()));
    glm::dmat4& placed = objects_[i].object_to_world;
    const glm::dvec3 by(real(-far, far), real(-far, far), real(-far, far));
    placed = glm::rotate(glm::translate(placed, by), real(-turn_rad, turn_rad), {0.6, 0.8, 0.0});
    if (glm::dot(glm::dvec3(placed[3]), glm::dvec3(placed[3])) > 25.0) placed[3] = {0.0, 0.0, 0.0, 1.0};
    for (Refiner& refiner : refiners_) refiner.set_transform(i, placed);
  }

  // Returns one of the numbers below `below`. The distributions of the standard library differ between libraries.
  std::uint32_t chance(std::uint32_t below) { return static_cast<std::uint32_t>(random_()) % below; }
  double real(double low, double high) { return low + (high - low) * static_cast<double>(random_()) / 0xFFFFFFFFU; }

  std::mt19937 random_;
  std::vector<RefineObject> objects_;
  std::vector<Refiner> refiners_;
  std::vector<std::unique_ptr<SoftwareOcclusion>> software_;
  DepthBuffer picture_;
  NoOcclusion none_;
  std::vector<std::vector<Triangle>> copies_;  // kept by what `changes` tells
  Refinement first_;                           // of one thread
  Camera camera_;
  glm::dvec3 way_{0.02, 0.0, 0.01};
  std::uint32_t rests_ = 0;
  RefineOptions options_;
  bool occlusion_ = true, shows_pictures_ = false;
};

// Two walks of 300 frames each; with OCCLOD_SOAK_S more for so many seconds, and a line every 5,000 frames.
TEST(RandomFrames, AreValidAndTheSameOnAnyNumberOfThreads) {
  constexpr std::size_t frames_of_a_walk = 300, least_walks = 2;
  const char* wanted = std::getenv("OCCLOD_SOAK_S");
  const double seconds = wanted != nullptr ? std::atoi(wanted) : 0.0;
  const Clock::time_point start = Clock::now();
  std::size_t frames = 0;
  for (unsigned walk = 0; walk < least_walks || milliseconds_since(start) < 1e3 * seconds; ++walk) {
    RandomFrames random(walk);
    for (std::size_t frame = 0; frame < frames_of_a_walk; ++frame, ++frames) {
      ASSERT_EQ(random.next(), "") << "walk " << walk << ", frame " << frame;
      if (wanted != nullptr && (frames + 1) % 5000 == 0) std::cout << frames + 1 << " frames" << std::endl;
    }
  }
}

}  // namespace
}  // namespace occlod
