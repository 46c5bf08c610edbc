// Where glTF files place vertices beside the transforms of nodes: skins and morph targets as they are without an
// animation, and instances.
#pragma once

#include <cstddef>
#include <functional>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "mesh/gltf_accessor.h"
#include "mesh/polygon_soup.h"
#include "mesh/tinygltf.h"

namespace occlod {

// Returns the transform of a node relative to its parent.
[[nodiscard]] glm::dmat4 local_transform(const tinygltf::Node& node);

// The matrices of skins: joints as their nodes are placed in the file, times the inverse bind matrices.
class GltfSkins {
 public:
  explicit GltfSkins(GltfViews& views);

  // Throws Error when the skin, a joint or a matrix is not there.
  [[nodiscard]] const std::vector<glm::dmat4>& matrices(int skin);

 private:
  [[nodiscard]] glm::dmat4 to_world(int node) const;

  GltfViews& views_;
  std::vector<int> parents_;  // by node; -1: none
  std::map<int, std::vector<glm::dmat4>> matrices_;
};

// Places the vertices of a primitive, by the transform of its node or, if it is skinned, by its joints alone, as glTF
// has it.
class GltfPlacement {
 public:
  // `joints` is null for a primitive that is not skinned. Throws Error when a vertex lacks joints or weights.
  GltfPlacement(GltfViews& views, const tinygltf::Primitive& primitive, std::size_t vertices,
                const glm::dmat4& to_world, const std::vector<glm::dmat4>* joints);

  // Returns the transform of vertex i to world space.
  [[nodiscard]] glm::dmat4 of_vertex(std::size_t i) const { return joints_ == nullptr ? to_world_ : blended(i); }
  [[nodiscard]] bool is_skinned() const { return joints_ != nullptr; }

 private:
  [[nodiscard]] glm::dmat4 blended(std::size_t i) const;

  GltfViews& views_;
  glm::dmat4 to_world_;
  const std::vector<glm::dmat4>* joints_;
  std::vector<std::pair<std::unique_ptr<GltfAccessor>, std::unique_ptr<GltfAccessor>>> sets_;  // joints and weights
};

// The values of an attribute with three components, morphed by weights.
class MorphedAttribute {
 public:
  // `weights` may have fewer elements than the primitive has targets; the others are 0.
  MorphedAttribute(GltfViews& views, const tinygltf::Primitive& primitive, const std::string& name,
                   const std::vector<double>& weights);

  [[nodiscard]] std::size_t count() const { return base_.count(); }
  [[nodiscard]] glm::dvec3 value(std::size_t i) const {
    glm::dvec3 sum(base_.value(i, 0), base_.value(i, 1), base_.value(i, 2));
    for (const auto& [weight, target] : targets_)
      sum += weight * glm::dvec3(target->value(i, 0), target->value(i, 1), target->value(i, 2));
    return sum;
  }

 private:
  GltfAccessor base_;
  std::vector<std::pair<double, std::unique_ptr<GltfAccessor>>> targets_;
};

// Returns the transforms of a node's instances (EXT_mesh_gpu_instancing) relative to the node, or one identity for a
// node without any. Counts attributes of instances that only programs know. Throws Error for accessors that do not fit
// together.
[[nodiscard]] std::vector<glm::dmat4> instances_of(GltfViews& views, const tinygltf::Node& node, LeftOut& left_out);

}  // namespace occlod
