"""Meshes: arrays in and out, files, reports, errors."""
import gc
import os
import pathlib
import pickle
import tempfile
import unittest

import numpy
import occlod
from support import box_of_charts, corners, looks, tetrahedron


class Generators(unittest.TestCase):
    def test_have_defaults_that_they_accept(self):
        names = [generator.name for generator in occlod.generators()]
        self.assertIn("rough-planet", names)
        for generator in occlod.generators():
            self.assertIn(generator.about, occlod.generate.__doc__)
            for parameter in generator.parameters:
                self.assertTrue(parameter.accepts(parameter.default_value), (generator.name, parameter.name))
                self.assertFalse(parameter.accepts(parameter.min - 1))

    def test_are_called_by_name(self):
        self.assertEqual(len(occlod.generate("rough-planet", level=2).triangles), 8 * 4**2)
        smooth, rough = (occlod.generate("rough-planet", level=2, amplitude=amplitude).positions for amplitude in (0, 0.5))
        numpy.testing.assert_allclose(numpy.linalg.norm(smooth, axis=1), 1, rtol=1e-6)
        self.assertGreater(numpy.ptp(numpy.linalg.norm(rough, axis=1)), 0.1)

    def test_say_what_they_take(self):
        for name, values, told in (("village", {}, "use one of: rough-planet, city"), ("city", {"level": 1}, "use one of: blocks, facade_cells, seed"),
                                   ("city", {"blocks": 0}, "choose a whole number from 1 to 256"), ("city", {"seed": 2**53 + 1}, "from 0 to 9007199254740991")):
            with self.subTest(name, **values), self.assertRaisesRegex(occlod.Error, told):
                occlod.generate(name, **values)
        with self.assertRaisesRegex(TypeError, "blocks is not a number"):
            occlod.generate("city", blocks="x")


class Arrays(unittest.TestCase):
    def test_are_copied_in_whatever_their_type(self):
        positions, triangles = tetrahedron()
        for p, t in [(positions, triangles), (positions.astype("f8"), triangles.astype("i8")), (positions.tolist(), triangles.tolist()),
                     (numpy.asfortranarray(positions), triangles[::-1][::-1])]:
            mesh = occlod.Mesh(p, t)
            numpy.testing.assert_array_equal(mesh.positions, positions)
            numpy.testing.assert_array_equal(mesh.triangles, triangles)
        self.assertEqual((mesh.positions.dtype, mesh.triangles.dtype), (numpy.float32, numpy.uint32))
        self.assertIsNone(mesh.normals)
        self.assertIsNone(mesh.colors)

    def test_out_are_writable_views(self):
        mesh = occlod.Mesh(*tetrahedron(), normals=numpy.ones((4, 3)), colors=numpy.full((4, 4), 7, numpy.uint8))
        for name in ("positions", "triangles", "normals", "colors"):
            array = getattr(mesh, name)
            self.assertFalse(array.flags.owndata, name)
            array[1] = 3
            self.assertTrue((getattr(mesh, name)[1] == 3).all(), name)
            self.assertTrue(numpy.shares_memory(array, getattr(mesh, name)), name)

    def test_views_keep_the_mesh_alive(self):
        positions = occlod.generate("rough-planet", level=5).positions
        before = positions.copy()
        gc.collect()
        junk = [numpy.full_like(before, 9) for _ in range(10)]  # would take the memory if it were free
        numpy.testing.assert_array_equal(positions, before)
        del junk

    def test_empty_is_filled_in_place(self):
        positions, triangles = tetrahedron()
        mesh = occlod.Mesh.empty(4, 4, colors=True)
        mesh.positions[:], mesh.triangles[:] = positions, triangles
        self.assertEqual(occlod.build_hierarchy(mesh, base_triangles=4).input_triangle_count, 4)
        self.assertIsNone(mesh.normals)
        self.assertTrue((mesh.colors == 255).all())

    def test_wrong_shapes_and_types_are_told(self):
        positions, triangles = tetrahedron()
        for p, t, name in [(positions[:, :2], triangles, "positions"), (positions.ravel(), triangles, "positions"),
                           (positions, triangles.astype("f4"), "triangles"), (positions, triangles[:, :2], "triangles"),
                           (numpy.array([["a", "b", "c"]]), triangles, "positions")]:
            with self.assertRaisesRegex(TypeError, name):
                occlod.Mesh(p, t)
        with self.assertRaisesRegex(TypeError, "colors"):
            occlod.Mesh(positions, triangles, colors=numpy.ones((4, 4)))

    def test_ids_that_do_not_fit_are_told(self):
        positions, triangles = tetrahedron()
        for bad in (-1, 2**32):
            with self.assertRaisesRegex(ValueError, "triangles"):
                occlod.Mesh(positions, numpy.where(triangles == 3, bad, triangles.astype("i8")))
        with self.assertRaisesRegex(occlod.Error, "mesh: triangle 1: uses vertex 4 of 4; vertices are counted from 0"):
            occlod.Mesh(positions, [[0, 1, 2], [0, 4, 1]])
        with self.assertRaisesRegex(occlod.Error, "normals"):
            occlod.Mesh(positions, triangles, normals=[[0, 0, 1]])


class Wedges(unittest.TestCase):
    def setUp(self):
        self.read = box_of_charts()
        self.mesh, self.report = self.read.clean()

    def test_come_from_vertices_of_their_own(self):
        # 6 sides of 9 x 9 vertices. A corner of the cube has 3 sides, one of the 7 others on each of its 12 edges has 2.
        mesh = self.mesh
        self.assertEqual((mesh.wedge_count, mesh.vertex_count), (6 * 81, 6 * 81 - 2 * 8 - 12 * 7))
        self.assertEqual(self.report.seam_vertices, 8 + 12 * 7)
        self.assertEqual(len(mesh.extra_wedges), mesh.wedge_count - mesh.vertex_count)
        numpy.testing.assert_array_equal(mesh.positions[mesh.vertex_count:], mesh.positions[mesh.extra_wedges])
        vertex = numpy.concatenate([numpy.arange(mesh.vertex_count), mesh.extra_wedges])
        numpy.testing.assert_array_equal(vertex[mesh.corners], mesh.triangles)
        self.assertTrue(numpy.shares_memory(mesh.wedge_triangles, mesh.corners))
        self.assertEqual(looks(mesh), looks(self.read))
        self.assertIsNone(self.read.corners)
        self.assertTrue(numpy.shares_memory(self.read.wedge_triangles, self.read.triangles))

    def test_features(self):
        """They go in, through a pickle, and to the tables of tiles."""
        mesh, names = self.mesh, ["upper", "lower \u00df"]
        features = (mesh.positions[mesh.triangles][:, :, 2].mean(axis=1) < mesh.positions[:, 2].mean()).astype(int)
        parted = occlod.Mesh(mesh.positions[:mesh.vertex_count], mesh.triangles, triangle_features=features, feature_names=names)
        for one in (parted, pickle.loads(pickle.dumps(parted)), parted.clean()[0]):
            numpy.testing.assert_array_equal(one.triangle_features, features)
            self.assertEqual(one.feature_names, names)
        self.assertIsNone(mesh.triangle_features)
        with self.assertRaisesRegex(occlod.Error, "triangle 0: has feature [01] of 0"):
            occlod.Mesh(mesh.positions[:mesh.vertex_count], mesh.triangles, triangle_features=features)

    def test_go_in_as_they_come_out(self):
        mesh = self.mesh
        again = occlod.Mesh(mesh.positions, mesh.triangles, colors=mesh.colors, texture_coordinates=mesh.texture_coordinates,
                            extra_wedges=mesh.extra_wedges, corners=mesh.corners, triangle_materials=mesh.triangle_materials,
                            materials=mesh.materials, textures=mesh.textures, texture_origin=occlod.TextureOrigin.top_left)
        self.assertEqual((again.corners.dtype, again.triangle_materials.dtype), (numpy.uint32, numpy.uint16))
        self.assertEqual(looks(again), looks(mesh))
        self.assertEqual((again.texture_origin, mesh.texture_origin), (occlod.TextureOrigin.top_left, occlod.TextureOrigin.bottom_left))
        hierarchy = occlod.build_hierarchy(again, base_triangles=12)
        self.assertTrue(hierarchy.restores(again))
        self.assertFalse(hierarchy.restores(mesh), "the same numbers from another origin are other places of the images")

    def test_are_given_back_by_cuts(self):
        hierarchy = occlod.build_hierarchy(self.mesh, base_triangles=12)
        self.assertEqual((hierarchy.materials, hierarchy.textures), (self.mesh.materials, self.mesh.textures))
        self.assertEqual(hierarchy.texture_origin, occlod.TextureOrigin.bottom_left)
        self.assertEqual(looks(hierarchy.cut().mesh()), looks(self.read))
        # Every corner of a coarse cut lies in the square of the texture, has the colour and the material of one side.
        coarse = hierarchy.cut(triangles=40).mesh()
        self.assertEqual((coarse.materials, coarse.textures), (self.mesh.materials, self.mesh.textures))
        self.assertLessEqual(coarse.triangle_count, 40)
        u = coarse.texture_coordinates[coarse.wedge_triangles][:, :, 0]
        side = u.min(axis=1).astype(int) // 2
        self.assertTrue((u.max(axis=1) <= 2 * side + 1).all())
        self.assertEqual(set(side.tolist()), set(range(6)))
        numpy.testing.assert_array_equal(coarse.triangle_materials, side % 2)
        numpy.testing.assert_array_equal(coarse.colors[coarse.wedge_triangles][:, :, 0], numpy.repeat(40 * side[:, None], 3, axis=1))

    def test_are_kept_by_files(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "box.glb")
            self.mesh.write(path)
            again = occlod.read_mesh(path)
            self.assertEqual(again.texture_origin, occlod.TextureOrigin.top_left)
            self.assertEqual((again.materials, again.textures), (self.mesh.materials, self.mesh.textures))
            again.texture_coordinates[:, 1] = 1 - again.texture_coordinates[:, 1]
            self.assertEqual(looks(again), looks(self.mesh))

    def test_are_drawn(self):
        camera = occlod.Camera(eye=(3, 4, 5), width=160, height=120)
        reference = occlod.picture(self.read, camera, wire=False)  # a vertex has one colour only there
        hierarchy = occlod.build_hierarchy(self.mesh, base_triangles=12)
        for what in (self.mesh, hierarchy, hierarchy.cut(), occlod.Object(hierarchy)):
            numpy.testing.assert_array_equal(occlod.picture(what, camera, wire=False), reference)

    def test_materials_are_values(self):
        material, other = self.mesh.materials
        self.assertEqual((material.name, material.base_color, material.texture), ("even", (1.0, 0.5, 0.25, 1.0), 0))
        self.assertEqual((other.base_color, other.texture), ((1.0, 1.0, 1.0, 1.0), None))
        self.assertNotEqual(material, other)
        self.assertNotEqual(material, "even")
        with self.assertRaises(AttributeError):
            material.name = "odd"
        texture = occlod.Texture(mime_type="image/png", bytes=b"\x89PNG\0")
        self.assertEqual((texture.bytes, texture.wrap_s), (b"\x89PNG\0", occlod.TextureWrap.repeat))
        self.mesh.textures = [*self.mesh.textures, texture]
        self.mesh.materials = [material, occlod.Material("odd", texture=1)]
        self.assertEqual(self.mesh.textures[self.mesh.materials[1].texture], texture)

    def test_surfaces_travel(self):
        """All fields, through a hierarchy's file and a GLB file. Maps name the second texture."""
        bump = occlod.TextureMap(1, strength=0.5, offset=(0.25, 0.5), rotation=0.5, scale=(2, 4))
        surface = occlod.Surface(alpha_mode=occlod.AlphaMode.mask, alpha_cutoff=0.25, double_sided=True, unlit=True, metallic=0.5, roughness=0.75,
                                 emissive=(0.5, 0.25, 1), metallic_map=occlod.TextureMap(1), normal_map=bump,
                                 occlusion_map=occlod.TextureMap(1, strength=0.25), emissive_map=occlod.TextureMap(0))
        self.assertEqual((bump.texture, bump.scale, occlod.TextureMap().texture, surface.normal_map, surface.emissive), (1, (2, 4), None, bump, (0.5, 0.25, 1)))
        texture = occlod.Texture(mime_type="image/png", bytes=b"\x89PNG\0", min_filter=9984, mag_filter=9728)
        even = self.mesh.materials[0]
        self.mesh.materials = [occlod.Material(even.name, base_color=even.base_color, texture=0, surface=surface), occlod.Material("odd")]
        self.mesh.textures, self.mesh.up = [*self.mesh.textures, texture], occlod.UpAxis.y
        self.assertNotEqual(even.surface, surface)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.olod")
            occlod.build_hierarchy(self.mesh).write(path)
            mesh = occlod.read_hierarchy(path).cut().mesh()
            self.assertEqual((mesh.materials, mesh.textures, mesh.up), (self.mesh.materials, self.mesh.textures, occlod.UpAxis.y))
            with self.assertWarnsRegex(UserWarning, "checker.png"):
                mesh.write(path.with_suffix(".glb"))
            read = occlod.read_mesh(path.with_suffix(".glb"))
            self.assertEqual((read.materials, read.textures), (self.mesh.materials, self.mesh.textures))
            images = pathlib.Path(folder, "images")
            images.mkdir()
            (images / "checker.png").write_bytes(texture.bytes)
            mesh.write(path.with_suffix(".glb"), images=images)
            self.assertEqual(occlod.read_mesh(path.with_suffix(".glb")).textures[0].bytes, texture.bytes)

    def test_mistakes_are_told(self):
        for arrays, text in [({"corners": self.mesh.triangles[:3]}, "mesh: corners: are 3, of 768 triangles"),
                             ({"texture_coordinates": numpy.zeros((5, 2))}, "mesh: texture_coordinates: are 5, of 486 positions"),
                             ({"extra_wedges": [9]}, "mesh: corners: are missing"),
                             ({"extra_wedges": [5, 4], "corners": self.read.triangles}, "mesh: extra wedge 1: is of vertex 4"),
                             ({"extra_wedges": numpy.zeros(487, int)}, "mesh: extra_wedges: are more than positions"),
                             ({"triangle_materials": numpy.ones(768, int)}, "mesh: triangle 0: has material 1 of 0"),
                             ({"materials": [occlod.Material(texture=2)]}, "mesh: material 0: has texture 2 of 0")]:
            with self.subTest(text), self.assertRaisesRegex(occlod.Error, text):
                triangles = numpy.minimum(self.read.triangles, 400) if "extra_wedges" in arrays else self.read.triangles
                occlod.Mesh(self.read.positions, triangles, **arrays)
        with self.assertRaisesRegex(ValueError, "triangle_materials: ids are from 0 to 65535"):
            occlod.Mesh(self.read.positions, self.read.triangles, triangle_materials=numpy.full(768, 65536))
        with self.assertRaisesRegex(TypeError, "texture_coordinates"):
            occlod.Mesh(self.read.positions, self.read.triangles, texture_coordinates=self.read.positions)
        self.mesh.corners[7, 1] = 485
        for call in (self.mesh.clean, self.mesh.report, lambda: self.mesh.write("never.ply"), lambda: occlod.build_hierarchy(self.mesh),
                     lambda: occlod.picture(occlod.build_hierarchy(self.mesh), occlod.Camera())):
            with self.assertRaisesRegex(occlod.Error, "triangle 7"):
                call()


class Files(unittest.TestCase):
    def test_round_trip(self):
        mesh = occlod.generate("city", blocks=1, facade_cells=2)
        with tempfile.TemporaryDirectory() as folder:
            for name in ("a.ply", "a.obj", "a.off"):
                path = pathlib.Path(folder, name)
                mesh.write(path)
                again, report = occlod.read_mesh_and_report(str(path))
                self.assertEqual(corners(again.positions, again.triangles), corners(mesh.positions, mesh.triangles), name)
                self.assertEqual(report.triangles_read, mesh.triangle_count)
                self.assertEqual(report.left_out, {})

    def test_what_is_left_out_is_counted_by_name(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.obj")
            path.write_bytes(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1 2\nl 2 3\nname\xdf 1\n")
            report = occlod.read_mesh_and_report(str(path))[1]
        self.assertEqual(report.left_out, {"keyword name\ufffd": 1, "lines (l)": 2})

    def test_names_of_textures_may_have_any_bytes(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "a.mtl").write_bytes(b"newmtl m\nmap_Kd Stra\xdfe.png\n")
            path = pathlib.Path(folder, "a.obj")
            path.write_bytes(b"mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
            texture = occlod.read_mesh(str(path)).textures[0]
        self.assertEqual(os.fsencode(texture.file), b"Stra\xdfe.png")
        self.assertIn("occlod.Texture", repr(texture))

    def test_progress_ends_with_all(self):
        told = []
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.ply")
            occlod.generate("rough-planet", level=3).write(path)
            occlod.read_mesh(path, told.append)
            with self.assertRaises(ZeroDivisionError):
                occlod.read_mesh(path, lambda done: 1 / 0)
        self.assertEqual(told[-1], 1.0)
        self.assertEqual(told, sorted(told))

    def test_errors_have_their_parts(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "broken.off")
            path.write_text("OFF\n3 1 0\n0 0 0\n1 0 zero\n0 1 0\n3 0 1 2\n")
            with self.assertRaises(occlod.Error) as caught:
                occlod.read_mesh(path)
        error = caught.exception
        self.assertIn("broken.off", error.subject)
        self.assertIn("4", error.place)  # the fourth line
        self.assertTrue(error.problem)
        self.assertIn(error.problem, str(error))
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((str(again), again.remedy), (str(error), error.remedy))

    def test_missing_file(self):
        with self.assertRaisesRegex(occlod.Error, "nowhere.ply"):
            occlod.read_mesh("/nowhere/nowhere.ply")


class Reports(unittest.TestCase):
    def test_clean_welds_and_counts(self):
        positions, triangles = tetrahedron()
        mesh = occlod.Mesh(positions[triangles.ravel()], numpy.arange(12).reshape(4, 3))  # 12 vertices at 4 places
        cleaned, report = mesh.clean()
        self.assertEqual((cleaned.vertex_count, report.vertices_welded, report.components), (4, 8, 1))
        self.assertEqual(report.boundary_edges, 0)
        self.assertEqual(mesh.report().boundary_edges, 12)  # as it is: each triangle has three of its own
        self.assertEqual(mesh.vertex_count, 12)

    def test_indices_changed_since_are_checked(self):
        mesh = occlod.Mesh(*tetrahedron())
        mesh.triangles[2, 1] = 99
        for call in (mesh.report, mesh.clean, lambda: mesh.write("never.ply"), lambda: occlod.build_hierarchy(mesh),
                     lambda: occlod.build_hlod(mesh), lambda: occlod.picture(mesh, occlod.Camera())):
            with self.assertRaises(occlod.Error):
                call()
        self.assertFalse(pathlib.Path("never.ply").exists())


if __name__ == "__main__":
    unittest.main()
