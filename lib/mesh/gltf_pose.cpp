#include "mesh/gltf_pose.h"

#include <fmt/format.h>

#include <array>
#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <optional>
#include <string>

namespace occlod {
namespace {

std::string place_of(int accessor) { return fmt::format("accessor {}", accessor); }

glm::dmat4 transform_of(const glm::dvec3& translation, const glm::dquat& rotation, const glm::dvec3& scale) {
  return glm::scale(glm::translate(glm::dmat4(1.0), translation) * glm::mat4_cast(rotation), scale);
}

}  // namespace

glm::dmat4 local_transform(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
  glm::dmat4 m(1.0);
  if (node.translation.size() == 3) m = glm::translate(m, glm::make_vec3(node.translation.data()));
  if (node.rotation.size() == 4)
    m *= glm::mat4_cast(glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]));
  if (node.scale.size() == 3) m = glm::scale(m, glm::make_vec3(node.scale.data()));
  return m;
}

GltfSkins::GltfSkins(GltfViews& views) : views_(views) {
  const std::vector<tinygltf::Node>& nodes = views.model().nodes;
  parents_.assign(nodes.size(), -1);
  for (std::size_t n = 0; n < nodes.size(); ++n)
    for (const int child : nodes[n].children)
      if (child >= 0 && static_cast<std::size_t>(child) < nodes.size())
        parents_[static_cast<std::size_t>(child)] = static_cast<int>(n);
}

glm::dmat4 GltfSkins::to_world(int node) const {
  const std::vector<tinygltf::Node>& nodes = views_.model().nodes;
  glm::dmat4 m(1.0);
  for (std::size_t steps = 0; node >= 0; ++steps) {
    if (steps > nodes.size())
      views_.errors().fail(fmt::format("node {}", node), "is not part of a tree of nodes", gltf_remedy);
    m = local_transform(nodes[static_cast<std::size_t>(node)]) * m;
    node = parents_[static_cast<std::size_t>(node)];
  }
  return m;
}

const std::vector<glm::dmat4>& GltfSkins::matrices(int skin) {
  const auto [found, is_new] = matrices_.try_emplace(skin);
  if (!is_new) return found->second;
  const tinygltf::Model& model = views_.model();
  const FileErrors& errors = views_.errors();
  if (skin < 0 || static_cast<std::size_t>(skin) >= model.skins.size())
    errors.fail("", fmt::format("refers to skin {}, which is not there", skin), gltf_remedy);
  const tinygltf::Skin& described = model.skins[static_cast<std::size_t>(skin)];
  const std::string place = fmt::format("skin {}", skin);
  std::optional<GltfAccessor> inverse;
  if (described.inverseBindMatrices >= 0) inverse.emplace(views_, described.inverseBindMatrices, 16);
  if (inverse && inverse->count() < described.joints.size())
    errors.fail(place, "has fewer inverse bind matrices than joints", gltf_remedy);
  for (std::size_t j = 0; j < described.joints.size(); ++j) {
    const int joint = described.joints[j];
    if (joint < 0 || static_cast<std::size_t>(joint) >= model.nodes.size())
      errors.fail(place, fmt::format("refers to node {}, which is not there", joint), gltf_remedy);
    glm::dmat4 bind(1.0);
    for (int k = 0; inverse && k < 16; ++k) bind[k / 4][k % 4] = inverse->value(j, k);
    found->second.push_back(to_world(joint) * bind);
  }
  if (found->second.empty()) errors.fail(place, "has no joints", gltf_remedy);
  return found->second;
}

GltfPlacement::GltfPlacement(GltfViews& views, const tinygltf::Primitive& primitive, std::size_t vertices,
                             const glm::dmat4& to_world, const std::vector<glm::dmat4>* joints)
    : views_(views), to_world_(to_world), joints_(joints) {
  if (joints == nullptr) return;
  for (int n = 0;; ++n) {
    const auto joint = primitive.attributes.find(fmt::format("JOINTS_{}", n));
    const auto weight = primitive.attributes.find(fmt::format("WEIGHTS_{}", n));
    if (joint == primitive.attributes.end() || weight == primitive.attributes.end()) break;
    sets_.emplace_back(std::make_unique<GltfAccessor>(views, joint->second, 4),
                       std::make_unique<GltfAccessor>(views, weight->second, 4));
    for (const auto& [set, accessor] :
         {std::pair(sets_.back().first.get(), joint->second), std::pair(sets_.back().second.get(), weight->second)})
      if (set->count() < vertices)
        views.errors().fail(place_of(accessor), "has fewer elements than there are vertices", gltf_remedy);
  }
  if (sets_.empty()) joints_ = nullptr;  // nothing says which joints: the node places it
}

// Weights are divided by their sum, which rounding of integers may keep from 1; without any, the first joint counts.
glm::dmat4 GltfPlacement::blended(std::size_t i) const {
  glm::dmat4 sum(0.0);
  double weights = 0.0;
  for (const auto& [joints, all_weights] : sets_)
    for (int k = 0; k < 4; ++k) {
      const double weight = all_weights->value(i, k), joint = joints->value(i, k);
      if (weight == 0.0) continue;
      if (!(joint >= 0.0 && joint < static_cast<double>(joints_->size())))
        views_.errors().fail("", fmt::format("has a vertex of joint {}, but the skin has {}", joint, joints_->size()),
                             gltf_remedy);
      sum += weight * (*joints_)[static_cast<std::size_t>(joint)];
      weights += weight;
    }
  return weights > 0.0 ? sum / weights : joints_->front();
}

MorphedAttribute::MorphedAttribute(GltfViews& views, const tinygltf::Primitive& primitive, const std::string& name,
                                   const std::vector<double>& weights)
    : base_(views, primitive.attributes.at(name), 3) {
  for (std::size_t t = 0; t < primitive.targets.size() && t < weights.size(); ++t) {
    const auto found = primitive.targets[t].find(name);
    if (weights[t] == 0.0 || found == primitive.targets[t].end()) continue;
    targets_.emplace_back(weights[t], std::make_unique<GltfAccessor>(views, found->second, 3));
    if (targets_.back().second->count() < base_.count())
      views.errors().fail(place_of(found->second), "has fewer elements than the attribute that it morphs", gltf_remedy);
  }
}

std::vector<glm::dmat4> instances_of(GltfViews& views, const tinygltf::Node& node, LeftOut& left_out) {
  const auto found = node.extensions.find("EXT_mesh_gpu_instancing");
  if (found == node.extensions.end()) return {glm::dmat4(1.0)};
  const tinygltf::Value& attributes = member(found->second, "attributes");
  std::array<std::unique_ptr<GltfAccessor>, 3> transforms;  // translation, rotation and scale
  std::optional<std::size_t> count;
  for (const std::string& name : attributes.Keys()) {
    const int index = index_member(attributes, name);
    const int kind = name == "TRANSLATION" ? 0 : name == "ROTATION" ? 1 : name == "SCALE" ? 2 : -1;
    auto accessor = std::make_unique<GltfAccessor>(views, index, kind < 0 ? 1 : kind == 1 ? 4 : 3);
    if (count && *count != accessor->count())
      views.errors().fail(place_of(index),
                          fmt::format("has {} instances where others have {}", accessor->count(), *count), gltf_remedy);
    count = accessor->count();
    if (kind < 0)
      left_out.add(name + " of instances", *count);
    else
      transforms[static_cast<std::size_t>(kind)] = std::move(accessor);
  }
  if (!count) return {glm::dmat4(1.0)};
  const auto& [translations, rotations, scales] = transforms;
  const auto vector = [](const std::unique_ptr<GltfAccessor>& from, std::size_t i, double otherwise) {
    return from ? glm::dvec3(from->value(i, 0), from->value(i, 1), from->value(i, 2)) : glm::dvec3(otherwise);
  };
  std::vector<glm::dmat4> instances;
  for (std::size_t i = 0; i < *count; ++i) {
    glm::dquat rotation(1.0, 0.0, 0.0, 0.0);
    if (rotations)
      rotation =
          glm::dquat(rotations->value(i, 3), rotations->value(i, 0), rotations->value(i, 1), rotations->value(i, 2));
    if (const double length = glm::length(rotation); length > 0.0) rotation /= length;  // integers are rounded
    instances.push_back(transform_of(vector(translations, i, 0.0), rotation, vector(scales, i, 1.0)));
  }
  return instances;
}

}  // namespace occlod
