#include "hlod/store/features.h"

#include <fmt/format.h>

#include <span>
#include <string_view>

namespace occlod::hlod {
namespace {

constexpr std::string_view runs_name = "FRUN", first_runs_name = "FNOD", names_name = "FNAM", ends_name = "FEND";

// Checks the runs of a node with this many triangles.
bool are_runs(std::span<const FeatureRun> runs, std::uint32_t triangles, std::size_t features) {
  if (runs.empty() || triangles == 0) return runs.empty() && triangles == 0;
  if (runs[0].first_triangle != 0 || runs.back().first_triangle >= triangles) return false;
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (runs[i].feature >= features || (i > 0 && runs[i].first_triangle <= runs[i - 1].first_triangle)) return false;
  return true;
}

}  // namespace

std::optional<std::string> check_features(const HlodView& data) {
  const HlodFeatures& features = data.features;
  if (features.names.empty()) {
    if (features.runs.empty() && features.first_run.empty()) return std::nullopt;
    return "there are triangles of features without names";
  }
  if (features.first_run.size() != data.nodes.size() + 1 || features.first_run.front() != 0 ||
      features.first_run.back() != features.runs.size())
    return "the features are not divided between its nodes";
  for (NodeId n = 0; n < data.nodes.size(); ++n) {
    const std::uint32_t first = features.first_run[n], end = features.first_run[n + 1];
    if (end < first || end > features.runs.size() ||
        !are_runs(features.runs.subspan(first, end - first), data.nodes[n].triangles, features.names.size()))
      return fmt::format("node {} has no valid features", n);
  }
  return std::nullopt;
}

void FeatureSections::add(const HlodFeatures& features, sections::SectionWriter& writer) {
  if (features.names.empty()) return;
  for (const std::string& name : features.names) {
    names_ += name;
    ends_.push_back(names_.size());
  }
  writer.add(runs_name, features.runs);
  writer.add(first_runs_name, features.first_run);
  writer.add(names_name, std::span<const char>(names_));
  writer.add(ends_name, std::span<const std::uint64_t>(ends_));
}

HlodFeatures read_features(sections::SectionReader& reader, std::vector<std::string>& names) {
  if (!reader.has(ends_name)) return {};
  const auto text = reader.read<char>(names_name);
  std::uint64_t begin = 0;
  for (const std::uint64_t end : reader.read<std::uint64_t>(ends_name)) {
    if (end < begin || end > text.size()) reader.refuse(fmt::format("section {}", ends_name), "does not divide names");
    names.emplace_back(text.data() + begin, text.data() + end);
    begin = end;
  }
  return {names, reader.read<FeatureRun>(runs_name), reader.read<std::uint32_t>(first_runs_name)};
}

}  // namespace occlod::hlod
