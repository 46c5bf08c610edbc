// Occlusion queries of refinement: the interface that every backend implements, and the backends without a GPU.
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
#include "occlod/item_buffer.h"
#include "occlod/mesh.h"
#include "occlod/view.h"

namespace occlod {

// The convex hull of a few points, e.g. of the star of one split. The span need only stay valid during the call that
// takes it.
struct PointHull {
  std::span<const glm::vec3> points;  // object space, at least one
};

// Asks whether any part of a bound is in front of the occluder.
struct VisibilityQuery {
  std::uint32_t object = 0;                              // index into the objects of begin_view
  std::variant<Sphere, Box, Cylinder, PointHull> shape;  // object space
};

// Part of the occluder: triangles of one object. The spans need only stay valid during draw_occluder().
struct OccluderPart {
  std::uint32_t object = 0;              // index into the objects of begin_view
  std::span<const glm::vec3> positions;  // object space
  std::span<const Triangle> triangles;   // into positions
};

// An occlusion backend. All backends are conservative: a bound with a point in front of the occluder at some pixel that
// it touches is never answered 0. Bounds that cross the near plane, contain the eye, are not finite or whose screen
// rectangle cannot be bounded are answered visible. Queries are answered in the order in which they were submitted. One
// thread at a time may use a backend, except as answers_many_threads() allows.
class Visibility {
 public:
  Visibility() = default;
  Visibility(const Visibility&) = delete;
  Visibility& operator=(const Visibility&) = delete;
  virtual ~Visibility() = default;

  // Returns the name for calibrations and reports, e.g. "software".
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  // False for a backend that never hides anything; then no occluder is drawn and no query is submitted.
  [[nodiscard]] virtual bool can_hide() const noexcept { return true; }
  // Returns the number of queries that should be in flight at a time; 1 for backends that answer immediately.
  [[nodiscard]] virtual std::size_t flight() const noexcept { return 1; }

  // True when the backend answers from a picture of an earlier view until an occluder is drawn, so that none need be.
  // False by default.
  [[nodiscard]] virtual bool has_picture() const noexcept { return false; }

  // Says on how many threads the backend may draw from now on, at least 1; at first 1. For backends that draw on the
  // CPU; the others ignore it.
  virtual void set_threads(unsigned threads);
  // Starts a view and forgets the occluder and every unanswered query of the previous one. objects[i] is the view of
  // object i; the span need only stay valid during the call.
  virtual void begin_view(const View& view, std::span<const ObjectView> objects) = 0;
  // Replaces the occluder. Precondition: all submitted queries have been collected.
  virtual void draw_occluder(std::span<const OccluderPart> parts) = 0;
  // Submits one query, which a later collect() answers.
  virtual void submit(const VisibilityQuery& query) = 0;
  // Returns the answer to the oldest unanswered query: the number of visible pixels, 0 when hidden. Backends may stop
  // counting at the first visible pixel and answer 1. Precondition: some query is unanswered.
  [[nodiscard]] virtual std::uint32_t collect() = 0;

  // True when several threads may call answer() and find_visible_points() at once. False by default.
  [[nodiscard]] virtual bool answers_many_threads() const noexcept { return false; }
  // Answers each query as submit() and collect() do, for backends that are faster with many at once. Precondition: all
  // submitted queries have been collected; `answers` has the size of `queries`.
  virtual void answer(std::span<const VisibilityQuery> queries, std::span<std::uint32_t> answers);
  // Sets visible[i] to 1 when points[i] of the object (object space) is surely in front of the occluder, so that no
  // bound that contains it can be hidden, and to 0 otherwise. For backends that test a point much faster than a bound;
  // by default all are 0. `visible` has the size of `points`.
  virtual void find_visible_points(std::uint32_t object, std::span<const glm::vec3> points,
                                   std::span<std::uint8_t> visible);
  // True when find_visible_points() tests points, so that a 0 means something. False by default.
  [[nodiscard]] virtual bool tests_points() const noexcept { return false; }
};

// The backend `none`: everything inside the frustum and facing the eye is visible.
class NoOcclusion final : public Visibility {
 public:
  // Returns "none".
  [[nodiscard]] std::string_view name() const noexcept override { return "none"; }
  // Returns false.
  [[nodiscard]] bool can_hide() const noexcept override { return false; }
  // Returns true.
  [[nodiscard]] bool answers_many_threads() const noexcept override { return true; }
  // Forgets unanswered queries.
  void begin_view(const View& view, std::span<const ObjectView> objects) override;
  // Does nothing, because nothing is ever hidden.
  void draw_occluder(std::span<const OccluderPart> parts) override;
  // Counts the query for collect().
  void submit(const VisibilityQuery& query) override;
  // Returns 1: visible.
  [[nodiscard]] std::uint32_t collect() override;

 private:
  std::size_t unanswered_ = 0;
};

// The backend `software`: a CPU rasteriser and a depth pyramid, without GPU, display or driver. It works at the
// resolution of the view. A bound is hidden only if the occluder is strictly nearer than the bound's nearest point at
// every pixel that the bound may touch: the pixels of an octagon around its outline, or of a rectangle for boxes.
// Answers are the same on every machine. Many queries in one answer(), or submitted before the first is collected, cost
// a third of the same queries asked one by one. A bound beside the image touches no pixel and is answered 0; one whose
// screen rectangle cannot be bounded is visible. Until an occluder is drawn in a view, everything in the image is
// visible. Does not allocate once its buffers have grown.
//
// Where the caller shows it a picture between two views, it answers in the second with the depth of that picture
// instead, at half its size if that is even, and Refiner::update() draws no occluder. The picture may hold more than
// the mesh, e.g. what other parts of a program draw, but nothing translucent. A bound is hidden if the picture hides
// it, seen from where it was taken; what the view may show beyond the sides of the picture is visible. So what comes
// into sight is known when the next picture shows it. An occluder that is drawn all the same, because the view has
// jumped, replaces the picture.
class SoftwareOcclusion : public Visibility {
 public:
  // Shows a picture of the view and objects of the last begin_view(), i.e. of the last update(). `depth` has the size
  // of the view. Throws Error otherwise, and before the first view. O(pixels).
  virtual void show(const DepthBuffer& depth) = 0;
  // Shows a picture of an earlier view, for programs that read it back late: of `view`, in which objects[i] was the
  // view of object i. `depth` may be smaller than what was drawn, if it keeps the farthest depth of several pixels and
  // `view` has its size. Throws Error when the sizes differ. O(pixels).
  virtual void show(const DepthBuffer& depth, const View& view, std::span<const ObjectView> objects) = 0;
};

// Makes the backend `software`.
[[nodiscard]] std::unique_ptr<SoftwareOcclusion> make_software_occlusion();

}  // namespace occlod
