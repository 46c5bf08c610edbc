// Meshes: read, cleaned, generated, written.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <filesystem>
#include <optional>

#include "arrays.h"
#include "bindings.h"
#include "occlod/io/read_mesh.h"
#include "occlod/io/write_mesh.h"
#include "occlod/mesh/clean.h"
#include "occlod/mesh/count_topology.h"
#include "occlod/mesh/generate.h"

namespace occlod::python {
namespace {

using namespace nb::literals;

void require_size(const char* name, std::size_t count, std::size_t vertices) {
  if (count != 0 && count != vertices)
    throw Error({"mesh", name, "are " + std::to_string(count) + ", of " + std::to_string(vertices) + " vertices",
                 "give one for each vertex"});
}

TriangleMesh make_mesh(const ArrayLike& positions, const ArrayLike& triangles, const std::optional<ArrayLike>& normals,
                       const std::optional<ArrayLike>& colors) {
  TriangleMesh mesh;
  mesh.positions = to_vectors(positions, "positions");
  mesh.triangles = to_triangles(triangles, "triangles");
  if (normals) mesh.normals = to_vectors(*normals, "normals");
  if (colors) mesh.colors = to_colors(*colors, "colors");
  require_valid(mesh);
  return mesh;
}

TriangleMesh make_empty(std::size_t vertices, std::size_t triangles, bool normals, bool colors) {
  TriangleMesh mesh;
  mesh.positions.resize(vertices, glm::vec3(0.0F));
  mesh.triangles.resize(triangles, Triangle(0));
  if (normals) mesh.normals.resize(vertices, glm::vec3(0.0F));
  if (colors) mesh.colors.resize(vertices, glm::u8vec4(255));
  return mesh;
}

template <typename T, nb::ssize_t columns, typename Element>
auto writable(std::vector<Element> TriangleMesh::*member) {
  return [member](nb::handle self) {
    std::vector<Element>& values = nb::cast<TriangleMesh&>(self).*member;
    return rows_view<T, columns>(reinterpret_cast<T*>(values.data()), values.size(), self);
  };
}
// None where there are none.
template <typename T, nb::ssize_t columns, typename Element>
auto writable_or_none(std::vector<Element> TriangleMesh::*member) {
  return [member](nb::handle self) -> std::optional<Array2<T, columns>> {
    if ((nb::cast<TriangleMesh&>(self).*member).empty()) return std::nullopt;
    return writable<T, columns>(member)(self);
  };
}

void bind_report(nb::module_& m) {
  nb::class_<LeftOut>(m, "LeftOut", "What a file holds and a Mesh does not: counts.")
      .def_ro("texture_coordinates", &LeftOut::texture_coordinates)
      .def_ro("normals", &LeftOut::normals, "Of faces; those of vertices are kept.")
      .def_ro("colors", &LeftOut::colors, "Of faces; those of vertices are kept.")
      .def_ro("materials", &LeftOut::materials)
      .def_ro("groups", &LeftOut::groups);
  nb::class_<MeshReport>(m, "MeshReport",
                         "Counts over one mesh: of the file as it was read, of what cleaning changed, and of the\n"
                         "topology of the welded mesh.")
      .def_ro("vertices_read", &MeshReport::vertices_read)
      .def_ro("polygons_read", &MeshReport::polygons_read, "Faces of any size in the file.")
      .def_ro("polygons_triangulated", &MeshReport::polygons_triangulated, "Faces with more than three corners.")
      .def_ro("triangles_read", &MeshReport::triangles_read, "After triangulation.")
      .def_ro("vertices_welded", &MeshReport::vertices_welded, "Merged into another at exactly the same position.")
      .def_ro("seam_vertices", &MeshReport::seam_vertices,
              "Vertices with more than one set of normal, colour, texture coordinate and material.")
      .def_ro("unreferenced_vertices", &MeshReport::unreferenced_vertices, "Used by no triangle; dropped.")
      .def_ro("nonfinite_vertices", &MeshReport::nonfinite_vertices, "NaN or infinite and unreferenced; dropped.")
      .def_ro("repeated_index_triangles", &MeshReport::repeated_index_triangles,
              "Two corners at one position after welding; dropped.")
      .def_ro("zero_area_triangles", &MeshReport::zero_area_triangles, "Three different corners on one line; kept.")
      .def_ro("repeated_triangles", &MeshReport::repeated_triangles, "The same corners as an earlier triangle; kept.")
      .def_ro("boundary_edges", &MeshReport::boundary_edges, "Used by one triangle.")
      .def_ro("nonmanifold_edges", &MeshReport::nonmanifold_edges, "Used by three or more triangles.")
      .def_ro("inconsistent_edges", &MeshReport::inconsistent_edges,
              "Two triangles run through it in the same direction.")
      .def_ro("nonmanifold_vertices", &MeshReport::nonmanifold_vertices,
              "Vertices whose triangles form more than one fan.")
      .def_ro("components", &MeshReport::components, "Connected through shared vertices.")
      .def_ro("left_out", &MeshReport::left_out, "In the file and not in the mesh.");
}

void bind_generators(nb::module_& m) {
  m.def(
      "generate_rough_planet",
      [](int level, std::uint64_t seed, double amplitude, double frequency, int octaves) {
        return generate_rough_planet({level, seed, amplitude, frequency, octaves});
      },
      nb::kw_only(), "level"_a = 8, "seed"_a = 1, "amplitude"_a = 0.08, "frequency"_a = 4.0, "octaves"_a = 6,
      "The rough planet of Birkholz & Rahn: 8 * 4**level triangles around the origin, radius 1.");
  m.def(
      "generate_city",
      [](int blocks, int facade_cells, std::uint64_t seed) {
        return generate_city({blocks, facade_cells, seed});
      },
      nb::kw_only(), "blocks"_a = 16, "facade_cells"_a = 8, "seed"_a = 1,
      "Blocks of buildings on a ground plane, z up.");
  m.def(
      "generate_pipes",
      [](int pipes, int bends, int sides, std::uint64_t seed) {
        return generate_pipes({pipes, bends, sides, seed});
      },
      nb::kw_only(), "pipes"_a = 64, "bends"_a = 12, "sides"_a = 16, "seed"_a = 1,
      "A bundle of bent pipes in a unit cube.");
  m.def(
      "generate_plant",
      [](int storeys, int bays, int pipes, int bends, int sides, std::uint64_t seed) {
        return generate_plant({storeys, bays, pipes, bends, sides, seed});
      },
      nb::kw_only(), "storeys"_a = 4, "bays"_a = 8, "pipes"_a = 64, "bends"_a = 48, "sides"_a = 32, "seed"_a = 1,
      "Storeys of rooms full of pipes, with floors, walls and doors, z up.");
  m.def(
      "generate_spheres_behind_wall",
      [](int spheres, int level, int wall_cells, std::uint64_t seed) {
        return generate_spheres_behind_wall({spheres, level, wall_cells, seed});
      },
      nb::kw_only(), "spheres"_a = 64, "level"_a = 4, "wall_cells"_a = 32, "seed"_a = 1,
      "A wall in the plane x = 0 and a cloud of spheres at x < 0.");
}

}  // namespace

void require_valid(const TriangleMesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  require_size("normals", mesh.normals.size(), vertices);
  require_size("colors", mesh.colors.size(), vertices);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    const std::uint32_t largest = std::max({t.x, t.y, t.z});
    if (largest >= mesh.vertex_count())
      throw Error({"mesh", "triangle " + std::to_string(i),
                   "uses vertex " + std::to_string(largest) + " of " + std::to_string(mesh.vertex_count()),
                   "vertices are counted from 0"});
  }
}

void bind_mesh(nb::module_& m) {
  bind_report(m);
  nb::class_<TriangleMesh>(
      m, "Mesh",
      "An indexed triangle mesh. Its arrays are writable views of its own memory, which keep it alive; their\n"
      "lengths are fixed.")
      .def(
          "__init__",
          [](TriangleMesh* self, const ArrayLike& positions, const ArrayLike& triangles,
             const std::optional<ArrayLike>& normals, const std::optional<ArrayLike>& colors) {
            new (self) TriangleMesh(make_mesh(positions, triangles, normals, colors));
          },
          "positions"_a, "triangles"_a, "normals"_a = nb::none(), "colors"_a = nb::none(),
          "Copies the arrays: positions (n, 3) and normals (n, 3) to float32, triangles (m, 3) to uint32,\n"
          "colors (n, 4) of uint8, sRGB and alpha. TypeError for other shapes, Error for an index out of range.")
      .def_static("empty", &make_empty, "vertices"_a, "triangles"_a, nb::kw_only(), "normals"_a = false,
                  "colors"_a = false, "A mesh of zeros, to be filled through its arrays without a copy of them.")
      .def_prop_ro("positions", writable<float, 3>(&TriangleMesh::positions),
                   "(n, 3) float32, object space. A writable view.")
      .def_prop_ro("triangles", writable<std::uint32_t, 3>(&TriangleMesh::triangles),
                   "(m, 3) uint32, ids of vertices, counter-clockwise seen from outside. A writable view.")
      .def_prop_ro("normals", writable_or_none<float, 3>(&TriangleMesh::normals),
                   "(n, 3) float32 of unit length, or None. A writable view.")
      .def_prop_ro("colors", writable_or_none<std::uint8_t, 4>(&TriangleMesh::colors),
                   "(n, 4) uint8, sRGB and alpha, or None. A writable view.")
      .def_prop_ro("vertex_count", &TriangleMesh::vertex_count)
      .def_prop_ro("triangle_count", &TriangleMesh::triangle_count)
      .def(
          "clean",
          [](const TriangleMesh& mesh) {
            const nb::gil_scoped_release release;
            CleanMesh result = clean(mesh, MeshReport{}, "mesh");
            return std::pair<TriangleMesh, MeshReport>(std::move(result.mesh), result.report);
          },
          "A new mesh, welded by exactly equal positions and without degenerate indices, and what was found.\n"
          "Error for a vertex that is used and not finite, and when no triangle is left.")
      .def(
          "report",
          [](const TriangleMesh& mesh) {
            const nb::gil_scoped_release release;
            require_valid(mesh);
            MeshReport report;
            report.vertices_read = mesh.vertex_count();
            report.polygons_read = report.triangles_read = mesh.triangle_count();
            count_topology(mesh, report);
            return report;
          },
          "Counts the topology of the mesh as it is. O(n).")
      .def(
          "write",
          [](const TriangleMesh& mesh, const std::filesystem::path& path) {
            const nb::gil_scoped_release release;
            require_valid(mesh);
            write_mesh(path, mesh);
          },
          "path"_a, "As PLY, OBJ, GLB, OFF or STL, by the extension. An old file stays as it was when writing fails.")
      .def("__repr__", [](const TriangleMesh& mesh) {
        return "<occlod.Mesh of " + std::to_string(mesh.vertex_count()) + " vertices and " +
               std::to_string(mesh.triangle_count()) + " triangles>";
      });

  m.def(
      "read_mesh_and_report",
      [](const std::filesystem::path& path, const std::optional<nb::callable>& progress) {
        const auto step = progress_of(progress ? nb::handle(*progress) : nb::handle(Py_None));
        const nb::gil_scoped_release release;
        CleanMesh result = read_mesh(path, [&](double done) { step(done); });
        return std::pair<TriangleMesh, MeshReport>(std::move(result.mesh), result.report);
      },
      "path"_a, "progress"_a = nb::none(),
      "Reads PLY, OBJ, OFF, STL or glTF and cleans it: the mesh and what was found. `progress` is called with the\n"
      "share of the file that has been read. Error names the file, the place and the remedy.");
  bind_generators(m);
}

}  // namespace occlod::python
