// Meshes: read, cleaned, generated, written.
#include "occlod/mesh.h"

#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "materials.h"
#include "occlod/generate.h"
#include "occlod/mesh_file.h"
#include "text.h"

namespace occlod::python {
namespace {

using namespace nb::literals;

void require_size(const char* name, std::size_t count, std::size_t wanted, const char* things) {
  if (count != 0 && count != wanted)
    throw Error({"mesh", name, "are " + std::to_string(count) + ", of " + std::to_string(wanted) + " " + things,
                 "give one for each"});
}

// What is not there stays empty.
struct MeshArrays {
  std::optional<ArrayLike> normals;
  std::optional<ArrayLike> colors;
  std::optional<ArrayLike> texture_coordinates;
  std::optional<ArrayLike> extra_wedges;
  std::optional<ArrayLike> corners;
  std::optional<ArrayLike> triangle_materials;
  std::optional<ArrayLike> triangle_features;
};

TriangleMesh make_mesh(const ArrayLike& positions, const ArrayLike& triangles, const MeshArrays& arrays) {
  TriangleMesh mesh;
  mesh.triangles = to_triangles(triangles, "triangles");
  set_coordinates(mesh, positions, "positions");
  if (arrays.normals) mesh.normals = to_vectors(*arrays.normals, "normals");
  if (arrays.colors) mesh.colors = to_colors(*arrays.colors, "colors");
  if (arrays.texture_coordinates)
    mesh.texture_coordinates = to_coordinates(*arrays.texture_coordinates, "texture_coordinates");
  if (arrays.extra_wedges) mesh.extra_wedges = to_ids(*arrays.extra_wedges, "extra_wedges");
  if (arrays.corners) mesh.corners = to_triangles(*arrays.corners, "corners");
  if (arrays.triangle_materials)
    mesh.triangle_materials = to_material_ids(*arrays.triangle_materials, "triangle_materials");
  if (arrays.triangle_features) mesh.triangle_features = to_ids(*arrays.triangle_features, "triangle_features");
  return mesh;
}

TriangleMesh make_empty(std::size_t vertices, std::size_t triangles, bool normals, bool colors,
                        bool texture_coordinates) {
  TriangleMesh mesh;
  mesh.positions.resize(vertices, glm::vec3(0.0F));
  mesh.triangles.resize(triangles, Triangle(0));
  if (normals) mesh.normals.resize(vertices, glm::vec3(0.0F));
  if (colors) mesh.colors.resize(vertices, glm::u8vec4(255));
  if (texture_coordinates) mesh.texture_coordinates.resize(vertices, glm::vec2(0.0F));
  return mesh;
}

template <typename T, nb::ssize_t columns>
using ArrayOf = std::conditional_t<columns == 1, Array1<T>, Array2<T, columns>>;

template <typename T, nb::ssize_t columns, typename Element>
auto writable(std::vector<Element> TriangleMesh::*member) {
  return [member](nb::handle self) -> ArrayOf<T, columns> {
    std::vector<Element>& values = nb::cast<TriangleMesh&>(self).*member;
    T* const data = reinterpret_cast<T*>(values.data());
    if constexpr (columns == 1)
      return values_view<T>(data, values.size(), self);
    else
      return rows_view<T, columns>(data, values.size(), self);
  };
}
// None where there are none.
template <typename T, nb::ssize_t columns, typename Element>
auto writable_or_none(std::vector<Element> TriangleMesh::*member) {
  return [member](nb::handle self) -> std::optional<ArrayOf<T, columns>> {
    if ((nb::cast<TriangleMesh&>(self).*member).empty()) return std::nullopt;
    return writable<T, columns>(member)(self);
  };
}

// Bytes that are not UTF-8, which a file may have in its names, are replaced.
nb::str to_text(const std::string& bytes) {
  return nb::steal<nb::str>(PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "replace"));
}

void bind_report(nb::module_& m) {
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
      .def_prop_ro(
          "left_out",
          [](const MeshReport& report) {
            nb::typed<nb::dict, nb::str, nb::int_> counts;
            for (const LeftOut::Entry& entry : report.left_out.entries()) counts[to_text(entry.name)] = entry.count;
            return counts;
          },
          "What the file holds and the mesh does not: counts by name, as in {'lines (l)': 12}.");
}

TriangleMesh generate_by_keywords(const std::string& generator, const nb::kwargs& given) {
  GeneratorValues values;
  for (const auto& [name, value] : given) {
    const auto parameter = nb::cast<std::string>(name);
    if (!nb::try_cast(value, values[parameter])) throw nb::type_error((parameter + " is not a number").c_str());
  }
  const ReleasedGil release;
  return generate(generator, values);
}

std::string describe_generators() {
  std::ostringstream text;
  text.precision(16);  // the largest seed is exact
  text << "The mesh of a generator; generators() has this table. Error says which values are allowed.\n";
  for (const Generator& generator : generators()) {
    text << "\n" << generator.name << ": " << generator.about << "\n";
    for (const GeneratorParameter& p : generator.parameters)
      text << "    " << p.name << "=" << p.default_value << ": " << p.about << ", " << p.min << " to " << p.max << "\n";
  }
  return text.str();
}

void bind_generators(nb::module_& m) {
  nb::class_<GeneratorParameter>(m, "GeneratorParameter", "A keyword that generate() takes for a generator.")
      .def_ro("name", &GeneratorParameter::name)
      .def_ro("min", &GeneratorParameter::min, "Allowed itself.")
      .def_ro("max", &GeneratorParameter::max, "Allowed itself.")
      .def_ro("default_value", &GeneratorParameter::default_value)
      .def_ro("whole", &GeneratorParameter::whole, "Only whole numbers are allowed.")
      .def_ro("about", &GeneratorParameter::about)
      .def("accepts", &GeneratorParameter::accepts, "value"_a);
  nb::class_<Generator>(m, "Generator", "Makes test meshes from a few numbers.")
      .def_ro("name", &Generator::name)
      .def_ro("about", &Generator::about)
      .def_prop_ro("parameters", [](const Generator& generator) {
        return std::vector<GeneratorParameter>(generator.parameters.begin(), generator.parameters.end());
      });
  m.def(
      "generators", [] { return std::vector<Generator>(generators().begin(), generators().end()); },
      "What generate() can make.");
  m.def("generate", generate_by_keywords, "generator"_a, "values"_a,
        nb::sig("def generate(generator: str, **values: float) -> Mesh"), describe_generators().c_str());
}

void require_valid_wedges(const TriangleMesh& mesh) {
  const auto fail = [](const std::string& place, const std::string& problem, const std::string& remedy) {
    throw Error({"mesh", place, problem, remedy});
  };
  if (mesh.corners.empty() && !mesh.extra_wedges.empty())
    fail("corners", "are missing, and there are extra wedges", "give a wedge for each corner of each triangle");
  for (std::size_t i = 0; i < mesh.extra_wedges.size(); ++i)
    if (mesh.extra_wedges[i] >= mesh.vertex_count() || (i > 0 && mesh.extra_wedges[i] < mesh.extra_wedges[i - 1]))
      fail("extra wedge " + std::to_string(i), "is of vertex " + std::to_string(mesh.extra_wedges[i]),
           "vertices ascend and are less than vertex_count");
  for (std::size_t t = 0; t < mesh.corners.size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (const WedgeId w = mesh.corners[t][k]; w >= mesh.wedge_count() || mesh.vertex_of(w) != mesh.triangles[t][k])
        fail("triangle " + std::to_string(t), "has wedge " + std::to_string(w) + " at another vertex",
             "corners has wedges of the vertices in triangles");
  const std::size_t materials = std::max<std::size_t>(mesh.materials.size(), 1);
  for (std::size_t t = 0; t < mesh.triangle_materials.size(); ++t)
    if (mesh.triangle_materials[t] >= materials)
      fail(
          "triangle " + std::to_string(t),
          "has material " + std::to_string(mesh.triangle_materials[t]) + " of " + std::to_string(mesh.materials.size()),
          "materials are counted from 0");
  for (std::size_t t = 0; t < mesh.triangle_features.size(); ++t)
    if (mesh.triangle_features[t] >= mesh.feature_names.size())
      fail("triangle " + std::to_string(t),
           "has feature " + std::to_string(mesh.triangle_features[t]) + " of " +
               std::to_string(mesh.feature_names.size()),
           "features are counted from 0, and each has a name");
  for (std::size_t m = 0; m < mesh.materials.size(); ++m)
    if (const TextureId texture = mesh.materials[m].texture_beyond(mesh.textures.size()); texture != no_texture)
      fail("material " + std::to_string(m),
           "has texture " + std::to_string(texture) + " of " + std::to_string(mesh.textures.size()),
           "textures are counted from 0");
}

// For pickling: the arrays as bytes, and what is none.
using MeshState = std::tuple<std::array<nb::bytes, 9>, std::vector<Material>, std::vector<Texture>, TextureOrigin,
                             glm::dvec3, UpAxis, std::vector<std::string>>;

template <typename Element>
nb::bytes bytes_of(const std::vector<Element>& values) {
  return nb::bytes(values.data(), values.size() * sizeof(Element));
}

template <typename Element>
void set_from(std::vector<Element>& values, const nb::bytes& bytes) {
  if (bytes.size() % sizeof(Element) != 0)
    throw nb::value_error("mesh: its pickled arrays are damaged; pickle it again");
  values.resize(bytes.size() / sizeof(Element));
  if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), bytes.data(), bytes.size());
}

MeshState state_of(const TriangleMesh& m) {
  return {{bytes_of(m.positions), bytes_of(m.normals), bytes_of(m.colors), bytes_of(m.texture_coordinates),
           bytes_of(m.extra_wedges), bytes_of(m.triangles), bytes_of(m.corners), bytes_of(m.triangle_materials),
           bytes_of(m.triangle_features)},
          m.materials,
          m.textures,
          m.texture_origin,
          m.origin,
          m.up,
          m.feature_names};
}

TriangleMesh mesh_of(const MeshState& state) {
  TriangleMesh m;
  const auto& arrays = std::get<0>(state);
  std::tie(std::ignore, m.materials, m.textures, m.texture_origin, m.origin, m.up, m.feature_names) = state;
  set_from(m.positions, arrays[0]);
  set_from(m.normals, arrays[1]);
  set_from(m.colors, arrays[2]);
  set_from(m.texture_coordinates, arrays[3]);
  set_from(m.extra_wedges, arrays[4]);
  set_from(m.triangles, arrays[5]);
  set_from(m.corners, arrays[6]);
  set_from(m.triangle_materials, arrays[7]);
  set_from(m.triangle_features, arrays[8]);
  return m;
}

}  // namespace

void require_valid(const TriangleMesh& mesh) {
  const std::size_t wedges = mesh.positions.size();
  if (mesh.extra_wedges.size() > wedges)
    throw Error({"mesh", "extra_wedges", "are more than positions", "positions has one for each of them too"});
  require_size("normals", mesh.normals.size(), wedges, "positions");
  require_size("colors", mesh.colors.size(), wedges, "positions");
  require_size("texture_coordinates", mesh.texture_coordinates.size(), wedges, "positions");
  require_size("corners", mesh.corners.size(), mesh.triangle_count(), "triangles");
  require_size("triangle_materials", mesh.triangle_materials.size(), mesh.triangle_count(), "triangles");
  require_size("triangle_features", mesh.triangle_features.size(), mesh.triangle_count(), "triangles");
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    const std::uint32_t largest = std::max({t.x, t.y, t.z});
    if (largest >= mesh.vertex_count())
      throw Error({"mesh", "triangle " + std::to_string(i),
                   "uses vertex " + std::to_string(largest) + " of " + std::to_string(mesh.vertex_count()),
                   "vertices are counted from 0"});
  }
  require_valid_wedges(mesh);
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
             const std::optional<ArrayLike>& normals, const std::optional<ArrayLike>& colors,
             const std::optional<ArrayLike>& texture_coordinates, const std::optional<ArrayLike>& extra_wedges,
             const std::optional<ArrayLike>& corners, const std::optional<ArrayLike>& triangle_materials,
             std::vector<Material> materials, std::vector<Texture> textures, TextureOrigin texture_origin,
             const std::optional<ArrayLike>& triangle_features, std::vector<std::string> feature_names) {
            TriangleMesh mesh = make_mesh(
                positions, triangles,
                {normals, colors, texture_coordinates, extra_wedges, corners, triangle_materials, triangle_features});
            mesh.materials = std::move(materials);
            mesh.textures = std::move(textures);
            mesh.texture_origin = texture_origin;
            mesh.feature_names = std::move(feature_names);
            require_valid(mesh);
            new (self) TriangleMesh(std::move(mesh));
          },
          "positions"_a, "triangles"_a, "normals"_a = nb::none(), "colors"_a = nb::none(),
          "texture_coordinates"_a = nb::none(), nb::kw_only(), "extra_wedges"_a = nb::none(), "corners"_a = nb::none(),
          "triangle_materials"_a = nb::none(), "materials"_a = nb::make_tuple(), "textures"_a = nb::make_tuple(),
          "texture_origin"_a = TextureOrigin::bottom_left, "triangle_features"_a = nb::none(),
          "feature_names"_a = nb::make_tuple(),
          "Copies the arrays: positions (n, 3), normals (n, 3) and texture_coordinates (n, 2) to float32, relative to\n"
          "an origin where floats would lose digits of float64 or integer positions, triangles\n"
          "(m, 3) and corners (m, 3) to uint32, colors (n, 4) of uint8, sRGB and alpha, triangle_materials (m,) to\n"
          "uint16, triangle_features (m,) to uint32. TypeError for other shapes, Error for an index out of range. A\n"
          "mesh with a vertex for each set of\n"
          "attributes needs no corners: clean() finds its wedges.")
      .def_static("empty", &make_empty, "vertices"_a, "triangles"_a, nb::kw_only(), "normals"_a = false,
                  "colors"_a = false, "texture_coordinates"_a = false,
                  "A mesh of zeros without seams, to be filled through its arrays without a copy of them.")
      .def_prop_ro("positions", writable<float, 3>(&TriangleMesh::positions),
                   "(n, 3) float32, object space, relative to origin, one for each wedge. A writable view.")
      .def_rw(
          "origin", &TriangleMesh::origin,
          "What positions are relative to: coordinates are origin + positions. Not 0 where floats would lose digits\n"
          "of coordinates, such as those of maps. Setting it moves the mesh.")
      .def_prop_ro("triangles", writable<std::uint32_t, 3>(&TriangleMesh::triangles),
                   "(m, 3) uint32, ids of vertices, counter-clockwise seen from outside. A writable view.")
      .def_prop_ro("normals", writable_or_none<float, 3>(&TriangleMesh::normals),
                   "(n, 3) float32 of unit length, one for each wedge, or None. A writable view.")
      .def_prop_ro("colors", writable_or_none<std::uint8_t, 4>(&TriangleMesh::colors),
                   "(n, 4) uint8, sRGB and alpha, one for each wedge, or None. A writable view.")
      .def_prop_ro("texture_coordinates", writable_or_none<float, 2>(&TriangleMesh::texture_coordinates),
                   "(n, 2) float32 as the file has them, one for each wedge, or None. A writable view.")
      .def_prop_ro(
          "extra_wedges", writable<std::uint32_t, 1>(&TriangleMesh::extra_wedges),
          "(n - vertex_count,) uint32: the vertex of each wedge from vertex_count on, ascending. A wedge is a\n"
          "vertex with one set of attributes; the first of each vertex has its id. A writable view.")
      .def_prop_ro("corners", writable_or_none<std::uint32_t, 3>(&TriangleMesh::corners),
                   "(m, 3) uint32: a wedge of each vertex of each triangle, or None without extra wedges. A writable\n"
                   "view.")
      .def_prop_ro(
          "wedge_triangles",
          [](nb::handle self) {
            const bool has_seams = !nb::cast<TriangleMesh&>(self).corners.empty();
            return writable<std::uint32_t, 3>(has_seams ? &TriangleMesh::corners : &TriangleMesh::triangles)(self);
          },
          "What to draw with positions and attributes: corners, or triangles without extra wedges.")
      .def_prop_ro("triangle_materials", writable_or_none<std::uint16_t, 1>(&TriangleMesh::triangle_materials),
                   "(m,) uint16: the material of each triangle, or None: all have the first, if any. A writable view.")
      .def_prop_ro("triangle_features", writable_or_none<std::uint32_t, 1>(&TriangleMesh::triangle_features),
                   "(m,) uint32: the part of the input that each triangle belongs to, or None: all have the first, if\n"
                   "any. HLODs and tilesets keep it. A writable view.")
      .def_rw("feature_names", &TriangleMesh::feature_names,
              "List of str, that triangle_features counts: a copy; set as a whole.")
      .def_prop_rw(
          "materials", [](const TriangleMesh& mesh) { return tuple_of<Material>(mesh.materials); },
          [](TriangleMesh& mesh, std::vector<Material> materials) { mesh.materials = std::move(materials); },
          nb::for_getter(nb::sig(materials_sig)), "That triangle_materials counts; set as a whole.")
      .def_prop_rw(
          "textures", [](const TriangleMesh& mesh) { return tuple_of<Texture>(mesh.textures); },
          [](TriangleMesh& mesh, std::vector<Texture> textures) { mesh.textures = std::move(textures); },
          nb::for_getter(nb::sig(textures_sig)), "That materials count; set as a whole.")
      .def_rw("texture_origin", &TriangleMesh::texture_origin, "Of texture_coordinates.")
      .def_rw("up", &TriangleMesh::up, "The axis that points up, as far as the file says.")
      .def_prop_ro("vertex_count", &TriangleMesh::vertex_count, "Of positions, without those of extra wedges.")
      .def_prop_ro("wedge_count", &TriangleMesh::wedge_count, "Vertices and extra wedges.")
      .def_prop_ro("triangle_count", &TriangleMesh::triangle_count)
      .def(
          "clean",
          [](const TriangleMesh& mesh) {
            const ReleasedGil release;
            require_valid(mesh);
            CleanMesh result = clean(mesh, MeshReport{}, "mesh");
            return std::pair<TriangleMesh, MeshReport>(std::move(result.mesh), result.report);
          },
          "A new mesh, welded by exactly equal positions and without degenerate indices, and what was found. What\n"
          "differs in attributes or material at one position becomes wedges.\n"
          "Error for a vertex that is used and not finite, and when no triangle is left.")
      .def(
          "report",
          [](const TriangleMesh& mesh) {
            const ReleasedGil release;
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
          [](const TriangleMesh& mesh, const std::filesystem::path& path, const std::filesystem::path& images) {
            std::vector<std::string> notes;
            {
              const ReleasedGil release;
              require_valid(mesh);
              notes = images.empty() ? write_mesh(path, mesh) : write_mesh(path, mesh, images);
            }
            for (const std::string& note : notes) {
              // Names may have bytes that are not UTF-8.
              const auto text = nb::steal<nb::str>(
                  PyUnicode_DecodeFSDefaultAndSize(note.data(), static_cast<Py_ssize_t>(note.size())));
              if (PyErr_WarnFormat(PyExc_UserWarning, 1, "%U", text.ptr()) != 0) throw nb::python_error();
            }
          },
          "path"_a, nb::kw_only(), "images"_a = "",
          "As PLY, OBJ, GLB, OFF or STL, by the extension. An old file stays as it was when writing fails. `images` "
          "is\n"
          "the folder that names of textures are relative to, else that of the path: GLB holds the images, and other\n"
          "files lead to them. Warns of those that are not there, and of those that glTF lacks. STL has floats only: "
          "its\n"
          "coordinates are relative to the origin.")
      .def("__copy__", [](const TriangleMesh& mesh) { return TriangleMesh(mesh); })
      .def(
          "__deepcopy__", [](const TriangleMesh& mesh, nb::handle) { return TriangleMesh(mesh); }, "memo"_a)
      .def("__getstate__", &state_of)
      .def("__setstate__", [](TriangleMesh& self, const MeshState& state) { new (&self) TriangleMesh(mesh_of(state)); })
      .def("__repr__", [](const TriangleMesh& mesh) {
        const std::string seams =
            mesh.extra_wedges.empty() ? "" : " (" + std::to_string(mesh.wedge_count()) + " wedges)";
        return "<occlod.Mesh of " + std::to_string(mesh.vertex_count()) + " vertices" + seams + " and " +
               std::to_string(mesh.triangle_count()) + " triangles>";
      });

  m.def(
      "read_mesh_and_report",
      [](const std::filesystem::path& path, const std::optional<nb::callable>& progress) {
        const auto step = progress_of(progress ? nb::handle(*progress) : nb::handle(Py_None));
        const ReleasedGil release;
        CleanMesh result = read_mesh(path, [&](double done) { step(done); });
        return std::pair<TriangleMesh, MeshReport>(std::move(result.mesh), result.report);
      },
      "path"_a, "progress"_a = nb::none(),
      "Reads PLY, OBJ, OFF, STL or glTF and cleans it: the mesh and what was found. `progress` is called with the\n"
      "share of the file that has been read. Error names the file, the place and the remedy.");
  bind_generators(m);
}

}  // namespace occlod::python
