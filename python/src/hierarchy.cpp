// Hierarchies: built, read, written, validated, and cut without a view.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>
#include <unordered_map>

#include "arrays.h"
#include "bindings.h"
#include "checks.h"
#include "materials.h"
#include "occlod/build_hierarchy.h"
#include "text.h"

namespace occlod::python {
namespace {

using namespace nb::literals;

// A cut with the hierarchy that it is of.
struct HierarchyCut {
  Hierarchy hierarchy;
  FixedCut cut;
};

Hierarchy build(const TriangleMesh& mesh, std::size_t base_triangles, double boundary_weight, double attribute_weight,
                ErrorBound error_bound, int threads, const std::optional<nb::callable>& progress) {
  BuildOptions options{base_triangles, boundary_weight, attribute_weight, error_bound, threads, {}};
  options.progress = progress_of(progress ? nb::handle(*progress) : nb::handle(Py_None));
  const ReleasedGil release;
  return build_hierarchy(mesh, options);
}

// The k-th float of each node, or one that follows it.
template <nb::ssize_t columns>
auto node_floats(std::size_t offset) {
  static_assert(sizeof(SplitNode) % sizeof(float) == 0);
  return [offset](nb::handle self) {
    const Hierarchy& hierarchy = nb::cast<const Hierarchy&>(self);
    const float* const first = reinterpret_cast<const float*>(hierarchy.data().nodes.data()) + offset / sizeof(float);
    constexpr std::size_t stride = sizeof(SplitNode) / sizeof(float);
    if constexpr (columns == 0)
      return values_view<const float>(first, hierarchy.split_count(), self, stride);
    else
      return rows_view<const float, columns>(first, hierarchy.split_count(), self, stride);
  };
}

// By collapse, the last split first: the vertex that it took away and the one that it was collapsed into.
Array2<std::uint32_t, 2> collapses(const Hierarchy& hierarchy) {
  std::vector<std::uint32_t> pairs;
  {
    const ReleasedGil release;
    hierarchy.require_all();
    pairs.reserve(2 * hierarchy.split_count());
    for (std::size_t s = hierarchy.split_count(); s-- > 0;) {
      pairs.push_back(hierarchy.vertex_of(static_cast<SplitId>(s)));
      pairs.push_back(hierarchy.parent_vertex(static_cast<SplitId>(s)));
    }
  }
  return rows_array_of<std::uint32_t, 2>(std::move(pairs));
}

using PositionBits = std::array<std::uint32_t, 3>;
PositionBits bits_of(const glm::vec3& p) {  // +0 and -0 are one
  return {std::bit_cast<std::uint32_t>(p.x + 0.0F), std::bit_cast<std::uint32_t>(p.y + 0.0F),
          std::bit_cast<std::uint32_t>(p.z + 0.0F)};
}
struct PositionHash {
  std::size_t operator()(const PositionBits& bits) const noexcept {
    std::uint64_t hash = 0;
    for (const std::uint32_t b : bits) hash = (std::rotl(hash, 23) ^ b) * 0x9E3779B97F4A7C15U;
    return static_cast<std::size_t>(hash ^ (hash >> 32U));
  }
};

std::vector<std::uint32_t> find(const Hierarchy& hierarchy, const std::vector<glm::vec3>& positions) {
  hierarchy.require_all();
  std::unordered_map<PositionBits, VertexId, PositionHash> places;
  places.reserve(hierarchy.vertex_count());
  for (VertexId v = 0; v < hierarchy.vertex_count(); ++v) places.emplace(bits_of(hierarchy.positions()[v]), v);
  std::vector<std::uint32_t> found;
  found.reserve(positions.size());
  for (const glm::vec3& position : positions) {
    const auto place = places.find(bits_of(position));
    found.push_back(place == places.end() ? no_id : place->second);
  }
  return found;
}

HierarchyCut cut(const Hierarchy& hierarchy, std::optional<std::size_t> triangles, std::optional<double> error) {
  if (triangles && error) throw nb::value_error("give a number of triangles or an error, not both");
  if (error && !(*error >= 0.0)) throw nb::value_error("an error is at least 0, in object units");
  const ReleasedGil release;
  if (triangles) return {hierarchy, cut_to_triangles(hierarchy, *triangles)};
  if (error) return {hierarchy, cut_to_error(hierarchy, *error)};
  return {hierarchy, full_cut(hierarchy)};
}

// For each vertex of cut_mesh() that of the hierarchy: they are numbered as triangles first use them.
std::vector<std::uint32_t> used_vertices(const Hierarchy& hierarchy, const FixedCut& cut) {
  std::vector<bool> is_used(hierarchy.vertex_count(), false);
  std::vector<std::uint32_t> used;
  for (const Triangle& triangle : triangles_of(hierarchy, cut))
    for (int corner = 0; corner < 3; ++corner)
      if (const VertexId v = triangle[corner]; !is_used[v]) {
        is_used[v] = true;
        used.push_back(v);
      }
  return used;
}

// For each vertex of the hierarchy the one of cut_mesh() that stands for it.
std::vector<std::uint32_t> vertex_map(const Hierarchy& hierarchy, const FixedCut& cut) {
  std::vector<std::uint32_t> map(hierarchy.vertex_count(), no_id);
  const std::vector<std::uint32_t> used = used_vertices(hierarchy, cut);
  for (std::size_t i = 0; i < used.size(); ++i) map[used[i]] = static_cast<std::uint32_t>(i);
  // Parents come first: a split depends on smaller ones only.
  for (SplitId s = 0; s < hierarchy.split_count(); ++s)
    if (!cut.applied[s]) map[hierarchy.vertex_of(s)] = map[hierarchy.parent_vertex(s)];
  return map;
}

void bind_cut(nb::module_& m) {
  nb::class_<HierarchyCut>(m, "Cut", "A mesh between the base mesh and the input that does not depend on a view.")
      .def("__repr__",
           [](const HierarchyCut& c) {
             return "<occlod.Cut of " + std::to_string(c.cut.triangles) + " of " +
                    std::to_string(c.hierarchy.input_triangle_count()) + " triangles>";
           })
      .def_prop_ro(
          "splits", [](const HierarchyCut& c) { return c.cut.splits; }, "How many are applied.")
      .def_prop_ro("triangle_count", [](const HierarchyCut& c) { return c.cut.triangles; })
      .def_prop_ro(
          "guaranteed_error", [](const HierarchyCut& c) { return c.cut.guaranteed_error; },
          "Bound on the distance to the input, object units.")
      .def_prop_ro(
          "error", [](const HierarchyCut& c) { return c.cut.error; },
          "Largest quadric error of a split that is not applied, object units.")
      .def_prop_ro(
          "applied",
          [](const HierarchyCut& c) {
            std::vector<std::uint8_t> bytes(c.cut.applied.begin(), c.cut.applied.end());
            return nb::cast(array_of(std::move(bytes))).attr("view")("bool");
          },
          nb::sig("def applied(self) -> numpy.typing.NDArray[numpy.bool_]"), "(splits,) bool. A copy.")
      .def(
          "triangles",
          [](const HierarchyCut& c) {
            auto corners = std::make_unique<std::vector<Triangle>>(triangles_of(c.hierarchy, c.cut));
            auto* const data = reinterpret_cast<std::uint32_t*>(corners->data());
            const std::size_t n = corners->size();
            return rows_view<std::uint32_t, 3>(data, n, owner_of(std::move(corners)));
          },
          "(m, 3) uint32, ids of the hierarchy's vertices: base faces first, then by split. O(n).")
      .def(
          "wedge_triangles",
          [](const HierarchyCut& c) {
            auto corners = std::make_unique<std::vector<Triangle>>(wedge_triangles_of(c.hierarchy, c.cut));
            auto* const data = reinterpret_cast<std::uint32_t*>(corners->data());
            const std::size_t n = corners->size();
            return rows_view<std::uint32_t, 3>(data, n, owner_of(std::move(corners)));
          },
          "The same triangles as ids of wedges: what to draw with positions, normals, colors and\n"
          "texture_coordinates. O(n).")
      .def(
          "mesh",
          [](const HierarchyCut& c) {
            const ReleasedGil release;
            return cut_mesh(c.hierarchy, c.cut);
          },
          "A Mesh of its own with wedges, materials and textures, without vertices that no triangle uses. O(n).")
      .def(
          "vertices", [](const HierarchyCut& c) { return array_of(used_vertices(c.hierarchy, c.cut)); },
          "(k,) uint32: for each vertex of mesh() that of the hierarchy. O(n).")
      .def(
          "vertex_map", [](const HierarchyCut& c) { return array_of(vertex_map(c.hierarchy, c.cut)); },
          "(n,) uint32: for each vertex of the hierarchy the vertex of mesh() that stands for it; NO_ID where all\n"
          "around it has vanished. O(n).");
}

}  // namespace

void bind_hierarchy(nb::module_& m) {
  nb::enum_<ErrorBound>(m, "ErrorBound", "How guaranteed errors are computed. Both are upper bounds.")
      .value("accumulated", ErrorBound::accumulated, "All movements added up: several times too large when coarse.")
      .value("measured", ErrorBound::measured, "Against the input: tight, at several times the building time.");
  nb::enum_<OlodCompression>(m, "Compression", "How the arrays of a file are stored.")
      .value("none", OlodCompression::none, "As in memory: the file can be mapped.")
      .value("zstd", OlodCompression::zstd, "About half the size; decompressed when read.");
  nb::enum_<OlodAccess>(m, "Access", "How a file without compression is read.")
      .value("mapped", OlodAccess::mapped, "Pages are loaded as they are used.")
      .value("copied", OlodAccess::copied, "Independent of what happens to the file afterwards.");
  m.attr("NO_ID") = no_id;

  nb::class_<Hierarchy> type(
      m, "Hierarchy",
      "The recorded collapses of one mesh. Immutable; copies share memory; threads may share it. Its\n"
      "arrays are read-only views, which keep it and a mapped file alive.");
  type.def_prop_ro(
          "positions", [](nb::handle self) { return view_of(nb::cast<const Hierarchy&>(self).positions(), self); },
          "(n, 3) float32, object space: what triangles index. First the base mesh, then one for each split, then\n"
          "one for each extra wedge.")
      .def_prop_ro(
          "normals",
          [](nb::handle self) -> std::optional<Array2<const float, 3>> {
            const auto normals = nb::cast<const Hierarchy&>(self).data().normals;
            if (normals.empty()) return std::nullopt;
            return view_of(normals, self);
          },
          "(n, 3) float32 of unit length, or None.")
      .def_prop_ro(
          "colors",
          [](nb::handle self) -> std::optional<Array2<const std::uint8_t, 4>> {
            const auto colors = nb::cast<const Hierarchy&>(self).data().colors;
            if (colors.empty()) return std::nullopt;
            return view_of(colors, self);
          },
          "(n, 4) uint8, sRGB and alpha, or None.")
      .def_prop_ro(
          "texture_coordinates",
          [](nb::handle self) -> std::optional<Array2<const float, 2>> {
            const auto coordinates = nb::cast<const Hierarchy&>(self).data().texture_coordinates;
            if (coordinates.empty()) return std::nullopt;
            return view_of(coordinates, self);
          },
          "(n, 2) float32 as the input has them, one for each wedge, or None.")
      .def_prop_ro(
          "extra_wedges",
          [](nb::handle self) { return view_of(nb::cast<const Hierarchy&>(self).data().extra_wedges, self); },
          "(k,) uint32: the vertex of each wedge from vertex_count on, ascending. A wedge is a vertex with one set\n"
          "of attributes; the first of each vertex has its id.")
      .def_prop_ro(
          "wedge_materials",
          [](nb::handle self) -> std::optional<Array1<const std::uint16_t>> {
            const auto materials = nb::cast<const Hierarchy&>(self).data().wedge_materials;
            if (materials.empty()) return std::nullopt;
            return view_of(materials, self);
          },
          "(n,) uint16: the material of the triangles at each wedge, or None when there is one or none.")
      .def_prop_ro(
          "materials", [](const Hierarchy& h) { return tuple_of<Material>(h.data().materials); },
          nb::sig(materials_sig), "That wedge_materials counts.")
      .def_prop_ro(
          "textures", [](const Hierarchy& h) { return tuple_of<Texture>(h.data().textures); }, nb::sig(textures_sig),
          "That materials count.")
      .def_prop_ro(
          "texture_origin", [](const Hierarchy& h) { return h.data().texture_origin; }, "Of texture_coordinates.")
      .def_prop_ro(
          "attribute_errors",
          [](const Hierarchy& h) -> nb::object {
            if (h.data().attribute_errors.empty()) return nb::none();
            h.require_all();
            std::vector<float> errors(h.split_count());
            for (std::size_t s = 0; s < errors.size(); ++s) errors[s] = h.attribute_error(static_cast<SplitId>(s));
            return nb::cast(array_of(std::move(errors)));
          },
          nb::sig("def attribute_errors(self) -> numpy.typing.NDArray[numpy.float32] | None"),
          "(splits,) float32: how far texture coordinates, normals and colours are off without each split, as a\n"
          "length in object units; about a root mean square. A copy. None where the input has neither texture\n"
          "coordinates nor seams.")
      .def_prop_ro("wedge_count", &Hierarchy::wedge_count, "Vertices and extra wedges.")
      .def_prop_ro(
          "base_triangles",
          [](nb::handle self) { return view_of(nb::cast<const Hierarchy&>(self).data().base_faces, self); },
          "(b, 3) uint32: the base mesh.")
      .def_prop_ro("errors", node_floats<0>(offsetof(SplitNode, error)),
                   "(splits,) float32: quadric error without each split, about a root mean square distance.")
      .def_prop_ro("guaranteed_errors", node_floats<0>(offsetof(SplitNode, guaranteed_error)),
                   "(splits,) float32: bound on the distance to the input without each split.")
      .def_prop_ro("spheres", node_floats<4>(offsetof(SplitNode, sphere)),
                   "(splits, 4) float32: centre and radius around all that each split and those below it change.")
      .def_prop_ro("vertex_count", &Hierarchy::vertex_count)
      .def_prop_ro("split_count", &Hierarchy::split_count)
      .def_prop_ro("base_triangle_count", &Hierarchy::base_triangle_count, "The fewest triangles of a cut.")
      .def_prop_ro("input_triangle_count", &Hierarchy::input_triangle_count, "When all splits are applied.")
      .def_prop_ro(
          "box", [](const Hierarchy& h) { return std::pair(h.box().min, h.box().max); }, "Around all positions.")
      .def_prop_ro(
          "origin", [](const Hierarchy& h) { return h.data().origin; },
          "What positions are relative to: coordinates are origin + positions. See Mesh.origin.")
      .def_prop_ro("error_bound", &Hierarchy::error_bound, "No cut is farther from the input, object units.")
      .def_prop_ro("bytes", &Hierarchy::bytes, "That the arrays occupy.")
      .def("collapses", &collapses,
           "(splits, 2) uint32 in the order of collapsing: the vertex that was taken away and the one that it was\n"
           "collapsed into, ids of the hierarchy's vertices. errors[::-1] are its errors. O(n).")
      .def(
          "find",
          [](const Hierarchy& h, const ArrayLike& positions) {
            const std::vector<glm::vec3> values = to_vectors(positions, "positions");
            std::vector<std::uint32_t> found;
            {
              const ReleasedGil release;
              found = find(h, values);
            }
            return array_of(std::move(found));
          },
          "positions"_a, "(n,) uint32: for each position the vertex at exactly that place, or NO_ID. Expected O(n).")
      .def("cut", &cut, nb::kw_only(), "triangles"_a = nb::none(), "error"_a = nb::none(),
           "With at most so many triangles, the base mesh when even that has more; or with a guaranteed error of at\n"
           "most so much, object units; or the input. O(n).")
      .def(
          "write",
          [](const Hierarchy& h, const std::filesystem::path& path, const std::optional<MeshReport>& report,
             OlodCompression compression, const std::filesystem::path& images) {
            const ReleasedGil release;
            write_olod(path, h, report.value_or(MeshReport{}), compression, images);
          },
          "path"_a, nb::kw_only(), "report"_a = nb::none(), "compression"_a = OlodCompression::none, "images"_a = "",
          "As .olod, with the report of the mesh that it was built from. An old file stays as it was when writing\n"
          "fails. With `images`, the folder that names of textures are relative to, the names of those that are there\n"
          "are written so that they lead to them from the file.")
      .def(
          "__copy__", [](nb::object self) { return self; }, nb::sig("def __copy__(self) -> Hierarchy"))
      .def(
          "__deepcopy__", [](nb::object self, nb::handle) { return self; }, "memo"_a,
          nb::sig("def __deepcopy__(self, memo: object) -> Hierarchy"))
      .def("__repr__", [](const Hierarchy& h) {
        return "<occlod.Hierarchy of " + std::to_string(h.input_triangle_count()) + " triangles, " +
               std::to_string(h.base_triangle_count()) + " in the base mesh>";
      });
  bind_checks(type,
              {"Checks all of a mapped file; else its blocks are checked as they are used. Error where it is damaged.",
               "random_cuts", "Whether applying all splits gives exactly the triangles of the mesh."},
              16);
  bind_cut(m);

  const BuildOptions standard;
  m.def("build_hierarchy", &build, "mesh"_a, nb::kw_only(), "base_triangles"_a = standard.base_triangles,
        "boundary_weight"_a = standard.boundary_weight, "attribute_weight"_a = standard.attribute_weight,
        "error_bound"_a = standard.error_bound, "threads"_a = standard.threads, "progress"_a = nb::none(),
        "Builds the hierarchy of any triangle soup with welded vertices (read_mesh() and Mesh.clean() weld). The same\n"
        "mesh and options give the same bytes for any number of threads (0: one for each core). `progress` is called\n"
        "with the share done; what it raises, and Ctrl-C, end the build. O(n log n).");
  m.def(
      "read_hierarchy_and_report",
      [](const std::filesystem::path& path, OlodAccess access) {
        const ReleasedGil release;
        OlodFile file = read_olod(path, access);
        return std::pair<Hierarchy, MeshReport>(std::move(file.hierarchy), file.report);
      },
      "path"_a, nb::kw_only(), "access"_a = OlodAccess::mapped,
      "Reads .olod: the hierarchy and the report of its mesh. A mapped file must not be cut short while it is open.");
}

}  // namespace occlod::python
