// One mesh format: whatever the bytes, the parser makes a mesh that builds, or throws an Error with a message. A file
// that can be streamed makes as many triangles that way, or is refused for the same reason.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>

#include "mesh/polygon_soup.h"
#include "mesh/stream_mesh.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/mesh.h"

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

// What became of a file: its triangles, or why it was refused.
struct Outcome {
  std::size_t triangles = 0;
  std::string problem;
  friend bool operator==(const Outcome&, const Outcome&) = default;
};

Outcome refused(const Error& error) {
  expect(std::string_view(error.what()).find('\n') == std::string_view::npos);
  return {0, error.diagnosis().place + ": " + error.diagnosis().problem};
}

void build(const TriangleMesh& mesh) try {
  constexpr std::size_t max_to_build = 500;  // triangles; larger meshes are no harder and take longer
  if (mesh.triangle_count() > max_to_build) return;
  BuildOptions options;
  options.base_triangles = 0;
  options.threads = 1;
  const Hierarchy hierarchy = build_hierarchy(mesh, options);
  expect(validate(hierarchy, 2).empty());
  expect(restores(hierarchy, mesh));
} catch (const Error& error) {
  static_cast<void>(refused(error));
}

Outcome read_and_build(std::string_view bytes) try {
  const FileErrors errors("fuzz");
  InputBytes input(bytes);
  PolygonSoup soup = parse_mesh(MeshFormat::OCCLOD_FUZZ_FORMAT, input, errors);
  MeshReport report;
  TriangleMesh mesh = take_mesh(soup, report, errors);
  const CleanMesh cleaned = clean(std::move(mesh), report, errors.subject());
  const std::size_t triangles = cleaned.mesh.triangle_count();
  expect(triangles + cleaned.report.repeated_index_triangles == cleaned.report.triangles_read);
  build(cleaned.mesh);
  return {triangles, ""};
} catch (const Error& error) {
  return refused(error);
}

// A file whose name ends as the format wants it; gone when the program ends.
class NamedFile {
 public:
  explicit NamedFile(std::string_view extension)
      : path_(std::filesystem::temp_directory_path() /
              ("occlod_fuzz_" + std::to_string(getpid()) + "." + std::string(extension))) {}
  ~NamedFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  NamedFile(const NamedFile&) = delete;
  NamedFile& operator=(const NamedFile&) = delete;

  const std::filesystem::path& with(std::string_view bytes) const {
    std::ofstream(path_, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path_;
  }

 private:
  std::filesystem::path path_;
};

Outcome stream(const std::filesystem::path& path) try {
  constexpr std::size_t most = 7;  // triangles of a piece
  const StreamedMesh mesh(path, {});
  std::size_t triangles = 0;
  mesh.visit(most, [&](const TriangleMesh& piece) {
    expect(piece.triangle_count() > 0 && piece.triangle_count() <= most);
    triangles += piece.triangle_count();
    for (const Triangle& t : piece.triangles)
      for (int k = 0; k < 3; ++k) expect(t[k] < piece.positions.size());
    for (const MaterialId m : piece.triangle_materials) expect(m < piece.materials.size());
  });
  return {triangles, ""};
} catch (const Error& error) {
  return refused(error);
}

void read(std::string_view bytes) {
  if (names_a_file(bytes) || bytes.empty()) return;
  const Outcome outcome = read_and_build(bytes);
  constexpr bool is_streamed =
      MeshFormat::OCCLOD_FUZZ_FORMAT == MeshFormat::ply || MeshFormat::OCCLOD_FUZZ_FORMAT == MeshFormat::obj;
  if constexpr (is_streamed) {
    static const NamedFile file(MeshFormat::OCCLOD_FUZZ_FORMAT == MeshFormat::ply ? "ply" : "obj");
    expect(stream(file.with(bytes)) == outcome);
  }
}

}  // namespace
}  // namespace occlod

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  occlod::read({reinterpret_cast<const char*>(data), size});
  return 0;
}
