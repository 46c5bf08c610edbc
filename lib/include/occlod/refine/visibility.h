// The one question that refinement asks about occlusion, and the interface that every backend implements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <string_view>
#include <variant>

#include "occlod/math/bounds.h"
#include "occlod/mesh/triangle_mesh.h"
#include "occlod/view/view.h"

namespace occlod {

// The convex hull of a few points, e.g. the star of one split. The span need live only during submit().
struct PointHull {
  std::span<const glm::vec3> points;  // object space, at least one
};

// "Is any of this in front of the occluder?"
struct VisibilityQuery {
  std::uint32_t object = 0;                              // index into the objects of begin_view
  std::variant<Sphere, Box, Cylinder, PointHull> shape;  // object space
};

// Part of the occluder: the triangles that are now active in one object.
struct OccluderPart {
  std::uint32_t object = 0;
  std::span<const glm::vec3> positions;  // object space
  std::span<const Triangle> triangles;   // into positions
};

// A backend. All are conservative about bounds: a bound of which any point is in front of the occluder at a pixel that
// it touches is never answered 0. Bounds that cross the near plane, hold the eye, are not finite or leave no screen
// rectangle that can be trusted are answered visible. Queries are answered in the order in which they were submitted.
class Visibility {
 public:
  Visibility() = default;
  Visibility(const Visibility&) = delete;
  Visibility& operator=(const Visibility&) = delete;
  virtual ~Visibility() = default;

  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  // False for the backend that never hides anything: then no occluder is drawn and nothing is asked.
  [[nodiscard]] virtual bool can_hide() const noexcept { return true; }
  // How many queries should be under way at once; 1 for backends that answer at once.
  [[nodiscard]] virtual std::size_t flight() const noexcept { return 1; }

  // Starts a view: forgets the occluder and every unanswered query of an earlier one. objects[i] = object i's view.
  virtual void begin_view(const View& view, std::span<const ObjectView> objects) = 0;
  // Replaces the occluder. Every query submitted before has been collected.
  virtual void draw_occluder(std::span<const OccluderPart> parts) = 0;
  // Asks one question, answered by a later collect().
  virtual void submit(const VisibilityQuery& query) = 0;
  // The answer to the oldest unanswered query: a number of visible pixels, 0 = hidden. Backends may stop counting at
  // the first visible pixel; then the answer is 1. Precondition: some query is unanswered.
  [[nodiscard]] virtual std::uint32_t collect() = 0;
};

// The backend `none`: everything inside the frustum and facing the eye is visible.
class NoOcclusion final : public Visibility {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "none"; }
  [[nodiscard]] bool can_hide() const noexcept override { return false; }
  void begin_view(const View& view, std::span<const ObjectView> objects) override;
  void draw_occluder(std::span<const OccluderPart> parts) override;
  void submit(const VisibilityQuery& query) override;
  [[nodiscard]] std::uint32_t collect() override;

 private:
  std::size_t unanswered_ = 0;
};

}  // namespace occlod
