#include "gl/backend_cases.h"

#include <algorithm>

namespace occlod::gl {

void BackendCases::SetUp() {
  EachBackend::SetUp();
  if (!IsSkipped()) occlusion_ = make();
}

std::uint32_t BackendCases::ask(const VisibilityQuery& query) {
  occlusion_->submit(query);
  return occlusion_->collect();
}

VisibilityQuery BackendCases::at(const glm::vec3& center, const glm::vec3& half) {
  const Box box{center - half, center + half};
  switch (kind_) {
    case test::BoundKind::sphere:
      return {0, Sphere{center, std::min({half.x, half.y, half.z})}};
    case test::BoundKind::box:
      return {0, box};
    case test::BoundKind::cylinder:
      return {0, Cylinder{center, std::min(half.x, half.y), {0, 0, 1}, -half.z, half.z}};
    default: {
      std::array<glm::vec3, 8>& corners = hulls_.emplace_back();
      for (int i = 0; i < 8; ++i) corners[static_cast<std::size_t>(i)] = corner(box, i);
      return {0, PointHull{corners}};
    }
  }
}

Soup wide_wall(float z) {
  Soup soup;
  const float size = 100.0F;
  soup.add_quad({-size, -size, z}, {size, -size, z}, {size, size, z}, {-size, size, z});
  return soup;
}

}  // namespace occlod::gl
