#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "splits/star_patch.h"

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splits/patch_rows.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Nodes = hn::CappedTag<float, NodeExtents::capacity>;
using Counts = hn::RebindToSigned<Nodes>;
using NodeVec = hn::Vec<Nodes>;
using NodeMask = hn::Mask<Nodes>;

HWY_INLINE NodeVec set(float value) { return hn::Set(Nodes(), value); }
HWY_INLINE NodeVec load(const float* values) { return hn::LoadU(Nodes(), values); }

struct Vectors {
  NodeVec x, y, z;
};
HWY_INLINE NodeVec dot(const Vectors& a, const Vectors& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE NodeVec difference(NodeVec a, NodeVec b, NodeVec c, NodeVec d) {
  return hn::Sub(hn::Mul(a, b), hn::Mul(c, d));
}

// Accumulates extents; a lane is a node, or a part of the patches of one node.
class Extents {
 public:
  explicit HWY_INLINE Extents(const Vectors& axis)
      : axis_(axis), cos_angle_(set(1.0F)), has_normal_(hn::Gt(cos_angle_, cos_angle_)) {}

  // Includes the patch at `place` in the first lane, the next patch in the next lane, and so on.
  HWY_INLINE void include(const PatchRows& patches, std::size_t place, NodeMask counts) {
    const auto row = [&](PatchRows::Row r) HWY_ATTR { return load(patches.row(r) + place); };
    const NodeVec cos_angle = row(PatchRows::cos_angle);
    const NodeMask has_normal = hn::And(counts, hn::Ne(cos_angle, set(PatchRows::no_normal)));
    has_normal_ = hn::Or(has_normal_, has_normal);
    const Vectors axis = {row(PatchRows::axis_x), row(PatchRows::axis_y), row(PatchRows::axis_z)};
    lower(cos_angle_, widened(axis, cos_angle, row(PatchRows::sin_angle)), has_normal);
  }

  HWY_INLINE void store(NodeExtents& nodes, std::size_t i) const {
    const Nodes d;
    hn::StoreU(cos_angle_, d, nodes.cos_angle.data() + i);
    const NodeVec one = hn::BitCast(d, hn::Set(Counts(), 1));
    hn::StoreU(hn::BitCast(Counts(), hn::IfThenElseZero(has_normal_, one)), Counts(), nodes.has_normal.data() + i);
  }

  // Merges all lanes into one node, which has other patches too.
  HWY_INLINE void add_to(NodeExtents& nodes, std::size_t i) const {
    const Nodes d;
    nodes.cos_angle[i] = std::min(nodes.cos_angle[i], hn::GetLane(hn::MinOfLanes(d, cos_angle_)));
    nodes.has_normal[i] |= hn::AllFalse(d, has_normal_) ? 0 : 1;
  }

 private:
  // Vector form of widened() below.
  HWY_INLINE NodeVec widened(const Vectors& axis, NodeVec cos_angle, NodeVec sin_angle) const {
    const NodeVec zero = hn::Zero(Nodes()), cos_between = dot(axis_, axis);
    const Vectors cross = {difference(axis_.y, axis.z, axis.y, axis_.z), difference(axis_.z, axis.x, axis.z, axis_.x),
                           difference(axis_.x, axis.y, axis.x, axis_.y)};
    const NodeVec sin_between = hn::Sqrt(dot(cross, cross));
    const NodeVec cos_sum =
        hn::Sub(hn::Sub(hn::Mul(cos_between, cos_angle), hn::Mul(sin_between, sin_angle)), set(cone_slack));
    const NodeMask is_narrow = hn::And(hn::Gt(cos_between, zero), hn::Gt(cos_angle, zero));
    return hn::IfThenElse(is_narrow, cos_sum, set(-1.0F));
  }

  static HWY_INLINE void lower(NodeVec& least, NodeVec value, NodeMask counts) {
    least = hn::IfThenElse(hn::And(counts, hn::Lt(value, least)), value, least);
  }

  Vectors axis_;
  NodeVec cos_angle_;
  NodeMask has_normal_;
};

void include_patches_in(const PatchRows& patches, std::size_t first, NodeExtents& nodes) {
  for (std::size_t i = 0; i < NodeExtents::capacity; i += hn::Lanes(Nodes())) {
    Extents extents({load(nodes.axis_x.data() + i), load(nodes.axis_y.data() + i), load(nodes.axis_z.data() + i)});
    const auto size = hn::LoadU(Counts(), nodes.size.data() + i);
    for (std::int32_t k = 0;; ++k) {
      const auto counts = hn::RebindMask(Nodes(), hn::Gt(size, hn::Set(Counts(), k)));
      if (hn::AllFalse(Nodes(), counts)) break;
      extents.include(patches, first + i + static_cast<std::size_t>(k), counts);
    }
    extents.store(nodes, i);
  }
}

void include_run_in(const PatchRows& patches, std::size_t first, std::size_t end, NodeExtents& nodes,
                    std::size_t node) {
  Extents extents({set(nodes.axis_x[node]), set(nodes.axis_y[node]), set(nodes.axis_z[node])});
  for (std::size_t place = first; place < end; place += hn::Lanes(Nodes()))
    extents.include(patches, place, hn::FirstN(Nodes(), end - place));
  extents.add_to(nodes, node);
}

}  // namespace
}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {
namespace {

HWY_EXPORT(include_patches_in);
HWY_EXPORT(include_run_in);

}  // namespace

PatchRows::PatchRows(std::size_t size) : size_(size), stride_((size + padding + 15) & ~std::size_t{15}) {
  const std::size_t bytes = row_count * stride_ * sizeof(float);
  values_ = {static_cast<float*>(allocate_large(bytes)), Delete{bytes}};
  for (std::size_t row = 0; row < row_count; ++row)
    std::fill(values_.get() + row * stride_ + size_, values_.get() + (row + 1) * stride_, 0.0F);
}

void PatchRows::set(std::size_t i, const Patch& patch) noexcept {
  float* const first = values_.get() + i;
  const auto put = [&](Row row, float value) { first[row * stride_] = value; };
  put(axis_x, patch.axis.x);
  put(axis_y, patch.axis.y);
  put(axis_z, patch.axis.z);
  put(cos_angle, patch.has_normal ? patch.cos_angle : no_normal);
  put(sin_angle, patch.sin_angle);
}

Patch PatchRows::operator[](std::size_t i) const noexcept {
  const auto get = [&](Row which) { return row(which)[i]; };
  const bool has_normal = get(cos_angle) != no_normal;
  return {{get(axis_x), get(axis_y), get(axis_z)}, has_normal ? get(cos_angle) : 1.0F, get(sin_angle), has_normal};
}

void NodeExtents::start(std::size_t node, const glm::vec3& axis) {
  axis_x[node] = axis.x;
  axis_y[node] = axis.y;
  axis_z[node] = axis.z;
}

void include_patches(const PatchRows& patches, std::size_t first, NodeExtents& nodes) {
  HWY_DYNAMIC_DISPATCH(include_patches_in)(patches, first, nodes);
}

void include_run(const PatchRows& patches, std::size_t first, std::size_t end, NodeExtents& nodes, std::size_t node) {
  HWY_DYNAMIC_DISPATCH(include_run_in)(patches, first, end, nodes, node);
}

float widened(const glm::vec3& axis, const Patch& patch) {
  const float cos_between = glm::dot(axis, patch.axis);
  if (cos_between <= 0.0F || patch.cos_angle <= 0.0F) return -1.0F;
  // Uses the cross product, because the root of 1 - cos^2 is mostly rounding error for small angles.
  const float sin_between = glm::length(glm::cross(axis, patch.axis));
  return cos_between * patch.cos_angle - sin_between * patch.sin_angle - cone_slack;
}

}  // namespace occlod
#endif  // HWY_ONCE
