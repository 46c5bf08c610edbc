// One mesh format: whatever the bytes, the parser makes a mesh that builds, or throws an Error with a message.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "io/polygon_soup.h"
#include "occlod/core/error.h"
#include "occlod/hierarchy/build.h"
#include "occlod/hierarchy/validate.h"
#include "occlod/mesh/clean.h"

namespace occlod {
namespace {

void expect(bool holds) {
  if (!holds) std::abort();
}

// Only what is in the bytes themselves.
bool names_a_file(std::string_view bytes) {
  if (bytes.find("mtllib") != std::string_view::npos) return true;
  for (std::size_t at = bytes.find("uri"); at != std::string_view::npos; at = bytes.find("uri", at + 1))
    if (bytes.substr(at, 16).find("data:") == std::string_view::npos) return true;
  return false;
}

void read_and_build(std::string_view bytes) {
  if (names_a_file(bytes)) return;
  constexpr std::size_t most_to_build = 500;  // triangles; larger meshes are no harder and take longer
  const FileErrors errors("fuzz");
  InputBytes input(bytes);
  PolygonSoup soup = parse_mesh(MeshFormat::OCCLOD_FUZZ_FORMAT, input, errors);
  MeshReport report;
  TriangleMesh mesh = take_mesh(soup, report, errors);
  const CleanMesh cleaned = clean(std::move(mesh), report, errors.subject());
  expect(cleaned.mesh.triangle_count() + cleaned.report.repeated_index_triangles == cleaned.report.triangles_read);
  if (cleaned.mesh.triangle_count() > most_to_build) return;
  BuildOptions options;
  options.base_triangles = 0;
  options.threads = 1;
  const Hierarchy hierarchy = build_hierarchy(cleaned.mesh, options);
  expect(validate(hierarchy, {2}).empty());
  expect(restores(hierarchy, cleaned.mesh));
}

}  // namespace
}  // namespace occlod

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    occlod::read_and_build({reinterpret_cast<const char*>(data), size});
  } catch (const occlod::Error& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();  // one line
  }
  return 0;
}
