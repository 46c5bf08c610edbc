// Hierarchical levels of detail: built, read, written, validated.
#include "occlod/hlod.h"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <filesystem>
#include <functional>
#include <optional>

#include "arrays.h"
#include "bindings.h"
#include "checks.h"
#include "materials.h"
#include "node_mesh.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/mesh_file.h"
#include "occlod/node_store.h"
#include "occlod/scene.h"
#include "text.h"

namespace occlod::python {
namespace {

using namespace nb::literals;
using hlod::Hlod;
using hlod::Node;
using hlod::NodeId;

NodeId checked(const Hlod& hlod, std::int64_t node) {
  if (node < 0 || static_cast<std::uint64_t>(node) >= hlod.node_count())
    throw nb::index_error(("there are " + std::to_string(hlod.node_count()) + " nodes").c_str());
  return static_cast<NodeId>(node);
}

std::pair<glm::vec3, glm::vec3> corners(const Box& box) { return {box.min, box.max}; }

void bind_nodes(nb::module_& m) {
  nb::class_<Node>(m, "HlodNode", "What is known of a node without its mesh. Object units. A copy.")
      .def_prop_ro(
          "box", [](const Node& n) { return corners(n.box); }, "Lower and upper corner of all it stands for.")
      .def_prop_ro(
          "lod_box", [](const Node& n) { return corners(n.lod_box); }, "Of the box and the children's lod_boxes.")
      .def_prop_ro(
          "sphere", [](const Node& n) { return std::pair(n.sphere.center, n.sphere.radius); },
          "Centre and radius; contains the box and the children's spheres.")
      .def_ro("error", &Node::error, "Of drawing this node instead of the input; 0 on level 0.")
      .def_ro("child_error", &Node::child_error, "The largest error of a child.")
      .def_ro("guaranteed_error", &Node::guaranteed_error, "No point of its triangles is farther from the input.")
      .def_ro("area", &Node::area, "Of its triangles.")
      .def_ro("triangles", &Node::triangles, "How many.")
      .def_ro("vertices", &Node::vertices, "How many.")
      .def_ro("level", &Node::level, "0: the input.")
      .def(
          "screen_error_px",
          [](const Node& n, glm::dvec3 eye, double focal_length_px, double min_distance) {
            return hlod::screen_error_px(n, {eye, focal_length_px, min_distance});
          },
          "eye"_a, "focal_length_px"_a, "min_distance"_a = 1e-30,
          "Pixels that the error covers at most, by the node's boxes; `eye` in object space.")
      .def(
          "sphere_error_px",
          [](const Node& n, glm::dvec3 eye, double focal_length_px, double min_distance) {
            return hlod::sphere_error_px(n, {eye, focal_length_px, min_distance});
          },
          "eye"_a, "focal_length_px"_a, "min_distance"_a = 1e-30, "The same by the node's sphere, as published.");
  nb::class_<PythonNodeMesh>(
      m, "HlodNodeMesh",
      "The mesh of one node. Read-only views of the HLOD, which keep it alive, or of copies where\n"
      "meshes come and go.")
      .def_prop_ro(
          "positions",
          [](nb::handle self) { return view_of(nb::cast<const PythonNodeMesh&>(self).mesh.positions, self); },
          "(n, 3) float32, object space.")
      .def_prop_ro(
          "normals",
          [](nb::handle self) -> std::optional<Array2<const float, 3>> {
            const auto normals = nb::cast<const PythonNodeMesh&>(self).mesh.normals;
            if (normals.empty()) return std::nullopt;
            return view_of(normals, self);
          },
          "(n, 3) float32 of unit length, or None.")
      .def_prop_ro(
          "colors",
          [](nb::handle self) -> std::optional<Array2<const std::uint8_t, 4>> {
            const auto colors = nb::cast<const PythonNodeMesh&>(self).mesh.colors;
            if (colors.empty()) return std::nullopt;
            return view_of(colors, self);
          },
          "(n, 4) uint8, or None.")
      .def_prop_ro(
          "texture_coordinates",
          [](nb::handle self) -> std::optional<Array2<const float, 2>> {
            const auto coordinates = nb::cast<const PythonNodeMesh&>(self).mesh.texture_coordinates;
            if (coordinates.empty()) return std::nullopt;
            return view_of(coordinates, self);
          },
          "(n, 2) float32, or None.")
      .def_prop_ro(
          "vertex_materials",
          [](nb::handle self) -> std::optional<Array1<const std::uint16_t>> {
            const auto materials = nb::cast<const PythonNodeMesh&>(self).mesh.materials;
            if (materials.empty()) return std::nullopt;
            return view_of(materials, self);
          },
          "(n,) uint16, into Hlod.materials, the same at all corners of a triangle; None: all have the first, if any.")
      .def_prop_ro(
          "image",
          [](const PythonNodeMesh& node) -> std::optional<nb::bytes> {
            const auto image = node.mesh.image;
            if (image.empty()) return std::nullopt;
            return nb::bytes(image.data(), image.size());
          },
          "An image of the node's own, PNG or JPEG, or None: what it shows of those of Hlod.materials with a mark in\n"
          "Hlod.image_materials, in the place of texture_coordinates by image_coordinates.")
      .def_prop_ro(
          "image_coordinates",
          [](nb::handle self) -> std::optional<Array2<const std::uint16_t, 2>> {
            const auto coordinates = nb::cast<const PythonNodeMesh&>(self).mesh.image_coordinates;
            if (coordinates.empty()) return std::nullopt;
            return view_of(coordinates, self);
          },
          "(n, 2) uint16, or None: places in `image`, 65,535 for its width and height, from the top left.")
      .def_prop_ro(
          "triangles",
          [](nb::handle self) {
            const auto indices = nb::cast<const PythonNodeMesh&>(self).mesh.indices;
            return rows_view<const std::uint16_t, 3>(indices.data(), indices.size() / 3, self);
          },
          "(m, 3) uint16, patch by patch.")
      .def_prop_ro(
          "merged_into",
          [](nb::handle self) { return view_of(nb::cast<const PythonNodeMesh&>(self).mesh.merged_into, self); },
          "(n,) uint16: the vertex of the parent's mesh that each slides to, or 0xffff.")
      .def(
          "mesh",
          [](const PythonNodeMesh& node) {
            TriangleMesh mesh = mesh_like(node.hlod.data());
            append_triangles(mesh, node.mesh, node.mesh.indices);
            return mesh;
          },
          "A Mesh of its own, with the materials of the HLOD.");
}

NodeId with_within(const Hlod& hlod, std::int64_t node) {
  const NodeId n = checked(hlod, node);
  if (!hlod.has_within(n))
    throw Error({"HLOD", "node " + std::to_string(n), "has no collapses of its own",
                 "ask has_within(); build with within=Within.splits"});
  hlod.require(n);
  hlod.require_within(n);
  return n;
}

Array2<float, 3> within_positions(const Hlod& hlod, std::int64_t node) {
  const NodeId n = with_within(hlod, node);
  std::vector<float> values;
  for (const auto positions : {hlod.mesh(n).positions, hlod.within(n).positions})
    for (const glm::vec3& p : positions) values.insert(values.end(), {p.x, p.y, p.z});
  return rows_array_of<float, 3>(std::move(values));
}

Array2<std::uint16_t, 3> within_cut(const Hlod& hlod, std::int64_t node, double max_error) {
  const NodeId n = with_within(hlod, node);
  if (!(max_error >= 0.0)) throw nb::value_error("max_error: an error is at least 0, in object units");
  return rows_array_of<std::uint16_t, 3>(hlod::within_cut(hlod, n, max_error).indices);
}

void bind_arrays(nb::class_<Hlod>& type) {
  type.def(
          "node", [](const Hlod& h, std::int64_t n) { return h.node(checked(h, n)); }, "node"_a)
      .def(
          "mesh", [](const Hlod& h, std::int64_t n) { return node_mesh(h, checked(h, n)); }, "node"_a,
          "Error when that part of a mapped file is damaged, or the mesh is not there: see open_hlod().")
      .def("within_positions", &within_positions, "node"_a,
           "(n, 3) float32: the vertices of mesh(node), then those that its collapses bring back. A copy. Error where\n"
           "the node has none, or a mapped file is damaged.")
      .def("within_cut", &within_cut, "node"_a, "max_error"_a,
           "(m, 3) uint16, ids into within_positions(node): the coarsest mesh of the node whose error is at most so\n"
           "large, object units; the finest if none is. O(triangles that the node was made from).")
      .def(
          "children",
          [](nb::handle self, std::int64_t n) {
            const Hlod& h = nb::cast<const Hlod&>(self);
            return view_of(h.children(checked(h, n)), self);
          },
          "node"_a, "(c,) uint32, ascending: the nodes that it replaces in part. A view.")
      .def(
          "patches",
          [](nb::handle self, std::int64_t n) {
            const Hlod& h = nb::cast<const Hlod&>(self);
            const auto patches = h.patches(checked(h, n));
            return rows_view<const std::uint32_t, 3>(patches.empty() ? nullptr : &patches[0].parent, patches.size(),
                                                     self);
          },
          "node"_a, "(p, 3) uint32: parent (NO_ID of a root), first index and number of indices. A view.")
      .def_prop_ro(
          "roots", [](nb::handle self) { return view_of(nb::cast<const Hlod&>(self).data().roots, self); },
          "(r,) uint32: nodes without a parent, ascending. A view.")
      .def_prop_ro(
          "levels",
          [](const Hlod& h) {
            std::vector<std::pair<std::uint32_t, std::uint32_t>> levels;
            for (const hlod::Level& level : h.data().levels) levels.emplace_back(level.first_node, level.node_count);
            return levels;
          },
          "First node and number of nodes of each level, from the input to the coarsest.");
}

// Of HLODs whose meshes come and go.
void bind_paging(nb::class_<Hlod>& type) {
  type.def_prop_ro(
          "is_paged", [](const Hlod& h) { return h.store() != nullptr; }, "Whether meshes come and go: open_hlod().")
      .def(
          "is_resident", [](const Hlod& h, std::int64_t n) { return h.is_resident(checked(h, n)); }, "node"_a,
          "Whether the mesh is there; always where meshes do not come and go.")
      .def(
          "missing",
          [](const Hlod& h) {
            return array_of<NodeId>(h.store() != nullptr ? h.store()->missing() : std::vector<NodeId>());
          },
          "(m,) uint32, ascending: nodes that the last frame waited for, which are being loaded.")
      .def_prop_ro(
          "resident_bytes", [](const Hlod& h) { return h.store() != nullptr ? h.store()->stats().resident_bytes : 0; },
          "Of meshes that are there; 0 where they do not come and go.")
      .def(
          "take_failures",
          [](const Hlod& h) { return h.store() != nullptr ? h.store()->take_failures() : std::vector<std::string>(); },
          "One line for each node whose mesh cannot be loaded, since the last call.");
}

void bind_hlod_class(nb::module_& m) {
  auto type = nb::class_<Hlod>(m, "Hlod",
                               "A mesh cut into nodes of some thousand triangles, level by level coarser. Immutable;\n"
                               "threads may share it.");
  type.def_prop_ro("node_count", &Hlod::node_count)
      .def_prop_ro("level_count", &Hlod::level_count)
      .def_prop_ro("bytes", &Hlod::bytes, "That the arrays occupy.")
      .def_prop_ro(
          "box", [](const Hlod& h) { return corners(h.data().box); }, "Of the input, relative to origin.")
      .def_prop_ro(
          "origin", [](const Hlod& h) { return h.data().origin; },
          "What positions are relative to: coordinates are origin + positions. See Mesh.origin.")
      .def_prop_ro("input_triangle_count", [](const Hlod& h) { return h.data().input_triangle_count; })
      .def_prop_ro("grouping", [](const Hlod& h) { return h.data().grouping; })
      .def_prop_ro("borders", [](const Hlod& h) { return h.data().borders; })
      .def_prop_ro("node_triangles", [](const Hlod& h) { return h.data().node_triangles; })
      .def_prop_ro(
          "lattice_step", [](const Hlod& h) { return h.data().lattice_step; },
          "All coordinates are multiples of it; 0: they are as the input's.")
      .def_prop_ro(
          "materials", [](const Hlod& h) { return tuple_of(h.data().materials); }, nb::sig(materials_sig),
          "That vertex_materials of nodes count.")
      .def_prop_ro(
          "textures", [](const Hlod& h) { return tuple_of(h.data().textures); }, nb::sig(textures_sig),
          "That materials count.")
      .def_prop_ro(
          "image_materials",
          [](nb::handle self) { return view_of(nb::cast<const Hlod&>(self).data().image_materials, self); },
          "(materials,) uint8: 1 where nodes show a material by images of their own. Empty where they have none.")
      .def_prop_ro(
          "texture_origin", [](const Hlod& h) { return h.data().texture_origin; }, "Of texture_coordinates of nodes.")
      .def_prop_ro(
          "up", [](const Hlod& h) { return h.data().up; }, "The axis that points up, as far as the input says.")
      .def(
          "write",
          [](const Hlod& h, const std::filesystem::path& path, const std::optional<MeshReport>& report,
             OlodCompression compression, const std::filesystem::path& images, bool node_images, int threads) {
            const ReleasedGil release;
            write_ohlod(path, h, report.value_or(MeshReport{}),
                        {.compression = compression,
                         .images = node_images ? OhlodImages::nodes : OhlodImages::named,
                         .image_folder = images,
                         .threads = threads});
          },
          "path"_a, nb::kw_only(), "report"_a = nb::none(), "compression"_a = OlodCompression::zstd, "images"_a = "",
          "node_images"_a = false, "threads"_a = 0,
          "As .ohlod; compressed node by node, by one thread for each core or so many. `images` is as in\n"
          "Hierarchy.write(). `node_images`: each node also gets an image of what it shows, as fine as its error\n"
          "needs, from the images in that folder.")
      .def(
          "has_within", [](const Hlod& h, std::int64_t n) { return h.has_within(checked(h, n)); }, "node"_a,
          "Whether the node has collapses of its own: Within.splits.")
      .def(
          "__copy__", [](nb::object self) { return self; }, nb::sig("def __copy__(self) -> Hlod"))
      .def(
          "__deepcopy__", [](nb::object self, nb::handle) { return self; }, "memo"_a,
          nb::sig("def __deepcopy__(self, memo: object) -> Hlod"))
      .def("__repr__", [](const Hlod& h) {
        return "<occlod.Hlod of " + std::to_string(h.node_count()) + " nodes on " + std::to_string(h.level_count()) +
               " levels, " + std::to_string(h.data().input_triangle_count) + " triangles in the input>";
      });
  bind_checks(type,
              {"Checks all of a mapped file. Error where it is damaged.", "random_fronts",
               "Whether level 0 is exactly the triangles of the mesh."},
              std::size_t{64});
  bind_arrays(type);
  bind_paging(type);
}

hlod::HlodBuildOptions options_of(std::uint32_t node_triangles, hlod::Grouping grouping, hlod::Borders borders,
                                  hlod::Within within, ErrorBound error_bound, int quantise_bits, int threads) {
  hlod::HlodBuildOptions options;
  options.node_triangles = node_triangles;
  options.grouping = grouping;
  options.borders = borders;
  options.within = within;
  options.error_bound = error_bound;
  options.quantise_bits = quantise_bits;
  options.threads = threads;
  return options;
}

// Calls `callable` with the path of a task. Holds no reference, as progress_of().
std::function<void(const std::filesystem::path&)> call_of(nb::handle callable) {
  return [callable](const std::filesystem::path& task) {
    const HeldGil gil;
    callable(task);
  };
}

// As `occlod hlod build` does; with a limit of memory the input is streamed.
void build_hlod_file(const std::filesystem::path& input, const std::filesystem::path& path,
                     const hlod::HlodBuildOptions& options, OlodCompression compression,
                     std::optional<std::size_t> memory) {
  const std::filesystem::path folder = input.parent_path();
  std::optional<MemoryLimit> limit;
  if (memory && options.within == hlod::Within::splits)
    throw Error({"build_hlod", "option memory", "goes with Within.geomorph only: splits of all nodes are in memory",
                 "leave one of them out"});
  if (memory) limit.emplace(*memory, path.parent_path());
  MeshReport report;
  Hlod built;
  if (memory) {
    built = build_hlod(stream_scene(describe_file(input), folder), options, report);
  } else {
    const CleanMesh mesh = is_scene_file(input) ? flatten_scene(read_scene(input), folder) : read_mesh(input);
    report = mesh.report;
    built = build_hlod(mesh.mesh, options, report);
  }
  write_ohlod(path, built, report, {.compression = compression, .image_folder = folder, .threads = options.threads});
}

void bind_building(nb::module_& m) {
  const hlod::HlodBuildOptions standard;
  m.def(
      "build_hlod",
      [](const TriangleMesh& mesh, std::uint32_t node_triangles, hlod::Grouping grouping, hlod::Borders borders,
         hlod::Within within, ErrorBound error_bound, int quantise_bits, int threads,
         const std::optional<std::filesystem::path>& journal, const std::optional<nb::callable>& progress) {
        hlod::HlodBuildOptions options =
            options_of(node_triangles, grouping, borders, within, error_bound, quantise_bits, threads);
        if (journal && journal->empty())
          throw nb::value_error("journal: names no file; give a path, or None for a build without a journal");
        options.journal = journal.value_or(std::filesystem::path());
        options.progress = progress_of(progress ? nb::handle(*progress) : nb::handle(Py_None));
        const ReleasedGil release;
        return hlod::build_hlod(mesh, options);
      },
      "mesh"_a, nb::kw_only(), "node_triangles"_a = standard.node_triangles, "grouping"_a = standard.grouping,
      "borders"_a = standard.borders, "within"_a = standard.within, "error_bound"_a = standard.error_bound,
      "quantise_bits"_a = standard.quantise_bits, "threads"_a = standard.threads, "journal"_a = nb::none(),
      "progress"_a = nb::none(),
      "Builds the HLOD of any triangle soup with welded vertices. The same bytes for any number of threads. "
      "`progress`\n"
      "is called with the share done; what it raises, and Ctrl-C, end the build. O(n log n).\n"
      "`error_bound`: how guaranteed errors are found; measured ones are several times smaller, for twice the time.\n"
      "`quantise_bits`: positions are rounded to a lattice of so many bits for the longest side of the box, in\n"
      "[8, 23]; 0: they stay as they are.\n"
      "`journal`: a file in which the build keeps what it has finished, 18 bytes for each triangle. A build of the\n"
      "same mesh with the same options goes on from there, to the same bytes; threads may differ. Remove it once the\n"
      "result is written. Error for a file that is no journal, that another build uses, or that does not fit.");
  m.def(
      "build_hlod_file",
      [](const std::filesystem::path& scene, const std::filesystem::path& path, const std::filesystem::path& parts,
         const std::filesystem::path& journal, const nb::callable& start, const nb::callable& finish,
         std::uint32_t node_triangles, hlod::Grouping grouping, hlod::Borders borders, hlod::Within within,
         ErrorBound error_bound, int quantise_bits, int threads, OlodCompression compression,
         std::optional<std::size_t> memory, const std::optional<nb::callable>& progress) {
        hlod::HlodBuildOptions options =
            options_of(node_triangles, grouping, borders, within, error_bound, quantise_bits, threads);
        options.journal = journal;
        options.parts = {parts, call_of(start), call_of(finish)};
        options.progress = progress_of(progress ? nb::handle(*progress) : nb::handle(Py_None));
        const ReleasedGil release;
        build_hlod_file(scene, path, options, compression, memory);
      },
      "scene"_a, "path"_a, nb::kw_only(), "parts"_a, "journal"_a, "start"_a, "finish"_a,
      "node_triangles"_a = standard.node_triangles, "grouping"_a = standard.grouping, "borders"_a = standard.borders,
      "within"_a = standard.within, "error_bound"_a = standard.error_bound, "quantise_bits"_a = standard.quantise_bits,
      "threads"_a = standard.threads, "compression"_a = OlodCompression::zstd, "memory"_a = nb::none(),
      "progress"_a = nb::none(), "See occlod.distributed.build_hlod().");
  m.def(
      "simplify_part",
      [](const std::filesystem::path& task, int threads) {
        const ReleasedGil release;
        hlod::simplify_part(task, threads);
      },
      "task"_a, nb::kw_only(), "threads"_a = standard.threads,
      "Simplifies the groups of a task and writes the result beside it, unless it is there.");
}

}  // namespace

void bind_hlod(nb::module_& m) {
  nb::enum_<hlod::Grouping>(m, "Grouping", "How triangles of one level are grouped into the nodes of the next.")
      .value("nested", hlod::Grouping::nested, "By one octree: every node has one parent.")
      .value("shifted", hlod::Grouping::shifted, "By an octree that is moved from level to level: no cracks.");
  nb::enum_<hlod::Borders>(m, "Borders", "What simplification does with vertices that several nodes share.")
      .value("free", hlod::Borders::free, "Each node moves its own copy: gaps as wide as the errors at most.")
      .value("locked", hlod::Borders::locked, "They stay until a node has them inside: no gaps.");
  nb::enum_<hlod::Within>(m, "Within", "What lies between a node and its parents.")
      .value("geomorph", hlod::Within::geomorph, "Vertices can slide to the parent's.")
      .value("splits", hlod::Within::splits, "Also every node's collapses, for twice the bytes.");
  bind_nodes(m);
  bind_hlod_class(m);
  bind_building(m);
  m.def(
      "read_hlod_and_report",
      [](const std::filesystem::path& path, OlodAccess access) {
        const ReleasedGil release;
        OhlodFile file = read_ohlod(path, access);
        return std::pair<Hlod, MeshReport>(std::move(file.hlod), file.report);
      },
      "path"_a, nb::kw_only(), "access"_a = OlodAccess::mapped, "Reads .ohlod: the HLOD and the report of its mesh.");
  const hlod::CacheOptions cache;
  m.def(
      "open_hlod",
      [](const std::filesystem::path& path, std::size_t memory, bool blocking) {
        const ReleasedGil release;
        return open_ohlod(path, {memory, blocking ? hlod::LoadMode::blocking : hlod::LoadMode::async}).hlod;
      },
      "path"_a, nb::kw_only(), "memory"_a = cache.budget_bytes, "blocking"_a = false,
      "Opens .ohlod without its meshes: they come when a Traverser or a Selector needs them, and go when others need\n"
      "the room, `memory` bytes at most. Until they come coarser ones are drawn, or with `blocking` frames wait for\n"
      "them. Splits within nodes are left out. Error where the coarsest nodes are damaged or do not fit.");
}

}  // namespace occlod::python
