#include "json_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <glm/gtc/type_ptr.hpp>
#include <string>
#include <vector>

#include "standard_streams.h"

namespace occlod::tool {

Json to_json(const glm::dvec3& vector) { return {vector.x, vector.y, vector.z}; }

Json to_json(const glm::dmat4& matrix) {
  const double* numbers = glm::value_ptr(matrix);
  return std::vector<double>(numbers, numbers + 16);
}

Json to_json(const Camera& camera) {
  Json json = {{"eye", to_json(camera.eye)}, {"target", to_json(camera.target)}, {"up", to_json(camera.up)}};
  if (camera.orthographic_height)
    json["orthographic_height"] = *camera.orthographic_height;
  else
    json["fov_y_deg"] = camera.fov_y_deg;
  if (camera.principal_point != glm::dvec2(0.0))
    json["principal_point"] = {camera.principal_point.x, camera.principal_point.y};
  json.update({{"width", camera.width}, {"height", camera.height}, {"near", camera.near}, {"far", camera.far}});
  return json;
}

Json to_json(const MeshReport& report) {
  Json json = {{"vertices_read", report.vertices_read},
               {"polygons_read", report.polygons_read},
               {"polygons_triangulated", report.polygons_triangulated},
               {"triangles_read", report.triangles_read},
               {"vertices_welded", report.vertices_welded},
               {"seam_vertices", report.seam_vertices},
               {"unreferenced_vertices", report.unreferenced_vertices},
               {"nonfinite_vertices", report.nonfinite_vertices},
               {"repeated_index_triangles", report.repeated_index_triangles}};
  json.update(topology_to_json(report));
  json["left_out"] = to_json(report.left_out);
  return json;
}

Json to_json(const LeftOut& counts) {
  Json json = Json::object();
  for (const LeftOut::Entry& entry : counts.entries()) json[entry.name] = entry.count;
  return json;
}

Json topology_to_json(const MeshReport& report) {
  return {{"zero_area_triangles", report.zero_area_triangles},
          {"repeated_triangles", report.repeated_triangles},
          {"boundary_edges", report.boundary_edges},
          {"nonmanifold_edges", report.nonmanifold_edges},
          {"inconsistent_edges", report.inconsistent_edges},
          {"nonmanifold_vertices", report.nonmanifold_vertices},
          {"components", report.components}};
}

Json to_json(const Box& box, const glm::dvec3& origin) {
  return {{"min", to_json(origin + glm::dvec3(box.min))}, {"max", to_json(origin + glm::dvec3(box.max))}};
}

void add_origin(Json& object, const glm::dvec3& origin) {
  if (origin != glm::dvec3(0.0)) object["origin"] = to_json(origin);
}

void note_lost_origin(const std::filesystem::path& path, const glm::dvec3& origin) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension != ".stl" || origin == glm::dvec3(0.0)) return;
  print_note(fmt::format("{}: STL has floats only, so its coordinates are relative to the origin {} {} {}",
                         path.string(), origin.x, origin.y, origin.z));
}

Json counts_of(const Hierarchy& hierarchy) {
  const std::size_t vertices = hierarchy.vertex_count();
  Json counts = {{"vertices", vertices},
                 {"triangles", hierarchy.input_triangle_count()},
                 {"base_triangles", hierarchy.base_triangle_count()},
                 {"splits", hierarchy.split_count()},
                 {"faces", hierarchy.face_count()},
                 {"bytes", hierarchy.bytes()},
                 {"bytes_per_vertex",
                  static_cast<double>(hierarchy.bytes()) / static_cast<double>(std::max<std::size_t>(vertices, 1))},
                 {"error_bound", hierarchy.error_bound()}};
  add_origin(counts, hierarchy.data().origin);
  return counts;
}

// Replaces bytes that are not UTF-8, which names of files may have and JSON may not.
void print_json(const Json& object) { fmt::print("{}\n", object.dump(2, ' ', false, Json::error_handler_t::replace)); }

void print_lines(const Json& object) {
  std::size_t width = 0;
  for (const auto& [key, value] : object.items()) width = std::max(width, key.size());
  for (const auto& [key, value] : object.items()) {
    if (key == "origin")
      fmt::print("{:<{}}  {} {} {}  (coordinates are kept relative to it)\n", key, width, value[0].get<double>(),
                 value[1].get<double>(), value[2].get<double>());
    if (value.is_structured()) continue;
    const std::string text = value.is_string()         ? printable(value.get<std::string>())
                             : value.is_number_float() ? fmt::format("{:.6g}", value.get<double>())
                                                       : value.dump();
    fmt::print("{:<{}}  {}\n", key, width, text);
  }
}

void print_lines(const MeshReport& report) {
  Json lines = to_json(report);
  lines["left_out"] = in_words(report.left_out);
  print_lines(lines);
}

std::string in_words(const LeftOut& counts) {
  std::string words;
  for (const LeftOut::Entry& entry : counts.entries())
    words += fmt::format("{}{} {}", words.empty() ? "" : ", ", entry.count, entry.name);
  return words.empty() ? "nothing" : words;
}

void print_result(Json result, const LeftOut& left_out, bool json) {
  if (json)
    result["left_out"] = to_json(left_out);
  else
    result["left_out"] = in_words(left_out);
  json ? print_json(result) : print_lines(result);
}

}  // namespace occlod::tool
