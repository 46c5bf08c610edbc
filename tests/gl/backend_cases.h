// Cases with one right answer by geometry, for every backend and every kind of bound.
#pragma once

#include <array>
#include <deque>
#include <memory>

#include "gl/backends.h"
#include "oracle/random_shapes.h"

namespace occlod::gl {

class BackendCases : public EachBackend {
 protected:
  void SetUp() override;
  // Runs `body` for each kind of bound, each time with the wall as the occluder.
  template <class Body>
  void each_kind(Body body) {
    for (int kind = 0; kind < test::bound_kinds; ++kind) {
      kind_ = static_cast<test::BoundKind>(kind);
      SCOPED_TRACE(test::label(kind_));
      view_ = test_view();
      start(wall());
      body();
    }
  }
  void start(const Soup& occluder, const glm::dmat4& transform = glm::dmat4(1.0)) {
    EachBackend::start(*occlusion_, occluder, transform);
  }
  [[nodiscard]] std::uint32_t ask(const VisibilityQuery& query);
  // Of the kind whose turn it is, with these half extents along the axes; spheres take the smallest, cylinders (around
  // z) the smaller of x and y, so that none reaches farther than the box. A hull is the box's corners.
  [[nodiscard]] VisibilityQuery at(const glm::vec3& center, const glm::vec3& half);
  [[nodiscard]] VisibilityQuery at(const glm::vec3& center, float half) { return at(center, glm::vec3(half)); }

  std::unique_ptr<Visibility> occlusion_;
  test::BoundKind kind_ = test::BoundKind::box;

 private:
  std::deque<std::array<glm::vec3, 8>> hulls_;
};

// A square in the plane at height z, larger than the screen.
[[nodiscard]] Soup wide_wall(float z);

}  // namespace occlod::gl
