// Objects, refiners and what they give.
#include "occlod/refiner.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>

#include "arrays.h"
#include "occlod/build_hierarchy.h"
#include "refining.h"
#include "text.h"

namespace occlod::python {
namespace {

using namespace nb::literals;
using State = RefinerState<Refiner>;

struct PythonRefiner {
  std::shared_ptr<State> state;
  std::shared_ptr<PythonVisibility> software;  // made when first used
};

struct PythonMorph {
  Hierarchy hierarchy;
  MorphedPositions morphed;
};

enum class Way { from_scratch, going_on };

template <Way way>
std::shared_ptr<Result> refine(PythonRefiner& self, const ViewLike& view, std::optional<std::size_t> budget,
                               std::shared_ptr<PythonVisibility> visibility,
                               const std::optional<RefineOptions>& options) {
  if (!visibility) {
    if (!self.software) {
      self.software = std::make_shared<PythonVisibility>();
      self.software->backend = make_visibility("software");
    }
    visibility = self.software;
  }
  State& state = *self.state;
  const View seen = view.get();
  const RefineOptions chosen = to_options(options, budget);
  std::shared_ptr<const void> used = visibility;
  const auto result = run(
      self.state, [&] { return std::scoped_lock(state.in_use, visibility->in_use); },
      [&]() -> const Refinement& {
        std::swap(state.visibility, used);
        return way == Way::from_scratch ? state.refiner.refine(seen, chosen, *visibility->backend)
                                        : state.refiner.update(seen, chosen, *visibility->backend);
      });
  return result;
}

void bind_stats(nb::module_& m) {
  nb::class_<RefineStats>(m, "RefineStats", "Counts, errors and times of one call.")
      .def_ro("budget", &RefineStats::budget, "As given.")
      .def_ro("triangles", &RefineStats::triangles, "Of all objects.")
      .def_ro("splits", &RefineStats::splits, "Applied.")
      .def_ro("nodes", &RefineStats::nodes, "That refinement reached.")
      .def_ro("culled_frustum", &RefineStats::culled_frustum, "Of these, outside the frustum.")
      .def_ro("culled_backface", &RefineStats::culled_backface, "Of the others, facing away.")
      .def_ro("culled_occlusion", &RefineStats::culled_occlusion, "Of the others, hidden.")
      .def_ro("max_error_px", &RefineStats::max_error_px,
              "Largest guaranteed screen error left on surface held to be visible.")
      .def_ro("max_quadric_error_px", &RefineStats::max_quadric_error_px, "The same of the quadric error; no bound.")
      .def_ro("level_px", &RefineStats::level_px, "Priority of what would have been next when the budget was used up.")
      .def_ro("pending", &RefineStats::pending, "update(): a limit ended the call before its work was done.")
      .def_ro("new_splits", &RefineStats::new_splits, "Applied by this call and not there before.")
      .def_ro("forced_splits", &RefineStats::forced_splits, "Of those, only because another depends on them.")
      .def_ro("forced_unseen_splits", &RefineStats::forced_unseen_splits, "Of those, change nothing that is seen.")
      .def_ro("merged_splits", &RefineStats::merged_splits, "update(): taken back by this call.")
      .def_ro("rejected_splits", &RefineStats::rejected_splits, "Visible, but would have broken the budget.")
      .def_ro("readmitted", &RefineStats::readmitted, "Hidden by an earlier occluder, asked about again and visible.")
      .def_ro("taken_back", &RefineStats::taken_back, "Splits given up to make room, or needless.")
      .def_ro("visits", &RefineStats::visits, "From scratch nodes reached; going on candidates tried.")
      .def_ro("queries", &RefineStats::queries, "Asked of the backend.")
      .def_ro("queries_hidden", &RefineStats::queries_hidden, "Of those, answered hidden.")
      .def_ro("occluder_draws", &RefineStats::occluder_draws)
      .def_ro("changed_triangles", &RefineStats::changed_triangles, "Places that differ from those of the call before.")
      .def_ro("refine_ms", &RefineStats::refine_ms, "Wall time without occlusion_ms.")
      .def_ro("occlusion_ms", &RefineStats::occlusion_ms, "Drawing occluders, asking and waiting for answers.");
}

using Geomorphs = std::tuple<Array1<const std::uint32_t>, Array1<const std::uint32_t>, Array1<const float>>;

Geomorphs geomorphs(nb::handle self, std::size_t i) {
  const std::vector<Geomorph>& morphs = nb::cast<const Result&>(self).object(i).geomorphs;
  static_assert(sizeof(Geomorph) == 12);
  return {values_view<const std::uint32_t>(morphs.empty() ? nullptr : &morphs[0].vertex, morphs.size(), self, 3),
          values_view<const std::uint32_t>(morphs.empty() ? nullptr : &morphs[0].parent, morphs.size(), self, 3),
          values_view<const float>(morphs.empty() ? nullptr : &morphs[0].t, morphs.size(), self, 3)};
}

void bind_result(nb::module_& m) {
  nb::class_<Result>(
      m, "Refinement",
      "The triangles of every object for one view. Its arrays are read-only views without a copy. They\n"
      "stay as they are for as long as they are held: when the next call of the refiner is made, what is\n"
      "still held gets the memory for itself, and the refiner goes on with a copy.")
      .def_prop_ro(
          "stats", [](const Result& r) { return r.get().stats; }, "Of the call.")
      .def_prop_ro(
          "hash", [](const Result& r) { return r.get().hash(); },
          "Over all triangles in order: equal iff they are, for all practical purposes. O(triangles).")
      .def(
          "__len__", [](const Result& r) { return r.get().objects.size(); }, "Number of objects.")
      .def(
          "triangles",
          [](nb::handle self, std::size_t i) {
            return view_of(std::span<const Triangle>(nb::cast<const Result&>(self).object(i).triangles), self);
          },
          "object"_a = 0,
          "(m, 3) uint32: ids into positions(object). From update() those that stay active keep their places, but for\n"
          "those that fill holes.")
      .def(
          "positions",
          [](nb::handle self, std::size_t i) {
            const Result& result = nb::cast<const Result&>(self);
            static_cast<void>(result.object(i));  // throws
            return view_of(result.placed(i).hierarchy.positions(), self);
          },
          "object"_a = 0, "(n, 3) float32, object space: of all vertices of the hierarchy.")
      .def(
          "splits",
          [](nb::handle self, std::size_t i) {
            return view_of(std::span<const SplitId>(nb::cast<const Result&>(self).object(i).splits), self);
          },
          "object"_a = 0, "(s,) uint32, ascending: the splits that are applied, the whole state.")
      .def(
          "changes",
          [](nb::handle self, std::size_t i) {
            const std::vector<TriangleRange>& changes = nb::cast<const Result&>(self).object(i).changes;
            static_assert(sizeof(TriangleRange) == 8);
            return rows_view<const std::uint32_t, 2>(changes.empty() ? nullptr : &changes[0].first, changes.size(),
                                                     self);
          },
          "object"_a = 0,
          "(c, 2) uint32, ascending: first and count of the triangles that differ from those of the call before.")
      .def("geomorphs", &geomorphs, "object"_a = 0,
           "Vertices that slide, their parents, and how far they have gone, 0 to 1: three arrays of the same length.\n"
           "See MorphedPositions.")
      .def(
          "mesh", [](const Result& r, std::size_t i) { return mesh_of(r.placed(i).hierarchy, r.object(i).triangles); },
          "object"_a = 0, "A Mesh of its own, object space, without vertices that no triangle uses. O(n).")
      .def(
          "draw_objects",
          [](nb::handle self) {
            const Result& result = nb::cast<const Result&>(self);
            std::vector<PythonDrawObject> objects;
            for (std::size_t i = 0; i < result.get().objects.size(); ++i) {
              const HierarchyView& data = result.placed(i).hierarchy.data();
              objects.push_back(
                  {{data.positions, data.colors, result.object(i).triangles, result.place(i)}, {nb::borrow(self)}});
            }
            return objects;
          },
          "What draw_items() takes: all objects at their places in this call. No copies.");
}

void bind_morph(nb::module_& m) {
  nb::class_<PythonMorph>(m, "MorphedPositions",
                          "The positions at which the vertices of one object are drawn while some slide.")
      .def(
          "__init__",
          [](PythonMorph* self, const Hierarchy& h) {
            new (self) PythonMorph{h, MorphedPositions(h.positions())};
          },
          "hierarchy"_a, "Copies the positions of the hierarchy.")
      .def(
          "update",
          [](PythonMorph& self, const Result& result, std::size_t i) {
            if (result.placed(i).hierarchy.positions().data() != self.hierarchy.positions().data())
              throw nb::value_error("the object has another hierarchy");
            self.morphed.update(result.object(i).geomorphs);
          },
          "refinement"_a, "object"_a = 0, "Takes the geomorphs of a call of Refiner.update() in place of those before.")
      .def_prop_ro(
          "positions",
          [](nb::handle self) { return view_of(nb::cast<const PythonMorph&>(self).morphed.positions(), self); },
          "(n, 3) float32, object space. A read-only view, which update() changes.")
      .def_prop_ro(
          "moved",
          [](const PythonMorph& self) {
            const std::span<const VertexId> moved = self.morphed.moved();
            return array_of(std::vector<std::uint32_t>(moved.begin(), moved.end()));
          },
          nb::rv_policy::automatic, "(k,) uint32: vertices that the last update() may have moved, ascending. A copy.");
}

}  // namespace

KeptObjects::KeptObjects(std::vector<PlacedObject> objects) : objects_(std::move(objects)) {
  for (const PlacedObject& object : objects_)
    refine_objects_.push_back({&object.hierarchy, object.object_to_world, object.two_sided, object.attributes});
}

const RefinedObject& Result::object(std::size_t i) const {
  if (i >= now_->objects.size())
    throw nb::index_error(("there are " + std::to_string(now_->objects.size()) + " objects").c_str());
  return now_->objects[i];
}

RefineOptions to_options(const std::optional<RefineOptions>& options, std::optional<std::size_t> budget) {
  RefineOptions result = options.value_or(RefineOptions{});
  if (budget) result.budget = *budget;
  return result;
}

std::vector<PlacedObject> to_objects(nb::handle objects) {
  std::vector<PlacedObject> result;
  const auto add = [&](nb::handle item) {
    if (nb::isinstance<PlacedObject>(item)) {
      result.push_back(nb::cast<const PlacedObject&>(item));
    } else if (nb::isinstance<Hierarchy>(item)) {
      const auto& hierarchy = nb::cast<const Hierarchy&>(item);
      result.push_back({hierarchy, positions_to_world(glm::dmat4(1.0), hierarchy.data().origin), false, ""});
    } else {
      return false;
    }
    return true;
  };
  if (add(objects)) return result;
  for (const nb::handle item : nb::iter(objects))
    if (!add(item)) throw nb::type_error("objects: give an Object, a Hierarchy, or a sequence of them");
  return result;
}

void bind_refiner(nb::module_& m) {
  nb::class_<PlacedObject>(m, "Object", "A hierarchy at a place. Several may share a hierarchy.")
      .def(
          "__init__",
          [](PlacedObject* self, const Hierarchy& hierarchy, const std::optional<ArrayLike>& transform, bool two_sided,
             bool attributes) {
            const glm::dmat4 matrix = transform ? to_matrix(*transform, "transform")
                                                : positions_to_world(glm::dmat4(1.0), hierarchy.data().origin);
            new (self) PlacedObject{hierarchy, matrix, two_sided, "", attributes};
          },
          "hierarchy"_a, "transform"_a = nb::none(), nb::kw_only(), "two_sided"_a = false, "attributes"_a = true,
          "`transform`: (4, 4), positions to world, affine and invertible; multiplies columns from the left. None "
          "moves\n"
          "by the hierarchy's origin, so that world space is that of the file's coordinates.\n"
          "`attributes`: how far texture coordinates, normals and colours slip counts as an error too.")
      .def_prop_ro("hierarchy", [](const PlacedObject& o) { return o.hierarchy; })
      .def_prop_ro(
          "transform", [](const PlacedObject& o) { return from_matrix(o.object_to_world); },
          nb::sig("def transform(self) -> numpy.typing.NDArray[numpy.float64]"), "(4, 4) float64. A copy.")
      .def_ro("two_sided", &PlacedObject::two_sided, "Back faces are visible too.")
      .def_ro("attributes", &PlacedObject::attributes, "How far attributes slip counts as an error too.")
      .def_ro("source_name", &PlacedObject::source_name, "File or generator, of objects of a scene.");
  bind_stats(m);
  bind_result(m);
  bind_morph(m);

  const char* const refine_doc =
      "Refines from the base meshes. `budget` replaces that of `options`; without `visibility` the backend is\n"
      "\"software\". Error for options out of their range and a budget smaller than base_triangles.";
  nb::class_<PythonRefiner>(
      m, "Refiner",
      "Chooses the triangles of all objects for a view. Calls from several threads wait for each\n"
      "other.")
      .def(
          "__init__",
          [](PythonRefiner* self, nb::object objects) {
            new (self) PythonRefiner{std::make_shared<State>(to_objects(objects)), nullptr};
          },
          "objects"_a,
          nb::sig(
              "def __init__(self, objects: Object | Hierarchy | collections.abc.Iterable[Object | Hierarchy]) -> None"))
      .def_prop_ro(
          "base_triangles", [](const PythonRefiner& r) { return r.state->refiner.base_triangles(); },
          "Of all base meshes: the smallest budget that can be kept.")
      .def_prop_ro(
          "full_triangles", [](const PythonRefiner& r) { return r.state->refiner.full_triangles(); },
          "Of all objects with all splits applied.")
      .def("set_transform", &set_transform<PythonRefiner>, "object"_a, "transform"_a,
           "Places an object elsewhere, from the next call on.")
      .def("refine", &refine<Way::from_scratch>, "view"_a, "budget"_a = nb::none(), "visibility"_a = nb::none(),
           "options"_a = nb::none(), refine_doc)
      .def("update", &refine<Way::going_on>, "view"_a, "budget"_a = nb::none(), "visibility"_a = nb::none(),
           "options"_a = nb::none(), "Goes on from the mesh of the call before. Otherwise as refine().")
      .def(
          "visibility_ages",
          [](const PythonRefiner& r, std::size_t object) {
            if (object >= r.state->objects->objects().size()) throw nb::index_error("there is no such object");
            std::vector<std::uint32_t> ages;
            {
              const ReleasedGil release;
              const std::scoped_lock lock(r.state->in_use);
              ages = r.state->refiner.visibility_ages(object);
            }
            return array_of(std::move(ages));
          },
          "object"_a = 0,
          "(s,) uint32: for each of splits(object) of the last call, how many occluders ago an answer said that it is\n"
          "visible; NO_ID where none has.");
}

}  // namespace occlod::python
