// The features of an HLOD: which part of the input each triangle belongs to, beside the meshes of nodes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mesh/section_file.h"
#include "occlod/hlod.h"

namespace occlod::hlod {

// Has the fields of HlodFeatures.
struct FeatureData {
  std::vector<std::string> names;
  std::vector<FeatureRun> runs;
  std::vector<std::uint32_t> first_run;
};

[[nodiscard]] inline HlodFeatures view_of(const FeatureData& data) { return {data.names, data.runs, data.first_run}; }
[[nodiscard]] inline FeatureData copy_of(const HlodFeatures& features) {
  return {{features.names.begin(), features.names.end()},
          {features.runs.begin(), features.runs.end()},
          {features.first_run.begin(), features.first_run.end()}};
}

// Returns what is wrong with the features of an HLOD whose nodes have been checked, or nothing. O(nodes + runs).
[[nodiscard]] std::optional<std::string> check_features(const HlodView& data);

// The sections of a file with features. Must stay valid while a SectionWriter uses it.
class FeatureSections {
 public:
  // Adds nothing where there are no features.
  void add(const HlodFeatures& features, sections::SectionWriter& writer);

 private:
  std::string names_;                // one after the other
  std::vector<std::uint64_t> ends_;  // of names
};

// Returns the features; `names` keeps those that the result refers to. Refuses names that do not fit together; the rest
// is for check_features().
[[nodiscard]] HlodFeatures read_features(sections::SectionReader& reader, std::vector<std::string>& names);

}  // namespace occlod::hlod
