#include "hlod/tiles/feature_table.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "mesh/wedges.h"

namespace occlod::tiles {
namespace {

using Json = GlbDocument::Json;

void append(std::string& bytes, std::uint32_t number) {
  for (unsigned shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(number >> shift & 0xffU);
}

// Adds a column of the table. Returns its buffer view, which is at a multiple of 8 bytes and not empty.
std::size_t add_column(GlbDocument& document, std::string& buffer, std::string bytes) {
  if (buffer.size() % 8 != 0) {
    document.reserve(4);
    buffer.append(4, '\0');
  }
  if (bytes.empty()) bytes.append(1, '\0');
  const std::size_t view = document.add_view(bytes.size(), 0);
  buffer += bytes;
  buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
  return view;
}

}  // namespace

FeatureTable::FeatureTable(const TileMesh& tile, std::span<const std::string> names)
    : features_(tile.features), rows_(wedge_features(tile.mesh)), names_(names) {
  assert(features_.size() <= std::numeric_limits<std::uint16_t>::max());  // as nodes have fewer vertices
}

Json FeatureTable::described(std::span<const WedgeId> vertices) const {
  std::vector<bool> is_used(features_.size());
  for (const WedgeId vertex : vertices) is_used[rows_[vertex]] = true;
  const auto count = std::ranges::count(is_used, true);
  return {{"featureIds", Json::array({{{"featureCount", count}, {"attribute", 0}, {"propertyTable", 0}}})}};
}

void FeatureTable::add_to(GlbDocument& document, std::string& buffer) const {
  std::string ids, names, ends;
  append(ends, 0);
  for (const FeatureId feature : features_) {
    append(ids, feature);
    names += names_[feature];
    append(ends, static_cast<std::uint32_t>(names.size()));
  }
  Json properties;
  properties["id"] = {{"values", add_column(document, buffer, std::move(ids))}};
  const std::size_t values = add_column(document, buffer, std::move(names));
  properties["name"] = {{"values", values},
                        {"stringOffsets", add_column(document, buffer, std::move(ends))},
                        {"stringOffsetType", "UINT32"}};
  const Json columns = {{"id", {{"type", "SCALAR"}, {"componentType", "UINT32"}, {"required", true}}},
                        {"name", {{"type", "STRING"}, {"required", true}, {"semantic", "NAME"}}}};
  document.json()["extensions"]["EXT_structural_metadata"] = {
      {"schema", {{"id", "occlod"}, {"classes", {{"feature", {{"properties", columns}}}}}}},
      {"propertyTables",
       Json::array({{{"class", "feature"}, {"count", features_.size()}, {"properties", std::move(properties)}}})}};
  document.use_extension("EXT_mesh_features", false);
  document.use_extension("EXT_structural_metadata", false);
}

}  // namespace occlod::tiles
