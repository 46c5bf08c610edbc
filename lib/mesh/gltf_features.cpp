#include "mesh/gltf_features.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <string_view>

#include "mesh/materials.h"

namespace occlod {
namespace {

constexpr const char* ids_name = "EXT_mesh_features";
constexpr const char* metadata_name = "EXT_structural_metadata";

std::string text_member(const tinygltf::Value& value, const std::string& key) {
  const tinygltf::Value& text = member(value, key);
  return text.IsString() ? text.Get<std::string>() : std::string();
}

const tinygltf::Value& gltf_extension(const tinygltf::ExtensionMap& extensions, const char* name) {
  static const tinygltf::Value none;
  const auto found = extensions.find(name);
  return found == extensions.end() ? none : found->second;
}

// Returns the set of ids that is read: the first by an attribute that has a table, or the first by an attribute.
const tinygltf::Value* chosen_of(const tinygltf::Value& sets) {
  const tinygltf::Value* chosen = nullptr;
  for (std::size_t i = 0; sets.IsArray() && i < sets.ArrayLen(); ++i) {
    const tinygltf::Value& set = sets.Get(static_cast<int>(i));
    if (index_member(set, "attribute") < 0) continue;
    if (chosen == nullptr || (index_member(*chosen, "propertyTable") < 0 && index_member(set, "propertyTable") >= 0))
      chosen = &set;
  }
  return chosen;
}

bool is_name(const std::string& key, const tinygltf::Value& property) {
  const tinygltf::Value& array = member(property, "array");
  return text_member(property, "type") == "STRING" && !(array.IsBool() && array.Get<bool>()) &&
         (key == "name" || text_member(property, "semantic") == "NAME");
}

std::size_t bytes_of_type(const std::string& type) {
  return type == "UINT8" ? 1 : type == "UINT16" ? 2 : type == "UINT64" ? 8 : 4;
}

std::uint64_t number_at(std::span<const std::uint8_t> bytes, std::size_t place, std::size_t size) {
  std::uint64_t number = 0;
  std::memcpy(&number, bytes.data() + place, size);
  return number;
}

}  // namespace

void GltfFeatures::begin_node(std::string name) {
  node_name_ = std::move(name);
  of_node_.reset();
  by_id_.clear();
}

void GltfFeatures::begin_primitive(const tinygltf::Primitive& primitive, std::size_t vertices) {
  attribute_.clear();
  ids_.reset();
  const tinygltf::Value& sets = member(gltf_extension(primitive.extensions, ids_name), "featureIds");
  const tinygltf::Value* const chosen = chosen_of(sets);
  soup_.left_out.add("metadata of primitives", primitive.extensions.contains(metadata_name) ? 1 : 0);
  if (sets.IsArray()) soup_.left_out.add("further sets of features", sets.ArrayLen() - (chosen != nullptr ? 1 : 0));
  if (chosen == nullptr) return;
  const std::string name = fmt::format("_FEATURE_ID_{}", index_member(*chosen, "attribute"));
  const auto found = primitive.attributes.find(name);
  if (found == primitive.attributes.end()) return;
  attribute_ = name;
  ids_ = std::make_unique<GltfAccessor>(views_, found->second, 1);
  if (ids_->count() < vertices)
    views_.errors().fail(fmt::format("accessor {}", found->second), "has fewer ids of features than there are vertices",
                         gltf_remedy);
  table_ = index_member(*chosen, "propertyTable");
  const int none = index_member(*chosen, "nullFeatureId");
  no_feature_ = none < 0 ? std::nullopt : std::optional(static_cast<std::uint64_t>(none));
}

FeatureId GltfFeatures::of_vertex(std::size_t vertex) {
  const double value = ids_ ? ids_->value(vertex, 0) : -1.0;
  const bool is_id = value >= 0.0 && value <= 0x1p53;
  const std::uint64_t id = is_id ? static_cast<std::uint64_t>(std::llround(value)) : 0;
  if (!is_id || id == no_feature_) {
    if (!of_node_) of_node_ = add(node_name_);
    return *of_node_;
  }
  const auto [found, is_new] = by_id_.try_emplace({table_, id}, 0);
  if (is_new) found->second = add(name_of(id));
  return found->second;
}

FeatureId GltfFeatures::add(std::string name) {
  soup_.feature_names.push_back(std::move(name));
  return static_cast<FeatureId>(soup_.feature_names.size() - 1);
}

// A feature that has no name in the file has the number in that of its node.
std::string GltfFeatures::name_of(std::uint64_t id) {
  const Names& names = names_of_table(table_);
  if (id < names.size()) return names[id];
  return fmt::format("{} {}", node_name_.empty() ? "feature" : node_name_, id);
}

const GltfFeatures::Names& GltfFeatures::names_of_table(int table) {
  const auto [found, is_new] = names_.try_emplace(table);
  if (!is_new || table < 0) return found->second;
  const tinygltf::Value& metadata = gltf_extension(views_.model().extensions, metadata_name);
  const tinygltf::Value& tables = member(metadata, "propertyTables");
  const std::string place = fmt::format("property table {}", table);
  if (!tables.IsArray() || static_cast<std::size_t>(table) >= tables.ArrayLen())
    views_.errors().fail(place, "is not there", gltf_remedy);
  found->second = read_names(tables.Get(table), member(member(metadata, "schema"), "classes"), place);
  return found->second;
}

// Reads the column of names, and counts the others.
GltfFeatures::Names GltfFeatures::read_names(const tinygltf::Value& table, const tinygltf::Value& classes,
                                             const std::string& place) {
  const tinygltf::Value& described = member(member(classes, text_member(table, "class")), "properties");
  const tinygltf::Value& columns = member(table, "properties");
  Names names;
  if (!columns.IsObject()) return names;
  for (const std::string& key : columns.Keys()) {
    if (!names.empty() || !is_name(key, member(described, key))) {
      soup_.left_out.add(fmt::format("property {} of features", key));
      continue;
    }
    const tinygltf::Value& column = member(columns, key);
    const int count = index_member(table, "count");
    const GltfViews::View text = views_.view(index_member(column, "values"), place);
    const GltfViews::View ends = views_.view(index_member(column, "stringOffsets"), place);
    const std::size_t size = bytes_of_type(text_member(column, "stringOffsetType"));
    if (count < 1 || std::min(ends.length, ends.bytes.size()) / size <= static_cast<std::size_t>(count))
      views_.errors().fail(place, "has fewer names than features", gltf_remedy);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const std::uint64_t begin = number_at(ends.bytes, i * size, size),
                          end = number_at(ends.bytes, (i + 1) * size, size);
      if (begin > end || end > std::min(text.length, text.bytes.size()))
        views_.errors().fail(place, fmt::format("has a name {} that reaches beyond its buffer", i), gltf_remedy);
      const auto name = text.bytes.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
      names.push_back(readable({reinterpret_cast<const char*>(name.data()), name.size()}));
    }
  }
  return names;
}

}  // namespace occlod
