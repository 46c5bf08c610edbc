#include "mesh/mesh_report.h"

namespace occlod {

void add_counts_of_reading(MeshReport& report, const MeshReport& of_object) {
  report.vertices_read += of_object.vertices_read;
  report.polygons_read += of_object.polygons_read;
  report.polygons_triangulated += of_object.polygons_triangulated;
  report.triangles_read += of_object.triangles_read;
  report.unreferenced_vertices += of_object.unreferenced_vertices;
  report.nonfinite_vertices += of_object.nonfinite_vertices;
  report.left_out.add(of_object.left_out);
}

void settle_counts(MeshReport& report, std::uint64_t vertices, std::uint64_t triangles) {
  report.repeated_index_triangles = report.triangles_read - triangles;
  report.vertices_welded = report.vertices_read - report.nonfinite_vertices - report.unreferenced_vertices - vertices;
}

MeshReport report_of(const MeshReport& read, const CleanMesh& made) {
  MeshReport report = made.report;
  report.vertices_read = report.polygons_read = report.polygons_triangulated = report.triangles_read = 0;
  report.unreferenced_vertices = report.nonfinite_vertices = 0;
  report.left_out = {};
  add_counts_of_reading(report, read);
  settle_counts(report, made.mesh.vertex_count(), made.mesh.triangle_count());
  return report;
}

void leave_out_features(CleanMesh& read) {
  read.report.left_out.add("features (groups, objects, nodes)", read.mesh.feature_names.size());
  read.mesh.triangle_features = {};
  read.mesh.feature_names = {};
}

}  // namespace occlod
