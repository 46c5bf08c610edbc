#include <fmt/format.h>

#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "hlod/node_guard.h"
#include "occlod/core/error.h"
#include "occlod/hlod/validate.h"
#include "occlod/io/ohlod.h"
#include "ohlod_format.h"

namespace occlod {
namespace {

using namespace ohlod;
using namespace sections;

class FileGuard final : public hlod::NodeGuard {
 public:
  FileGuard(std::shared_ptr<const SectionReader> reader, const hlod::HlodView& view,
            std::span<const std::uint64_t> digests)
      : NodeGuard(view.nodes.size()), reader_(std::move(reader)), view_(view), digests_(digests) {}

 private:
  void check_node(hlod::NodeId n) override {
    if (digest_of_mesh(view_, n) != digests_[n])
      reader_->refuse(fmt::format("node {}", n), "is damaged: its checksum is wrong");
    if (const auto problem = check_mesh(view_, n))
      reader_->refuse(fmt::format("node {}", n), "has no valid mesh: " + *problem);
  }

  std::shared_ptr<const SectionReader> reader_;
  hlod::HlodView view_;
  std::span<const std::uint64_t> digests_;
};

void take(const Summary& summary, const SectionReader& reader, hlod::HlodView& view) {
  if (summary.has_normals > 1 || summary.has_colors > 1) reader.refuse("", "does not say whether it has attributes");
  view.box = summary.box;
  view.input_triangle_count = summary.input_triangle_count;
  view.grouping = static_cast<hlod::Grouping>(summary.grouping);
  view.borders = static_cast<hlod::Borders>(summary.borders);
  view.node_triangles = summary.node_triangles;
  view.has_normals = summary.has_normals != 0;
  view.has_colors = summary.has_colors != 0;
}

}  // namespace

OhlodFile read_ohlod(const std::filesystem::path& path, OlodAccess access) {
  const auto reader = std::make_shared<SectionReader>(path, file_kind, access == OlodAccess::mapped);
  hlod::HlodView view;
  for_each_array(view, [&](std::string_view name, auto& array, bool has_parts) {
    using T = typename std::decay_t<decltype(array)>::value_type;
    array = reader->template read<T>(name, has_parts ? Check::parts : Check::whole);
  });
  take(reader->read_one<Summary>(summary_name, "summary"), *reader, view);
  const MeshReport report = reader->read_report();
  const auto digests = reader->read<std::uint64_t>(digests_name);
  if (const auto problem = check_structure(view)) reader->refuse("", "does not hold a valid HLOD: " + *problem);
  if (digests.size() != view.nodes.size()) reader->refuse("section BLOK", "does not have a checksum for every node");
  return {guarded_hlod(view, reader, std::make_shared<FileGuard>(reader, view, digests)), report};
}

}  // namespace occlod
