#include "front_look.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "math/inverse_power_of_two.h"

namespace occlod {

// The rays to all of its faces count as parallel.
StarView look(const FrontStar& star, const ObjectView& view, bool two_sided) {
  const glm::vec3 from_center = view.eye() - star.sphere.center;
  const float unit = inverse_power_of_two(from_center);
  const glm::vec3 eye = unit * from_center;
  FrontStar::Lanes facing;
  for (std::size_t i = 0; i < FrontStar::most_faces; ++i)
    facing[i] = star.normal_x[i] * eye.x + star.normal_y[i] * eye.y + star.normal_z[i] * eye.z + unit * star.offset[i];
  if (two_sided)
    for (float& f : facing) f = std::abs(f);
  std::uint32_t seen_faces = 0;
  float whole = 0.0F, seen = 0.0F;
  for (std::size_t i = 0; i < FrontStar::most_faces; ++i) {
    const bool is_seen = facing[i] > 0.0F;
    seen_faces += is_seen ? 1 : 0;
    whole += is_seen ? star.length[i] : 0.0F;
    seen += is_seen ? facing[i] : 0.0F;
  }
  StarView result;
  result.sphere = star.sphere;
  if (two_sided) seen_faces = star.faces;
  if (star.faces > 0) result.visible_share = static_cast<float>(seen_faces) / static_cast<float>(star.faces);
  if (whole > 0.0F) result.cosine = std::min(seen / (whole * glm::length(eye)), 1.0F);
  return result;
}

}  // namespace occlod
