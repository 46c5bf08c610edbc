#include "occlod/io/read_mesh.h"

#include <string>
#include <string_view>
#include <utility>

#include "mesh/file_format.h"
#include "base/file_input.h"
#include "mesh/polygon_soup.h"
#include "base/text_encoding.h"

namespace occlod {
namespace {

// The bytes of the file are freed on return.
PolygonSoup parse_file(const std::filesystem::path& path, const FileErrors& errors,
                       const std::function<void(double)>& progress) {
  const MeshFormat format = format_of(path, errors);
  InputBytes input(path, errors, progress);
  return parse_mesh(format, input, errors);
}

}  // namespace

PolygonSoup parse_mesh(MeshFormat format, InputBytes& input, const FileErrors& errors) {
  if (format == MeshFormat::ply) return parse_ply<InMemory>(input, errors);
  if (format == MeshFormat::obj) return parse_obj<InMemory>(input, errors);
  const std::string_view bytes = input.window(input.size());
  if (format == MeshFormat::stl) return parse_stl(bytes, errors);  // binary or text
  std::string converted;
  const std::string_view text = as_utf8(bytes, converted, errors);
  switch (format) {
    case MeshFormat::off:
      return parse_off(text, errors);
    case MeshFormat::gltf:
      return parse_gltf(text, errors);
    case MeshFormat::ply:  // above
    case MeshFormat::obj:
    case MeshFormat::stl:
      break;
  }
  return {};
}

CleanMesh read_mesh(const std::filesystem::path& path, const std::function<void(double)>& progress) {
  const FileErrors errors(path);
  PolygonSoup soup = parse_file(path, errors, progress);
  MeshReport report;
  TriangleMesh mesh = take_mesh(soup, report, errors);
  if (progress) progress(1.0);
  return clean(std::move(mesh), report, errors.subject());
}

}  // namespace occlod
