#include "splits/star_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "splits/star.h"

namespace occlod {
namespace {

// Returns zero for a face without area. Uses double precision, because the corners of a sliver are nearly collinear.
glm::vec3 unit_normal(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::dvec3 from(a);
  const glm::dvec3 normal = glm::cross(glm::dvec3(b) - from, glm::dvec3(c) - from);
  const double length2 = glm::dot(normal, normal);
  return length2 > 0.0 ? glm::vec3(normal / std::sqrt(length2)) : glm::vec3(0.0F);
}

glm::vec3 axis_of(const glm::vec3& sum) {
  const float length2 = glm::dot(sum, sum);
  return length2 > 1e-12F ? sum / std::sqrt(length2) : glm::vec3(0, 0, 1);
}

// Extends the cone around patch.axis so that it contains one more normal.
void include_normal(Patch& patch, const glm::vec3& normal) {
  patch.has_normal = true;
  patch.cos_angle = std::min(patch.cos_angle, glm::dot(patch.axis, normal));
  const glm::vec3 cross = glm::cross(patch.axis, normal);
  patch.sin_angle = std::max(patch.sin_angle, glm::dot(cross, cross));  // squared until close_cone
}

void close_cone(Patch& patch) {
  patch.sin_angle = std::sqrt(patch.sin_angle) + normal_slack;
  patch.cos_angle = patch.cos_angle > normal_slack ? patch.cos_angle - normal_slack : -1.0F;
}

// Bounds the corners and faces of a fan.
class FanPatch {
 public:
  FanPatch(const SplitStar& star, std::span<const glm::vec3> positions)
      : star_(star), origin_(positions[star.vertex()]), size_(star.ring().size()) {
    for (std::size_t i = 0; i < size_; ++i) corners_[i] = positions[star.ring()[i]];
  }

  BoundedPatch bound() {
    make_normals();
    BoundedPatch result;
    result.box = {origin_, origin_};
    for (std::size_t i = 0; i < size_; ++i) {
      result.box.min = glm::min(result.box.min, corners_[i]);
      result.box.max = glm::max(result.box.max, corners_[i]);
    }
    Patch& patch = result.patch;
    glm::vec3 sum(0.0F);
    for (std::size_t i = 0; i < normal_count_; ++i) sum += normals_[i];
    patch.axis = axis_of(sum);
    for (std::size_t i = 0; i < normal_count_; ++i) include_normal(patch, normals_[i]);
    close_cone(patch);
    return result;
  }

 private:
  void make_normals() {
    std::size_t parent = 0;
    while (star_.ring()[parent] != star_.parent_vertex()) ++parent;
    for (std::size_t slot = 0; slot < star_.inserted_count(); ++slot) {
      const std::size_t next = slot + 1 == size_ ? 0 : slot + 1;
      add_normal(origin_, slot, next);
      if (slot != parent && next != parent) add_normal(corners_[parent], slot, next);
    }
  }

  // Adds the normal of the triangle from apex to two places of the ring.
  void add_normal(const glm::vec3& apex, std::size_t i, std::size_t j) {
    const glm::vec3 a = corners_[i] - apex, b = corners_[j] - apex;
    const glm::vec3 normal = glm::cross(a, b);
    const float length2 = glm::dot(normal, normal);
    if (length2 > min_sin2 * glm::dot(a, a) * glm::dot(b, b) && length2 > 1e-30F && length2 < 1e30F) {
      normals_[normal_count_++] = normal * (1.0F / std::sqrt(length2));
      return;
    }
    const glm::vec3 exact = unit_normal(apex, corners_[i], corners_[j]);
    if (exact != glm::vec3(0.0F)) normals_[normal_count_++] = exact;
  }

  const SplitStar& star_;
  glm::vec3 origin_;
  std::size_t size_;
  std::array<glm::vec3, SplitStar::max_ring> corners_;
  std::array<glm::vec3, 2 * SplitStar::max_ring> normals_;
  std::size_t normal_count_ = 0;
};

BoundedPatch bound_any(const SplitStar& star, std::span<const glm::vec3> positions) {
  const glm::vec3& own = positions[star.vertex()];
  BoundedPatch result{{}, {own, own}};
  Patch& patch = result.patch;
  glm::vec3 sum(0.0F);
  star.for_each_face([&](const Triangle& t) {
    for (int k = 0; k < 3; ++k) {
      result.box.min = glm::min(result.box.min, positions[t[k]]);
      result.box.max = glm::max(result.box.max, positions[t[k]]);
    }
    sum += unit_normal(positions[t.x], positions[t.y], positions[t.z]);
  });
  patch.axis = axis_of(sum);
  star.for_each_face([&](const Triangle& t) {
    const glm::vec3 normal = unit_normal(positions[t.x], positions[t.y], positions[t.z]);
    if (normal != glm::vec3(0.0F)) include_normal(patch, normal);
  });
  close_cone(patch);
  return result;
}

}  // namespace

BoundedPatch bound_star(const SplitStar& star, std::span<const glm::vec3> positions) {
  return star.is_fan() ? FanPatch(star, positions).bound() : bound_any(star, positions);
}

}  // namespace occlod
