"""Meshes: arrays in and out, files, reports, errors."""
import gc
import pathlib
import pickle
import tempfile
import unittest

import numpy
import occlod
from support import corners, tetrahedron


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
        positions = occlod.generate_rough_planet(level=5).positions
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


class Files(unittest.TestCase):
    def test_round_trip(self):
        mesh = occlod.generate_city(blocks=1, facade_cells=2)
        with tempfile.TemporaryDirectory() as folder:
            for name in ("a.ply", "a.obj", "a.off"):
                path = pathlib.Path(folder, name)
                mesh.write(path)
                again, report = occlod.read_mesh_and_report(str(path))
                self.assertEqual(corners(again.positions, again.triangles), corners(mesh.positions, mesh.triangles), name)
                self.assertEqual(report.triangles_read, mesh.triangle_count)
                self.assertEqual(report.left_out.materials, 0)

    def test_progress_ends_with_all(self):
        told = []
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.ply")
            occlod.generate_rough_planet(level=3).write(path)
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
