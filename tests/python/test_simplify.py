"""simplify(): each type that it takes gives the same type back, and what is not kept is named."""
import os
import pathlib
import subprocess
import tempfile
import unittest
import warnings

import numpy
import occlod
from occlod._occlod import nearest_points
from packages import open3d, pyvista, trimesh
from support import box_of_charts, corners


def soup(mesh):
    """Three vertices of its own for each triangle, as in STL."""
    return occlod.Mesh(mesh.positions[mesh.triangles].reshape(-1, 3), numpy.arange(3 * mesh.triangle_count).reshape(-1, 3))


def side_of(normals):
    """0 to 5: the side of the cube that faces that way."""
    axis = numpy.abs(normals).argmax(axis=1)
    return 2 * axis + (numpy.take_along_axis(normals, axis[:, None], 1)[:, 0] < 0)


SIDES = numpy.array([(40 * side, 255 - 40 * side, 100, 255) for side in range(6)], numpy.uint8)


def normals_of(positions, triangles):
    a, b, c = numpy.moveaxis(numpy.asarray(positions)[numpy.asarray(triangles)], 1, 0)
    return numpy.cross(b - a, c - a)


class SimplifyTest(unittest.TestCase):
    def silently(self, *arguments, **keywords):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return occlod.simplify(*arguments, **keywords)

    def assert_sides(self, positions, triangles, colors):
        """The colour of each triangle is that of its side of the cube: sides are flat, so that no vertex need leave one."""
        numpy.testing.assert_array_equal(colors, SIDES[side_of(normals_of(positions, triangles))])


class Goals(SimplifyTest):
    def setUp(self):
        self.mesh = occlod.generate("rough-planet", level=4)  # 2,048 triangles

    def test_are_met(self):
        self.assertLessEqual(self.silently(self.mesh, triangles=300).triangle_count, 300)
        self.assertLessEqual(self.silently(self.mesh, ratio=0.1).triangle_count, 204)
        self.assertGreater(self.silently(self.mesh, ratio=0.1).triangle_count, 180)
        self.assertEqual(self.silently(self.mesh, ratio=1).triangle_count, 2048)

    def test_something_is_left(self):
        self.assertEqual(self.silently(self.mesh, ratio=0.0001).triangle_count, 4)
        for thing in (self.mesh, (self.mesh.positions, self.mesh.triangles)):
            with self.assertRaisesRegex(occlod.Error, "^mesh: has nothing left with at most 1 of its 2048 triangles; allow more"):
                occlod.simplify(thing, triangles=1)

    def test_error_is_the_distance(self):
        # A level of the generator without roughness: every vertex on the unit sphere, every edge chord below 0.1.
        smooth = occlod.generate("rough-planet", level=5, amplitude=0)
        coarse = self.silently(smooth, error=0.02)
        self.assertLess(coarse.triangle_count, smooth.triangle_count / 10)
        middles = coarse.positions[coarse.triangles].mean(axis=1)
        for places in (coarse.positions, middles):
            self.assertLess(abs(numpy.linalg.norm(places, axis=1) - 1).max(), 0.02 + 0.002)
        self.assertLess(self.silently(smooth, error=0.05).triangle_count, coarse.triangle_count)

    def test_refit_moves_vertices(self):
        known = {tuple(p) for p in self.mesh.positions.tolist()}
        stay, move = (self.silently(self.mesh, ratio=0.1, refit=refit).positions.tolist() for refit in (False, True))
        self.assertTrue(all(tuple(p) in known for p in stay))
        self.assertFalse(all(tuple(p) in known for p in move))

    def test_threads_do_not_matter(self):
        one, many = (self.silently(self.mesh, ratio=0.1, threads=threads) for threads in (1, 4))
        numpy.testing.assert_array_equal(one.positions, many.positions)
        numpy.testing.assert_array_equal(one.triangles, many.triangles)

    def test_mistakes_are_told(self):
        for kind, text, goal in [(TypeError, "give one of triangles, ratio and error", {}), (TypeError, "give one of", {"ratio": 0.1, "error": 1}),
                                 (ValueError, "triangles: is 0; give a whole number above 0", {"triangles": 0}),
                                 (TypeError, "triangles: is a float; give a whole number", {"triangles": 0.5}),
                                 (ValueError, "ratio: is 1.5; give a number above 0 and at most 1", {"ratio": 1.5}),
                                 (ValueError, "ratio: is nan; give", {"ratio": float("nan")}), (ValueError, "error: is 0; give a length above 0", {"error": 0}),
                                 (TypeError, "error: is a str; give a length", {"error": "5mm"})]:
            with self.subTest(text), self.assertRaisesRegex(kind, f"^simplify: {text}"):
                occlod.simplify(self.mesh, **goal)
        for thing, name in (([1, 2], "a list"), (None, "a NoneType"), (7, "an int"), (occlod.build_hierarchy(self.mesh), "a Hierarchy")):
            with self.subTest(name), self.assertRaisesRegex(TypeError, f"^simplify: {name} is no mesh; give a path, an occlod.Mesh, a pair"):
                occlod.simplify(thing, ratio=0.1)
        with self.assertRaisesRegex(TypeError, "triangles: wrong shape"):
            occlod.simplify((self.mesh.positions, self.mesh.triangles[:, :2]), ratio=0.1)
        self.mesh.triangles[3, 1] = 9999
        with self.assertRaisesRegex(occlod.Error, "triangle 3"):
            occlod.simplify(self.mesh, ratio=0.1)

    def test_progress_ends_with_all(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.ply")
            self.mesh.write(path)
            for thing in (self.mesh, path):
                for goal in ({"ratio": 0.1}, {"ratio": 1}, {"error": 0.05}):
                    told = []
                    occlod.simplify(thing, **goal, progress=told.append)
                    self.assertEqual((told, told[-1]), (sorted(told), 1.0))
        with self.assertRaises(ZeroDivisionError):
            occlod.simplify(self.mesh, ratio=0.1, progress=lambda done: 1 / 0)


class Ours(SimplifyTest):
    def test_meshes_are_welded(self):
        mesh = occlod.generate("rough-planet", level=4)
        expected = self.silently(mesh, ratio=0.1)
        result = self.silently(soup(mesh), ratio=0.1)
        self.assertEqual(result.report().boundary_edges, 0)
        self.assertEqual(result.triangle_count, expected.triangle_count)

    def test_meshes_keep_what_they_have(self):
        mesh = box_of_charts()
        result = self.silently(mesh, triangles=60)
        self.assertLessEqual(result.triangle_count, 60)
        self.assertEqual((result.materials, result.textures), (mesh.materials, mesh.textures))
        side = side_of(normals_of(result.positions, result.triangles))
        numpy.testing.assert_array_equal(result.triangle_materials, side % 2)
        for corner in range(3):
            numpy.testing.assert_array_equal(result.colors[result.wedge_triangles[:, corner]], SIDES[side])
        u = result.texture_coordinates[result.wedge_triangles][:, :, 0]
        self.assertTrue(((u >= 2 * side[:, None]) & (u <= 2 * side[:, None] + 1)).all())

    def test_pairs_keep_their_types(self):
        mesh = occlod.generate("rough-planet", level=4)
        expected = self.silently(mesh, ratio=0.1)
        for floats, integers in (("f4", "i4"), ("f8", "i8"), ("f8", "u4")):
            positions, triangles = self.silently((mesh.positions.astype(floats), mesh.triangles.astype(integers)), ratio=0.1)
            self.assertEqual((positions.dtype, triangles.dtype), (numpy.dtype(floats), numpy.dtype(integers)))
            self.assertEqual(corners(positions, triangles), corners(expected.positions, expected.triangles))
        # A town in metres of a map: floats have steps of half a metre there.
        far = numpy.array((691_000.0, 5_335_000.0, 500.0))
        positions, triangles = self.silently((mesh.positions.astype("f8") + far, mesh.triangles), ratio=0.1)
        self.assertEqual(positions.dtype, numpy.float64)
        self.assertLess(abs(numpy.linalg.norm(positions - far, axis=1) - 1).max(), 0.3)

    def test_files_are_read(self):
        mesh = occlod.generate("rough-planet", level=4)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.obj")
            mesh.write(path)
            results = [self.silently(name, ratio=0.1) for name in (path, str(path), os.fsencode(path))]
            with path.open("a", encoding="ascii") as file:
                file.write("l 1 2\n")
            with self.assertWarnsRegex(UserWarning, r"^simplify: leaves out lines \(l\) \(1\)$") as caught:
                results.append(occlod.simplify(path, ratio=0.1))
            self.assertEqual(caught.filename, __file__)
            with self.assertRaisesRegex(occlod.Error, "missing.ply"):
                occlod.simplify(path.with_name("missing.ply"), ratio=0.1)
        for result in results:
            self.assertIsInstance(result, occlod.Mesh)
            self.assertEqual(corners(result.positions, result.triangles), corners(results[0].positions, results[0].triangles))

    def test_the_command_line_gives_the_same(self):
        if "OCCLOD" not in os.environ:
            self.skipTest("SKIPPED: OCCLOD does not name the command line")
        with tempfile.TemporaryDirectory() as folder:
            path, made = pathlib.Path(folder, "a.ply"), pathlib.Path(folder, "b.ply")
            occlod.generate("rough-planet", level=4).write(path)
            subprocess.run([os.environ["OCCLOD"], "simplify", path, "-o", made, "--ratio", "10%"], check=True, stdout=subprocess.PIPE)
            expected, result = occlod.read_mesh(made), occlod.simplify(path, ratio=0.1)
        self.assertEqual(corners(result.positions, result.triangles), corners(expected.positions, expected.triangles))


class Nearest(unittest.TestCase):
    def test_points_are_those_of_all(self):
        random = numpy.random.default_rng(1)
        points = numpy.concatenate([random.normal(size=(500, 3)), numpy.repeat(random.normal(size=(5, 3)), 20, axis=0)])
        queries = numpy.concatenate([random.normal(size=(300, 3)) * 2, points[::50]])
        squares = ((queries[:, None] - points) ** 2).sum(axis=2)
        found = nearest_points(queries, points)
        numpy.testing.assert_array_equal(squares[numpy.arange(len(queries)), found], squares.min(axis=1))
        self.assertEqual(len(nearest_points(numpy.empty((0, 3)), points)), 0)
        for asked, known, text in ((queries, points[:0], "points: are none"), (queries, points * numpy.nan, "points: are not all finite")):
            with self.assertRaisesRegex(ValueError, text):
                nearest_points(asked, known)


@unittest.skipIf(trimesh is None, "SKIPPED: trimesh is not installed")
class Trimesh(SimplifyTest):
    def setUp(self):
        self.box = trimesh.creation.box(extents=(2, 2, 2))
        for _ in range(3):
            self.box = self.box.subdivide()
        self.box.metadata["name"] = "box"

    def test_shapes(self):
        result = self.silently(self.box, triangles=100)
        self.assertIs(type(result), trimesh.Trimesh)
        self.assertLessEqual(len(result.faces), 100)
        self.assertTrue(result.is_watertight)
        self.assertAlmostEqual(result.volume, 8, places=5)
        self.assertEqual(result.metadata["name"], "box")
        self.assertIsNone(result.visual.kind)

    def test_face_colors(self):
        self.box.visual.face_colors = SIDES[side_of(self.box.face_normals)]
        result = self.silently(self.box, triangles=100)
        self.assertEqual(result.visual.kind, "face")
        self.assertTrue(result.is_watertight)
        self.assert_sides(result.vertices, result.faces, result.visual.face_colors)

    def test_vertex_colors_and_attributes(self):
        ball = trimesh.creation.icosphere(subdivisions=4)
        ball.visual.vertex_colors = numpy.where(ball.vertices[:, 2:] > 0, [[255, 0, 0, 255]], [[0, 0, 255, 128]]).astype(numpy.uint8)
        ball.vertex_attributes["height"] = ball.vertices[:, 2].copy()
        ball.face_attributes["area"] = ball.area_faces
        with self.assertWarnsRegex(UserWarning, '^simplify: leaves out face attribute "area"$'):
            result = occlod.simplify(ball, ratio=0.1)
        self.assertEqual(result.visual.kind, "vertex")
        clear = abs(result.vertices[:, 2]) > 0.2
        numpy.testing.assert_array_equal(result.visual.vertex_colors[clear, 3] == 255, result.vertices[clear, 2] > 0)
        # The nearest vertex of the input is within half an edge, 0.07 / sqrt(3) at most.
        self.assertLess(abs(result.vertex_attributes["height"] - result.vertices[:, 2]).max(), 0.05)

    def test_textures(self):
        steps = numpy.linspace(0, 1, 17)
        u, v = (grid.ravel() for grid in numpy.meshgrid(steps, steps))
        corner = (17 * numpy.arange(16)[:, None] + numpy.arange(16)).ravel()
        faces = numpy.vstack([numpy.stack([corner, corner + 1, corner + 18], axis=1), numpy.stack([corner, corner + 18, corner + 17], axis=1)])
        material = trimesh.visual.material.PBRMaterial(name="paper", baseColorFactor=(255, 0, 0, 255), roughnessFactor=0.25)
        flat = trimesh.Trimesh(numpy.stack([u, v, 0 * u], axis=1), faces, process=False,
                               visual=trimesh.visual.TextureVisuals(uv=numpy.stack([u, 1 - v], axis=1), material=material))
        result = self.silently(flat, triangles=10)
        self.assertLessEqual(len(result.faces), 10)
        numpy.testing.assert_allclose(result.visual.uv, result.vertices[:, :2] * (1, -1) + (0, 1), atol=1e-6)
        self.assertEqual((result.visual.material.name, result.visual.material.roughnessFactor), ("paper", 0.25))

    def test_scenes(self):
        scene = trimesh.Scene(metadata={"town": "here"})
        place = trimesh.transformations.translation_matrix((5, 0, 0))
        scene.add_geometry(self.box, geom_name="box", node_name="near")
        scene.graph.update(frame_to="far", matrix=place, geometry="box")
        scene.add_geometry(trimesh.creation.icosphere(subdivisions=3), geom_name="ball", node_name="ball")  # 1,280 faces; the box has 768
        told = []
        result = self.silently(scene, triangles=256, progress=told.append)
        self.assertIs(type(result), trimesh.Scene)
        self.assertEqual((told, told[-1]), (sorted(told), 1.0))
        self.assertEqual(set(result.geometry), {"box", "ball"})
        self.assertEqual(set(result.graph.nodes_geometry), {"near", "far", "ball"})
        numpy.testing.assert_array_equal(result.graph.get("far")[0], place)
        self.assertEqual(result.metadata["town"], "here")
        sizes = {name: len(mesh.faces) for name, mesh in result.geometry.items()}
        self.assertLessEqual(sizes["box"], 97)  # 4 + 248 * 768 // 2048
        self.assertLessEqual(sizes["ball"], 159)
        self.assertGreater(sizes["ball"], 140)
        self.assertEqual(len(scene.geometry["box"].faces), 768, "the input stays as it was")
        with self.assertRaisesRegex(ValueError, "triangles: is 7; give at least 8, 4 for each mesh of the scene"):
            occlod.simplify(scene, triangles=7)

    def test_small_meshes_of_scenes_stay(self):
        scene = trimesh.Scene({"box": trimesh.creation.box(), "ball": trimesh.creation.icosphere(subdivisions=4)})
        for goal in ({"ratio": 0.01}, {"triangles": 60}):
            result = self.silently(scene, **goal)
            self.assertEqual(len(result.geometry["box"].faces), 4)
            self.assertTrue(result.geometry["box"].is_watertight)
            self.assertGreater(len(result.geometry["ball"].faces), 40)

    def test_nothing_is_an_error(self):
        for nothing in (trimesh.Trimesh(), trimesh.Trimesh(numpy.eye(3), numpy.empty(0, int)), trimesh.Scene()):
            with self.assertRaisesRegex(occlod.Error, "no triangle"):
                occlod.simplify(nothing, ratio=0.5)

    def test_errors_are_those_of_the_scene(self):
        ball = trimesh.creation.icosphere(subdivisions=4)
        scene = trimesh.Scene()
        scene.add_geometry(ball, geom_name="ball", transform=numpy.diag((1000.0, 1000.0, 1000.0, 1.0)))
        result = self.silently(scene, error=20)
        self.assertEqual(len(result.geometry["ball"].faces), len(self.silently(ball, error=0.02).faces))

    def test_what_is_left_out_of_scenes_is_named(self):
        self.box.face_attributes["part"] = numpy.zeros(len(self.box.faces))
        with self.assertWarnsRegex(UserWarning, '^simplify: leaves out face attribute "part" of "box"$'):
            occlod.simplify(trimesh.Scene({"box": self.box}), ratio=0.1)


@unittest.skipIf(pyvista is None, "SKIPPED: PyVista is not installed")
class PyVista(SimplifyTest):
    def test_surfaces(self):
        ball = pyvista.Sphere(theta_resolution=60, phi_resolution=60)
        ball.point_data["height"] = ball.points[:, 2]
        ball.point_data["tint"] = numpy.full((ball.n_points, 3), (7, 8, 9), numpy.uint8)
        ball.point_data["flow"] = ball.points * 2
        ball.field_data["author"] = ["nobody"]
        ball.set_active_scalars("height")
        result = self.silently(ball, ratio=0.1)
        self.assertIs(type(result), pyvista.PolyData)
        self.assertLessEqual(result.n_cells, ball.n_cells // 10)
        self.assertTrue(result.is_manifold)
        self.assertEqual(set(result.point_data), {"Normals", "height", "tint", "flow"})
        self.assertEqual((result.active_scalars_name, result.point_data.active_normals_name), ("height", "Normals"))
        numpy.testing.assert_array_equal(result.point_data["tint"], numpy.broadcast_to((7, 8, 9), (result.n_points, 3)))
        self.assertLess(abs(result.point_data["height"] - result.points[:, 2]).max(), 0.03)  # edges of the input are 0.05 long
        self.assertLess(abs(result.point_data["flow"] - 2 * result.points).max(), 0.06)
        self.assertEqual(list(result.field_data["author"]), ["nobody"])

    def test_texture_coordinates(self):
        plane = pyvista.Plane(i_resolution=16, j_resolution=16)
        result = self.silently(plane, triangles=10)
        self.assertLessEqual(result.n_cells, 10)
        numpy.testing.assert_allclose(result.active_texture_coordinates, result.points[:, :2] + 0.5, atol=1e-6)

    def test_other_datasets(self):
        image = pyvista.ImageData(dimensions=(9, 9, 9))
        image.point_data["x"] = image.points[:, 0]
        for dataset in (image, image.cast_to_structured_grid(), image.cast_to_unstructured_grid()):
            result = self.silently(dataset, triangles=50)
            self.assertIs(type(result), pyvista.PolyData)
            self.assertAlmostEqual(result.volume, 512, places=2)
            self.assertEqual(list(result.point_data), ["x"])
            numpy.testing.assert_allclose(result.point_data["x"], result.points[:, 0], atol=1)

    def test_what_is_left_out_is_named(self):
        ball = pyvista.Sphere()
        ball.cell_data["part"], ball.cell_data["size"] = numpy.zeros(ball.n_cells), numpy.ones(ball.n_cells)
        both = ball.append_polydata(pyvista.Line()) if hasattr(ball, "append_polydata") else ball + pyvista.Line()
        self.assertEqual(both.n_lines, 1)
        both.cell_data["part"], both.cell_data["size"] = numpy.zeros(both.n_cells), numpy.ones(both.n_cells)
        with self.assertWarnsRegex(UserWarning, r'^simplify: leaves out lines \(1\), cell data "part", "size"$'):
            occlod.simplify(both, ratio=0.1)

    def test_what_has_no_surface_is_told(self):
        with self.assertRaisesRegex(occlod.Error, r"^PolyData: has lines \(1\) and no faces; give a dataset with a surface$"):
            occlod.simplify(pyvista.Line(), ratio=0.1)
        with self.assertRaisesRegex(occlod.Error, r"has vertex cells \(3\) and no faces"):
            occlod.simplify(pyvista.PolyData(numpy.eye(3)), ratio=0.1)
        with self.assertRaisesRegex(TypeError, r"combine\(\)"):
            occlod.simplify(pyvista.MultiBlock([pyvista.Sphere()]), ratio=0.1)


@unittest.skipIf(open3d is None, "SKIPPED: Open3D is not installed")
class Open3D(SimplifyTest):
    def ball(self):
        ball = open3d.geometry.TriangleMesh.create_sphere(resolution=40, create_uv_map=True)
        ball.compute_vertex_normals()
        ball.vertex_colors = open3d.utility.Vector3dVector(numpy.tile((0.2, 0.4, 0.6), (len(ball.vertices), 1)))
        return ball

    def test_older_meshes(self):
        ball = self.ball()
        lower = numpy.asarray(ball.triangle_uvs).reshape(-1, 3, 2)[:, :, 0].mean(axis=1) > 0.5
        ball.triangle_material_ids = open3d.utility.IntVector(numpy.where(lower, 3, 0).astype(numpy.int32))
        ball.textures = [open3d.geometry.Image(numpy.full((4, 4, 3), 9, numpy.uint8))]
        result = self.silently(ball, ratio=0.1)
        self.assertIs(type(result), open3d.geometry.TriangleMesh)
        self.assertLessEqual(len(result.triangles), len(ball.triangles) // 10)
        self.assertTrue(result.is_watertight(), "texture coordinates belong to corners")
        numpy.testing.assert_allclose(numpy.asarray(result.vertex_colors), numpy.tile((0.2, 0.4, 0.6), (len(result.vertices), 1)))
        numpy.testing.assert_allclose(numpy.asarray(result.vertex_normals), numpy.asarray(result.vertices), atol=0.1)
        # u runs from the upper pole to the lower one; the material changes at the equator.
        uv = numpy.asarray(result.triangle_uvs).reshape(-1, 3, 2)
        z = numpy.asarray(result.vertices)[numpy.asarray(result.triangles)][:, :, 2]
        numpy.testing.assert_allclose(uv[:, :, 0], 0.5 - numpy.arcsin(numpy.clip(z, -1, 1)) / numpy.pi, atol=0.05)
        self.assertEqual(len(result.textures), 1)
        ids = numpy.asarray(result.triangle_material_ids)
        self.assertEqual(set(ids.tolist()), {0, 3})
        numpy.testing.assert_array_equal(ids == 3, uv[:, :, 0].mean(axis=1) > 0.5)
        self.assertTrue(result.has_triangle_normals())

    def test_newer_meshes(self):
        old = self.ball()
        ball = open3d.t.geometry.TriangleMesh.from_legacy(old)
        ball.vertex["height"] = ball.vertex.positions[:, 2:3]
        ball.triangle["weight"] = open3d.core.Tensor(numpy.ones(len(old.triangles), numpy.float32))
        ball.material.material_name = "defaultLit"
        ball.material.scalar_properties["roughness"] = 0.25
        with self.assertWarnsRegex(UserWarning, '^simplify: leaves out triangle attribute "weight"$'):
            result = occlod.simplify(ball, ratio=0.1)
        self.assertIs(type(result), open3d.t.geometry.TriangleMesh)
        self.assertLessEqual(len(result.triangle.indices), len(ball.triangle.indices) // 10)
        for group, left in (("vertex", set()), ("triangle", {"weight"})):
            before, after = getattr(ball, group), getattr(result, group)
            self.assertEqual(set(after), set(before) - left)
            for name in after:
                self.assertEqual((after[name].dtype, after[name].shape[1:]), (before[name].dtype, before[name].shape[1:]), name)
        self.assertEqual((result.material.material_name, result.material.scalar_properties["roughness"]), ("defaultLit", 0.25))
        positions = result.vertex.positions.numpy()
        numpy.testing.assert_allclose(result.vertex.colors.numpy(), numpy.tile((0.2, 0.4, 0.6), (len(positions), 1)), atol=1e-6)
        self.assertLess(abs(result.vertex["height"].numpy()[:, 0] - positions[:, 2]).max(), 0.06)
        self.assertTrue(result.to_legacy().is_watertight())

    def test_nothing_is_an_error(self):
        for nothing in (open3d.geometry.TriangleMesh(), open3d.t.geometry.TriangleMesh()):
            with self.assertRaisesRegex(occlod.Error, "no triangle"):
                occlod.simplify(nothing, ratio=0.5)

    def test_triangle_colors_of_newer_meshes(self):
        box = plain_box()
        mesh = open3d.t.geometry.TriangleMesh(open3d.core.Tensor(box[0]), open3d.core.Tensor(box[1]))
        mesh.triangle["colors"] = open3d.core.Tensor(SIDES[side_of(normals_of(*box))][:, :3].astype(numpy.float32) / 255)
        result = self.silently(mesh, triangles=100)
        colors = numpy.rint(result.triangle["colors"].numpy() * 255).astype(numpy.uint8)
        positions, triangles = result.vertex.positions.numpy(), result.triangle.indices.numpy()
        self.assert_sides(positions, triangles, numpy.hstack([colors, numpy.full((len(colors), 1), 255, numpy.uint8)]))


def plain_box():
    """The cube of box_of_charts() without its charts."""
    mesh = box_of_charts().clean()[0]
    return mesh.positions[: mesh.vertex_count].copy(), mesh.triangles.astype(numpy.int64)


if __name__ == "__main__":
    unittest.main()
