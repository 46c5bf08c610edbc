// View cells: questions about a cell, what hides from it, its cut.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <tuple>

#include "arrays.h"
#include "cell_cut.h"
#include "occlod/build_hierarchy.h"
#include "occlod/cell_builder.h"
#include "refining.h"
#include "view_like.h"

namespace occlod::python {
namespace {

using namespace nb::literals;

struct PythonOccluders {
  CellOccluders occluders;
};

struct PythonCellBuilder {
  PythonCellBuilder(std::vector<PlacedObject> placed, std::shared_ptr<const PythonOccluders> given,
                    const CellOptions& options)
      : objects(std::make_shared<KeptObjects>(std::move(placed))),
        occluders(std::move(given)),
        builder(objects->refine_objects(), occluders ? &occluders->occluders : nullptr, options) {}

  std::shared_ptr<const KeptObjects> objects;
  std::shared_ptr<const PythonOccluders> occluders;
  CellBuilder builder;
  std::mutex in_use;
};

std::unique_ptr<PythonCellCut> build(PythonCellBuilder& self, const CellBox& cell) {
  const ReleasedGil release;
  const std::scoped_lock lock(self.in_use);
  return std::make_unique<PythonCellCut>(PythonCellCut{self.builder.build(cell), self.objects});
}

// Calls answer(row) for each row of an array, of `columns` floats.
template <typename Value, typename Answer>
Array1<Value> of_rows(const nb::object& rows, std::size_t columns, const Answer& answer) {
  const auto array = nb::cast<nb::ndarray<const float, nb::ndim<2>, nb::c_contig>>(rows);
  std::vector<Value> values(array.shape(0));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = answer(array.data() + i * columns);
  return array_of(std::move(values));
}

Sphere sphere_of(const float* row) { return {{row[0], row[1], row[2]}, row[3]}; }
Box box_of(const float* row) { return {{row[0], row[1], row[2]}, {row[3], row[4], row[5]}}; }

nb::object as_bools(std::vector<std::uint8_t> bytes) {
  return nb::cast(array_of(std::move(bytes))).attr("view")("bool");
}

nb::object faces_away(const CellView& view, const ArrayLike& positions, const ArrayLike& triangles) {
  const std::vector<glm::vec3> points = to_vectors(positions, "positions");
  std::vector<std::uint8_t> away;
  for (const Triangle& t : to_triangles(triangles, "triangles")) {
    if (std::max({t.x, t.y, t.z}) >= points.size())
      throw nb::index_error(("there are " + std::to_string(points.size()) + " positions").c_str());
    away.push_back(view.faces_away(points[t.x], points[t.y], points[t.z]) ? 1 : 0);
  }
  return as_bools(std::move(away));
}

nb::object cones_face_away(const CellView& view, const ArrayLike& cones, const ArrayLike& spheres) {
  const nb::object both[2] = {contiguous(cones, "cones", "float32", 4), contiguous(spheres, "spheres", "float32", 4)};
  const auto axes = nb::cast<nb::ndarray<const float, nb::ndim<2>, nb::c_contig>>(both[0]);
  const auto bounds = nb::cast<nb::ndarray<const float, nb::ndim<2>, nb::c_contig>>(both[1]);
  if (axes.shape(0) != bounds.shape(0)) throw nb::type_error("spheres: wrong shape; give one for each cone");
  std::vector<std::uint8_t> away(axes.shape(0));
  for (std::size_t i = 0; i < away.size(); ++i) {
    const float* const row = axes.data() + 4 * i;
    away[i] = view.faces_away(NormalCone{{row[0], row[1], row[2]}, row[3]}, sphere_of(bounds.data() + 4 * i)) ? 1 : 0;
  }
  return as_bools(std::move(away));
}

void bind_questions(nb::module_& m) {
  nb::class_<CellBox>(m, "CellBox", "A closed box in world space, in which the eye may be anywhere; may be flat.")
      .def(nb::init<glm::dvec3, glm::dvec3>(), "min"_a, "max"_a)
      .def_rw("min", &CellBox::min, "World space. A copy: assign three numbers.")
      .def_rw("max", &CellBox::max, "The same.")
      .def("__eq__", [](const CellBox& a,
                        nb::handle b) { return nb::isinstance<CellBox>(b) && a == nb::cast<const CellBox&>(b); })
      .def("__getstate__", [](const CellBox& b) { return std::tuple(b.min, b.max); })
      .def("__setstate__", [](CellBox& self, const std::tuple<glm::dvec3, glm::dvec3>& state) {
        new (&self) CellBox{std::get<0>(state), std::get<1>(state)};
      });
  const EyeModel standard;
  nb::class_<EyeModel>(m, "EyeModel", "What all eyes of a cell have in common. See eye_model().")
      .def(
          "__init__",
          [](EyeModel* self, double focal_length_px, double cos_corner_angle, double near, double clearance) {
            new (self) EyeModel{focal_length_px, cos_corner_angle, near, clearance};
          },
          nb::kw_only(), "focal_length_px"_a = standard.focal_length_px,
          "cos_corner_angle"_a = standard.cos_corner_angle, "near"_a = standard.near,
          "clearance"_a = standard.clearance)
      .def_rw("focal_length_px", &EyeModel::focal_length_px, "The largest of all eyes.")
      .def_rw("cos_corner_angle", &EyeModel::cos_corner_angle,
              "Of the angle between the line of sight and the corners of the image; the smallest of all eyes.")
      .def_rw("near", &EyeModel::near, "Distance to the near plane; what it clips away hides nothing.")
      .def_rw("clearance", &EyeModel::clearance, "No eye comes nearer than this to any surface.")
      .def("__getstate__",
           [](const EyeModel& e) { return std::tuple(e.focal_length_px, e.cos_corner_angle, e.near, e.clearance); })
      .def("__setstate__", [](EyeModel& self, const std::tuple<double, double, double, double>& state) {
        new (&self) EyeModel{std::get<0>(state), std::get<1>(state), std::get<2>(state), std::get<3>(state)};
      });
  m.def(
      "eye_model", [](const ViewLike& view) { return eye_model(view.get()); }, "view"_a,
      "Of all eyes that see what this view sees, up to where they are and look. Error for an orthographic view.");
  nb::class_<CellView>(m, "CellView",
                       "Questions about one object for all eyes of a cell at once: answers hold for each eye.\n"
                       "Immutable.")
      .def(
          "__init__",
          [](CellView* self, const CellBox& cell, const EyeModel& eyes, const std::optional<ArrayLike>& transform) {
            new (self) CellView(cell, eyes, transform ? to_matrix(*transform, "transform") : glm::dmat4(1.0));
          },
          "cell"_a, "eyes"_a = EyeModel{}, "transform"_a = nb::none(),
          "`transform`: (4, 4), object to world, affine and invertible.")
      .def_prop_ro("cell", &CellView::cell)
      .def(
          "sphere_scales_px",
          [](const CellView& v, const ArrayLike& spheres) {
            return of_rows<float>(contiguous(spheres, "spheres", "float32", 4), 4,
                                  [&](const float* row) { return v.largest_scale_px(sphere_of(row)); });
          },
          "spheres"_a,
          "(n,) float32: pixels that one object unit can cover at most, anywhere in each sphere; `spheres`: (n, 4),\n"
          "centre and radius, as Hierarchy.spheres.")
      .def(
          "box_scales_px",
          [](const CellView& v, const ArrayLike& boxes) {
            return of_rows<float>(contiguous(boxes, "boxes", "float32", 6), 6,
                                  [&](const float* row) { return v.largest_scale_px(box_of(row)); });
          },
          "boxes"_a, "The same of boxes: (n, 6), lower and upper corner.")
      .def(
          "smallest_scales_px",
          [](const CellView& v, const ArrayLike& boxes) {
            return of_rows<double>(contiguous(boxes, "boxes", "float32", 6), 6,
                                   [&](const float* row) { return v.smallest_scale_px(box_of(row)); });
          },
          "boxes"_a, "(n,) float64: what box_scales_px() is at least, at any single point.")
      .def("faces_away", &faces_away, "positions"_a, "triangles"_a,
           nb::sig("def faces_away(self, positions: numpy.typing.ArrayLike, triangles: numpy.typing.ArrayLike) -> "
                   "numpy.typing.NDArray[numpy.bool_]"),
           "(m,) bool: whether no eye sees the front of each triangle.")
      .def("cones_face_away", &cones_face_away, "cones"_a, "spheres"_a,
           nb::sig("def cones_face_away(self, cones: numpy.typing.ArrayLike, spheres: numpy.typing.ArrayLike) -> "
                   "numpy.typing.NDArray[numpy.bool_]"),
           "(n,) bool: the same of all surface in a sphere with normals in a cone; `cones`: (n, 4), unit axis and\n"
           "cosine of the angle.")
      .def(
          "world_box",
          [](const CellView& v, glm::vec3 min, glm::vec3 max, double margin) {
            return v.world_box(Box{min, max}, margin);
          },
          "min"_a, "max"_a, "margin"_a = 0.0, "Around a box in object space, grown by `margin` >= 0 object units.");
}

void bind_cut(nb::module_& m) {
  nb::class_<CellStats>(m, "CellStats", "Counts of one call of CellBuilder.build().")
      .def_ro("nodes", &CellStats::nodes, "That were looked at.")
      .def_ro("fine_nodes", &CellStats::fine_nodes, "Of these, whose subtrees are within the tolerance.")
      .def_ro("hidden_nodes", &CellStats::hidden_nodes, "Of the others, hidden with their subtrees.")
      .def_ro("forced_splits", &CellStats::forced_splits, "Applied because another depends on them.")
      .def_ro("queries", &CellStats::queries, "Whether something is hidden.")
      .def_ro("queries_hidden", &CellStats::queries_hidden, "Of these, answered hidden.")
      .def_ro("queries_boxed", &CellStats::queries_boxed, "Of these, behind a box inside a solid.")
      .def_ro("floods", &CellStats::floods, "To answer them.")
      .def_ro("flood_triangles", &CellStats::flood_triangles, "That floods reached.");
  nb::class_<PythonCellCut>(m, "CellCut",
                            "What has to be drawn for all eyes of a cell. Its arrays are read-only views, which keep\n"
                            "it alive.")
      .def(
          "__len__", [](const PythonCellCut& c) { return c.cut.objects.size(); }, "Number of objects.")
      .def(
          "triangles",
          [](nb::handle self, std::size_t i) {
            return view_of(std::span<const Triangle>(nb::cast<const PythonCellCut&>(self).object(i).triangles), self);
          },
          "object"_a = 0, "(m, 3) uint32, to draw: ids into positions(object).")
      .def(
          "applied",
          [](nb::handle self, std::size_t i) {
            return view_of(std::span<const SplitId>(nb::cast<const PythonCellCut&>(self).object(i).applied), self);
          },
          "object"_a = 0, "(s,) uint32, ascending: the splits that are applied.")
      .def(
          "positions",
          [](nb::handle self, std::size_t i) {
            const auto& cut = nb::cast<const PythonCellCut&>(self);
            static_cast<void>(cut.object(i));  // throws
            return view_of(cut.placed(i).hierarchy.positions(), self);
          },
          "object"_a = 0, "(n, 3) float32, object space: of all vertices of the hierarchy.")
      .def(
          "mesh",
          [](const PythonCellCut& c, std::size_t i) { return mesh_of(c.placed(i).hierarchy, c.object(i).triangles); },
          "object"_a = 0, "A Mesh of its own, object space, without vertices that no triangle uses. O(n).")
      .def(
          "draw_objects",
          [](nb::handle self) {
            const auto& cut = nb::cast<const PythonCellCut&>(self);
            std::vector<PythonDrawObject> objects;
            for (std::size_t i = 0; i < cut.cut.objects.size(); ++i) {
              const PlacedObject& placed = cut.placed(i);
              const HierarchyView& data = placed.hierarchy.data();
              objects.push_back(
                  {{data.positions, data.colors, cut.object(i).triangles, placed.object_to_world}, {nb::borrow(self)}});
            }
            return objects;
          },
          "What draw_items() takes: all objects at their places. No copies.")
      .def_prop_ro(
          "active_triangles", [](const PythonCellCut& c) { return c.cut.triangles; },
          "How many the cuts of all objects have, drawn or not.")
      .def_prop_ro(
          "drawn_triangles", [](const PythonCellCut& c) { return c.cut.drawn_triangles; }, "Of these, to draw.")
      .def_prop_ro(
          "error_px", [](const PythonCellCut& c) { return c.cut.error_px; },
          "How far anything seen is from what is drawn, at most.")
      .def_prop_ro(
          "stats", [](const PythonCellCut& c) { return c.cut.stats; }, "Of the call.");
}

}  // namespace

void bind_cells(nb::module_& m) {
  bind_questions(m);
  bind_cut(m);
  const CellOptions standard;
  nb::enum_<CellOcclusion>(m, "CellOcclusion", "How what cannot be seen from a cell is found.")
      .value("none", CellOcclusion::none, "Nothing is hidden.")
      .value("hull", CellOcclusion::hull, "By the occluders: what they hide from all eyes (conservative).")
      .value("sampled", CellOcclusion::sampled,
             "What no pixel of some eyes shows, nor its neighbours; what other eyes see may be missing.");
  nb::class_<CellOptions>(m, "CellOptions", "How the cut of a cell is chosen.")
      .def(
          "__init__",
          [](CellOptions* self, const EyeModel& eyes, double tolerance_px, CellOcclusion occlusion, int sampled_eyes,
             std::size_t budget) {
            new (self) CellOptions{eyes, tolerance_px, occlusion, sampled_eyes, budget};
          },
          nb::kw_only(), "eyes"_a = standard.eyes, "tolerance_px"_a = standard.tolerance_px,
          "occlusion"_a = standard.occlusion, "sampled_eyes"_a = standard.sampled_eyes, "budget"_a = standard.budget)
      .def_rw("eyes", &CellOptions::eyes)
      .def_rw("tolerance_px", &CellOptions::tolerance_px,
              "How far from the input what is seen of it may be drawn, > 0.")
      .def_rw("occlusion", &CellOptions::occlusion)
      .def_rw("sampled_eyes", &CellOptions::sampled_eyes, "Of CellOcclusion.sampled, along each axis of the cell.")
      .def_rw("budget", &CellOptions::budget, "Active triangles at most; 0: as many as the tolerance takes.")
      .def("__getstate__",
           [](const CellOptions& o) {
             return std::tuple(o.eyes, o.tolerance_px, o.occlusion, o.sampled_eyes, o.budget);
           })
      .def("__setstate__",
           [](CellOptions& self, const std::tuple<EyeModel, double, CellOcclusion, int, std::size_t>& state) {
             CellOptions made;
             std::tie(made.eyes, made.tolerance_px, made.occlusion, made.sampled_eyes, made.budget) = state;
             new (&self) CellOptions(made);
           });
  nb::class_<PythonOccluders>(m, "CellOccluders",
                              "The surfaces of all objects, simplified: what can hide from cells. Immutable; threads\n"
                              "may share them.")
      .def(
          "__init__",
          [](PythonOccluders* self, nb::object objects, double max_motion) {
            const KeptObjects kept(to_objects(objects));
            const ReleasedGil release;
            new (self) PythonOccluders{CellOccluders(kept.refine_objects(), max_motion)};
          },
          "objects"_a, "max_motion"_a,
          nb::sig("def __init__(self, objects: Object | Hierarchy | collections.abc.Iterable[Object | Hierarchy], "
                  "max_motion: float) -> None"),
          "`max_motion`: how far surface may have moved, world units; 0: the input itself. Error for less.")
      .def_prop_ro(
          "triangle_count", [](const PythonOccluders& o) { return o.occluders.triangle_count(); }, "Of all objects.")
      .def(
          "hides",
          [](const PythonOccluders& o, const CellBox& eyes, const CellBox& what, double near_reach) {
            const ReleasedGil release;
            return o.occluders.hides(eyes, what, near_reach);
          },
          "eyes"_a, "what"_a, "near_reach"_a = 0.0,
          "Whether no eye in `eyes` sees any of `what`; False where one connected surface does not hide all of it.\n"
          "Nothing hides within `near_reach` of the eyes.");
  nb::class_<PythonCellBuilder>(m, "CellBuilder",
                                "Chooses what is drawn for all eyes of a cell. Calls from several threads wait for\n"
                                "each other.")
      .def(
          "__init__",
          [](PythonCellBuilder* self, nb::object objects, std::shared_ptr<const PythonOccluders> occluders,
             const std::optional<CellOptions>& options) {
            std::vector<PlacedObject> placed = to_objects(objects);
            const ReleasedGil release;
            new (self) PythonCellBuilder(std::move(placed), std::move(occluders), options.value_or(CellOptions{}));
          },
          "objects"_a, "occluders"_a.none() = nb::none(), "options"_a = nb::none(),
          nb::sig("def __init__(self, objects: Object | Hierarchy | collections.abc.Iterable[Object | Hierarchy], "
                  "occluders: CellOccluders | None = None, options: CellOptions | None = None) -> None"),
          "`occluders`: of the same objects; without them nothing is hidden. Error for options out of their range.")
      .def("build", &build, "cell"_a,
           "The cut of one cell: a second or so for each million triangles of a scene. Error for a cell that is\n"
           "inverted or not finite.");
}

}  // namespace occlod::python
