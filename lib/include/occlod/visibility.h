// What refinement asks about occlusion, and the interface that every backend implements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string_view>
#include <variant>

#include "occlod/bounds.h"
#include "occlod/mesh.h"
#include "occlod/view.h"

namespace occlod {

// The convex hull of a few points, e.g. the star of one split. The span need live only while it is asked about.
struct PointHull {
  std::span<const glm::vec3> points;  // object space, at least one
};

// Is any of this in front of the occluder?
struct VisibilityQuery {
  std::uint32_t object = 0;                              // index into the objects of begin_view
  std::variant<Sphere, Box, Cylinder, PointHull> shape;  // object space
};

// Part of the occluder: triangles of one object. The spans need live only during draw_occluder().
struct OccluderPart {
  std::uint32_t object = 0;              // index into the objects of begin_view
  std::span<const glm::vec3> positions;  // object space
  std::span<const Triangle> triangles;   // into positions
};

// A backend. All are conservative: a bound that has a point in front of the occluder at some pixel that it touches is
// never answered 0. Bounds that cross the near plane, contain the eye, are not finite or whose screen rectangle cannot
// be bounded are answered visible. Queries are answered in the order in which they were submitted. One thread at a
// time, but for answers_many_threads().
class Visibility {
 public:
  Visibility() = default;
  Visibility(const Visibility&) = delete;
  Visibility& operator=(const Visibility&) = delete;
  virtual ~Visibility() = default;

  // As in calibrations and reports, e.g. "software".
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  // False for a backend that never hides anything: then no occluder is drawn and nothing is asked.
  [[nodiscard]] virtual bool can_hide() const noexcept { return true; }
  // How many queries should be under way at a time; 1 for backends that answer immediately.
  [[nodiscard]] virtual std::size_t flight() const noexcept { return 1; }

  // Starts a view: forgets the occluder and every unanswered query of an earlier one. objects[i] is the view of object
  // i; the span need live only during the call.
  virtual void begin_view(const View& view, std::span<const ObjectView> objects) = 0;
  // Replaces the occluder. Precondition: every query submitted before has been collected.
  virtual void draw_occluder(std::span<const OccluderPart> parts) = 0;
  // Asks one query, answered by a later collect().
  virtual void submit(const VisibilityQuery& query) = 0;
  // The answer to the oldest unanswered query: the number of visible pixels, 0 when hidden. Backends may stop counting
  // at the first visible pixel and answer 1. Precondition: some query is unanswered.
  [[nodiscard]] virtual std::uint32_t collect() = 0;

  // Whether several threads may call the following two at once. False if not told otherwise.
  [[nodiscard]] virtual bool answers_many_threads() const noexcept { return false; }
  // As submit() and collect() of each, for backends that can do more at once. Precondition: every query submitted
  // before has been collected; `answers` has as many places.
  virtual void answer(std::span<const VisibilityQuery> queries, std::span<std::uint32_t> answers);
  // Of points of an object (object space): 1 for those that surely are before the occluder, so that no bound that holds
  // them can be hidden; 0 for all others. For backends to which a point is much less work than a bound; by default none
  // is known. `visible` has as many places.
  virtual void find_visible_points(std::uint32_t object, std::span<const glm::vec3> points,
                                   std::span<std::uint8_t> visible);
};

// The backend `none`: everything inside the frustum and facing the eye is visible.
class NoOcclusion final : public Visibility {
 public:
  // "none".
  [[nodiscard]] std::string_view name() const noexcept override { return "none"; }
  // False.
  [[nodiscard]] bool can_hide() const noexcept override { return false; }
  // True.
  [[nodiscard]] bool answers_many_threads() const noexcept override { return true; }
  // Forgets unanswered queries.
  void begin_view(const View& view, std::span<const ObjectView> objects) override;
  // Does nothing.
  void draw_occluder(std::span<const OccluderPart> parts) override;
  // Counts the query, for collect().
  void submit(const VisibilityQuery& query) override;
  // 1: visible.
  [[nodiscard]] std::uint32_t collect() override;

 private:
  std::size_t unanswered_ = 0;
};

// The backend `software`: a CPU depth raster and a depth pyramid. No GPU, no display, no driver.

// How the software backend answers.
struct SoftwareOcclusionOptions {
  bool count_pixels = false;  // answer with the number of visible pixels that the bound may touch instead of 0 or 1
};

// Works at the resolution of the view. A bound is hidden only if the occluder is strictly nearer than the bound's
// nearest point at every pixel that it may touch: those of an octagon around its outline, or of a rectangle for boxes.
// The same answers on every machine. Many queries in one answer() or submitted before the first is collected cost a
// third of the same queries asked one by one. A bound that lies beside the image touches no pixel and is answered 0;
// one whose screen rectangle cannot be bounded is visible (with count_pixels: all pixels). Until an occluder is drawn
// in a view, everything in the image is visible. Does not allocate once its buffers have grown.
[[nodiscard]] std::unique_ptr<Visibility> make_software_occlusion(const SoftwareOcclusionOptions& options = {});

}  // namespace occlod
