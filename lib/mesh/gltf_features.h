// Features of glTF files: nodes, and what EXT_mesh_features tells apart within them by ids of vertices, with the names
// that EXT_structural_metadata has for those.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mesh/gltf_accessor.h"
#include "mesh/polygon_soup.h"
#include "mesh/tinygltf.h"

namespace occlod {

// Numbers features in the order in which they are asked for. Nodes and primitives must be begun before.
class GltfFeatures {
 public:
  // Adds names to a soup, and counts what is left out; views and soup outlive it.
  GltfFeatures(GltfViews& views, SoupTables& soup) : views_(views), soup_(soup) {}

  // Begins a node, whose name, its own or another's, is UTF-8.
  void begin_node(std::string name);
  // Begins a primitive with so many vertices. Throws Error when there are fewer ids.
  void begin_primitive(const tinygltf::Primitive& primitive, std::size_t vertices);
  // Returns the attribute that has the ids of the primitive's vertices; empty where its node is its only feature.
  [[nodiscard]] const std::string& attribute() const { return attribute_; }
  // Returns the feature of triangles whose first corner is this vertex of the primitive.
  [[nodiscard]] FeatureId of_vertex(std::size_t vertex);

 private:
  using Names = std::vector<std::string>;

  FeatureId add(std::string name);
  [[nodiscard]] std::string name_of(std::uint64_t id);
  [[nodiscard]] const Names& names_of_table(int table);
  [[nodiscard]] Names read_names(const tinygltf::Value& table, const tinygltf::Value& classes,
                                 const std::string& place);

  GltfViews& views_;
  SoupTables& soup_;
  std::string node_name_;
  std::optional<FeatureId> of_node_;
  std::map<std::pair<int, std::uint64_t>, FeatureId> by_id_;  // of the node, by table
  std::map<int, Names> names_;                                // by table
  std::string attribute_;                                     // of the primitive, like the members below
  std::unique_ptr<GltfAccessor> ids_;
  std::optional<std::uint64_t> no_feature_;  // the id of vertices without one
  int table_ = -1;
};

}  // namespace occlod
