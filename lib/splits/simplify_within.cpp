// Searches the smallest mesh within a measured distance.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/memory.h"
#include "base/option_checker.h"
#include "occlod/simplify.h"
#include "splits/reducer.h"
#include "splits/surface_distance.h"

namespace occlod {
namespace {

// Returns the faces in the order of their smallest corners: where vertices are in spatial order, faces are too.
std::vector<Triangle> in_order_of_corners(std::span<const Triangle> faces, std::size_t vertex_count) {
  const auto key = [](const Triangle& t) { return std::min({t.x, t.y, t.z}); };
  std::vector<std::size_t> next(vertex_count + 1, 0);
  for (const Triangle& face : faces) ++next[key(face) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<Triangle> result(faces.size());
  for (const Triangle& face : faces) result[next[key(face)]++] = face;
  return result;
}

// Searches the smallest mesh within a distance of the input by bisection. Single places do not decide about the whole
// mesh, such as a speck that would vanish: vertices there are kept.
class DistanceSearch {
 public:
  DistanceSearch(const TriangleMesh& mesh, double max_distance, const SimplifyOptions& options)
      : options_(options),
        limit_(max_distance),
        reducer_(mesh, options),
        faces_(in_order_of_corners(ordered().triangles, ordered().vertex_count())),
        input_{ordered().positions, faces_},
        tree_(input_),
        locked_(ordered().vertex_count(), 0),
        best_{mesh, 0.0},
        enough_(mesh.triangle_count()) {}

  SimplifiedMesh run() {
    std::size_t count = enough_ / 10;
    while (!is_done()) {
      report_progress();
      count = std::clamp<std::size_t>(count, too_few_ + 1, enough_ - 1);
      if (!try_count(count)) too_few_ = count;
      count = static_cast<std::size_t>(std::sqrt(static_cast<double>(too_few_ + 1) * static_cast<double>(enough_)));
    }
    if (enough_ < ordered().triangle_count()) best_.distance = farthest_of_best();
    return std::move(best_);
  }

 private:
  using FarPlaces = std::vector<std::uint32_t>;
  static constexpr double exactness = 1.05;  // of the number of triangles

  [[nodiscard]] const TriangleMesh& ordered() const { return reducer_.ordered_mesh(); }
  [[nodiscard]] bool is_done() const {
    return enough_ <= too_few_ + 1 || static_cast<double>(enough_) <= exactness * static_cast<double>(too_few_);
  }

  [[nodiscard]] double farthest_of_best() const {
    const SurfaceView best{best_.mesh.positions, best_.mesh.triangles};
    return std::max(farthest_vertex(best, tree_, reducer_.threads()),
                    farthest_vertex(input_, SurfaceTree(best), reducer_.threads()));
  }

  // Reduces the mesh to about so many triangles, and keeps it if it is near enough and smaller than the best. Where
  // only few places are too far, locks the vertices of the input there and tries again, as long as the places become
  // fewer by a quarter with every second attempt.
  bool try_count(std::size_t count) {
    constexpr int most_attempts = 8;
    const std::vector<std::uint8_t> locked_before = locked_;
    std::size_t before = std::numeric_limits<std::size_t>::max(), before_that = before;  // numbers of places
    for (int attempt = 0; attempt < most_attempts; ++attempt) {
      TriangleMesh reduced = reducer_.reduced(count, locked_, keep_going());
      if (reduced.triangles.empty() || reduced.triangle_count() >= enough_) break;
      std::optional<FarPlaces> far = far_places({reduced.positions, reduced.triangles});
      if (!far) break;
      if (far->empty()) {
        enough_ = reduced.triangle_count();
        best_ = {std::move(reduced), 0.0};
        return true;
      }
      const std::size_t wanted = std::exchange(before_that, std::exchange(before, far->size())) / 4 * 3;
      if (far->size() > wanted) break;
      const std::size_t locked = lock(std::move(*far));
      if (locked == 0) break;
      count += locked;  // for what stays, so that nothing else has to go instead
    }
    locked_ = locked_before;
    return false;
  }

  // Returns the faces of the input where one surface is too far from the other; nothing where that are many.
  [[nodiscard]] std::optional<FarPlaces> far_places(const SurfaceView& reduced) const {
    constexpr std::size_t share = 10;
    const auto back = faces_beyond(limit_, reduced.faces.size() / share, reduced, tree_, reducer_.threads());
    if (!back) return std::nullopt;
    const auto there = faces_beyond(limit_, faces_.size() / share, input_, SurfaceTree(reduced), reducer_.threads());
    if (!there) return std::nullopt;
    FarPlaces result;
    for (const FarFace& far : *back) result.push_back(far.near);
    for (const FarFace& far : *there) result.push_back(far.face);
    return result;
  }
  // Locks the vertices of these faces, or where all are locked, those of more and more faces around them. Returns how
  // many were not locked before.
  std::size_t lock(FarPlaces places) {
    constexpr int most_rings = 3;
    std::size_t count = 0;
    for (int ring = 0; count == 0 && ring <= most_rings; ++ring) {
      if (ring > 0) add_neighbours(places);
      for (const std::uint32_t face : places)
        for (int k = 0; k < 3; ++k)
          if (std::exchange(locked_[faces_[face][k]], 1) == 0) ++count;
    }
    return count;
  }
  void add_neighbours(FarPlaces& places) const {
    for (std::size_t i = 0, size = places.size(); i < size; ++i)
      for (int k = 0; k < 3; ++k)
        if (const std::uint32_t next = tree_.neighbour(places[i], k); next != no_id) places.push_back(next);
  }

  // Each try may be cancelled, and reports nothing itself.
  [[nodiscard]] std::function<bool(double)> keep_going() const {
    if (!options_.progress) return {};
    return [this](double) { return options_.progress(done_); };
  }
  void report_progress() {
    const double all = std::log(static_cast<double>(ordered().triangle_count()) / exactness);
    const double left =
        std::log(static_cast<double>(enough_) / static_cast<double>(std::max<std::size_t>(too_few_, 1)));
    done_ = std::max(done_, std::clamp(1.0 - left / all, 0.0, 1.0));
  }

  const SimplifyOptions& options_;
  double limit_;
  Reducer reducer_;
  std::vector<Triangle> faces_;
  SurfaceView input_;
  SurfaceTree tree_;
  std::vector<std::uint8_t> locked_;
  SimplifiedMesh best_;
  std::size_t too_few_ = 0, enough_;  // numbers of triangles that were tried
  double done_ = 0.0;
};

}  // namespace

SimplifiedMesh simplify_within(const TriangleMesh& mesh, double max_distance, const SimplifyOptions& options) {
  OptionChecker("simplify").positive("max_distance", max_distance);
  const LargeMemoryReuse reuse;
  SimplifiedMesh result = DistanceSearch(mesh, max_distance, options).run();
  if (options.progress) (void)options.progress(1.0);
  return result;
}

}  // namespace occlod
